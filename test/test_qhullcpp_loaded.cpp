// In this program libqhullcpp comes before libqhull_r, as where PCL or another user of it was
// loaded first. Its qh_fprintf() ends the process for states of C, at any message.
#include <cmath>
#include <string>

#include <dlfcn.h>
#include <gtest/gtest.h>

#include "convex_hull.h"
#include "random_inputs.h"

namespace collision_pairs::test_qhullcpp_loaded {

std::vector<Eigen::Vector3d> cube() {
  std::vector<Eigen::Vector3d> corners;
  for (int i = 0; i < 8; ++i) corners.emplace_back(i & 1, i >> 1 & 1, i >> 2);
  return corners;
}

TEST(QhullcppLoaded, ItsMessagesStandForThoseOfTheLibraryInC) {
  Dl_info info;
  void* const symbol = dlsym(RTLD_DEFAULT, "qh_fprintf");
  ASSERT_NE(symbol, nullptr);
  ASSERT_NE(dladdr(symbol, &info), 0);
  EXPECT_NE(std::string(info.dli_fname).find("libqhullcpp"), std::string::npos) << info.dli_fname;
}

TEST(QhullcppLoaded, AHullIsWhatItIsOtherwise) {
  const ConvexHull hull = convexHull(cube());
  EXPECT_EQ(hull.points.vertices.size(), 8u);
  EXPECT_EQ(hull.faces.size(), 12u);
  EXPECT_NEAR(hull.volume, 1.0, 1e-15);
}

TEST(QhullcppLoaded, FlatInputHasNoFaces) {
  std::vector<Eigen::Vector3d> square = cube();
  for (Eigen::Vector3d& corner : square) corner.z() = 0.0;
  for (int i = 0; i < 3; ++i) {  // the state of the one before is freed
    EXPECT_TRUE(convexHull(square).faces.empty());
    EXPECT_FALSE(convexHull(cube()).faces.empty());
  }
}

TEST(QhullcppLoaded, NoInputEndsTheProcess) {
  RandomInputs random;
  for (int round = 0; round < 3000; ++round) {
    const int nb = 1 + round % 40;
    const double height = std::pow(10.0, random.uniform(-20.0, 3.0));
    const double step = round % 3 == 0 ? 0.25 : 0.0;  // on a grid: many in a plane
    std::vector<Eigen::Vector3d> points;
    for (int i = 0; i < nb; ++i) {
      Eigen::Vector3d p = random.vector(-1.0, 1.0);
      if (step > 0.0) p = (p / step).array().round() * step;
      p.z() *= height;
      if (round % 5 == 0) p *= 1e150;
      if (round % 7 == 0) p *= 1e-160;
      points.push_back(p);
    }
    const ConvexHull hull = convexHull(points);
    EXPECT_FALSE(hull.points.vertices.empty());
  }
}

}  // namespace collision_pairs::test_qhullcpp_loaded
