// What a pixel sees is the first point of the shape on its ray: by steps along the ray, each asked
// whether it is inside.
#include <cmath>
#include <functional>
#include <random>

#include <gtest/gtest.h>

#include "depth_image.h"
#include "random_inputs.h"

namespace collision_pairs::test_depth_image {

using Eigen::Isometry3d;
using Eigen::Vector3d;
using Inside = std::function<bool(const Vector3d& p_E)>;

constexpr double STEP = 1e-3, FARTHEST = 6.0;  // m

double marched(const Vector3d& ray, const Isometry3d& X_EC, const Inside& inside) {
  for (double t = STEP; t < FARTHEST; t += STEP) {
    if (inside(X_EC * Vector3d(t * ray))) return t;
  }
  return std::numeric_limits<double>::infinity();
}

void expectSeen(const Shape& shape, const Inside& inside) {
  std::mt19937 random(givenSeed());
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  DepthImage image(24, 16, 20.0);
  int nb_seen = 0;
  for (int i = 0; i < 20; ++i) {
    Isometry3d X_CE = Isometry3d::Identity();
    X_CE.rotate(
        Eigen::Quaterniond(unit(random), unit(random), unit(random), unit(random)).normalized());
    X_CE.pretranslate(Vector3d(unit(random), unit(random), 2.0 + 2.0 * unit(random)));
    if (inside(X_CE.inverse().translation())) continue;  // a camera within a body
    image.clear();
    image.draw(shape, X_CE);
    for (int v = 0; v < image.height(); ++v) {
      for (int u = 0; u < image.width(); ++u) {
        const double truth = marched(image.ray(u, v), X_CE.inverse(), inside);
        const float seen = image.depth(u, v);
        // The steps may miss an edge that the ray only grazes.
        if (std::isinf(truth) && (seen > FARTHEST || std::isinf(seen))) continue;
        const Vector3d in = X_CE.inverse() * Vector3d((seen + 1e-6) * image.ray(u, v));
        if (std::isinf(truth) && inside(in)) continue;
        ASSERT_NEAR(seen, truth, 1.01 * STEP) << "case " << i << ", pixel " << u << ' ' << v;
        ++nb_seen;
      }
    }
  }
  EXPECT_GT(nb_seen, 100);
}

TEST(DepthImage, OfABoxIsItsFirstPointOnTheRay) {
  expectSeen(Box{{0.4, 0.7, 1.0}}, [](const Vector3d& p) {
    return (p.cwiseAbs() - Vector3d(0.2, 0.35, 0.5)).maxCoeff() <= 0.0;
  });
}

TEST(DepthImage, OfASphereIsItsFirstPointOnTheRay) {
  expectSeen(Sphere{0.4}, [](const Vector3d& p) { return p.norm() <= 0.4; });
}

TEST(DepthImage, OfACylinderIsItsFirstPointOnTheRay) {
  expectSeen(Cylinder{0.3, 0.8},
             [](const Vector3d& p) { return p.head<2>().norm() <= 0.3 && std::abs(p.z()) <= 0.4; });
}

TEST(DepthImage, OfACapsuleIsItsFirstPointOnTheRay) {
  expectSeen(Capsule{0.3, 0.8}, [](const Vector3d& p) {
    const double z = std::max(-0.4, std::min(0.4, p.z()));
    return (p - Vector3d(0, 0, z)).norm() <= 0.3;
  });
}

TEST(DepthImage, OfAHalfSpaceIsItsFirstPointOnTheRay) {
  expectSeen(HalfSpace{}, [](const Vector3d& p) { return p.z() <= 0.0; });
}

TEST(DepthImage, OfATetrahedronIsItsFirstPointOnTheRay) {
  auto mesh = std::make_shared<TriangleMesh>();
  mesh->vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  mesh->triangles = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}};
  expectSeen(Mesh{mesh}, [](const Vector3d& p) { return p.minCoeff() >= 0.0 && p.sum() <= 1.0; });
}

TEST(DepthImage, ShowsTheNearestOfSeveralShapes) {
  DepthImage image(3, 3, 3.0);
  Isometry3d far = Isometry3d::Identity(), near = Isometry3d::Identity();
  far.translation().z() = 3.0;
  near.translation().z() = 1.0;
  for (const auto& poses : {std::pair{far, near}, {near, far}}) {
    image.clear();
    image.draw(Sphere{0.5}, poses.first);
    image.draw(Sphere{0.5}, poses.second);
    EXPECT_FLOAT_EQ(image.depth(1, 1), 0.5f);
  }
}

}  // namespace collision_pairs::test_depth_image
