// No pair is lost that is close enough in exact arithmetic, at any scale.
#include <algorithm>
#include <cmath>

// GCC 12 suspects Boost's small-integer storage of being read before it is written; it is not.
#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC diagnostic ignored "-Wmaybe-uninitialized"
#endif
#include <boost/multiprecision/cpp_int.hpp>
#include <gtest/gtest.h>

#include "broad_phase_oracle.h"
#include "random_inputs.h"

namespace collision_pairs::test_sweep_exactness {

using Eigen::Vector3d;
using Rational = boost::multiprecision::cpp_rational;

Rational exactSquaredGap(const Aabb& a, const Aabb& b) {
  Rational sum = 0;
  for (int k = 0; k < 3; ++k) {
    const Rational ab = Rational(b.min[k]) - Rational(a.max[k]);
    const Rational ba = Rational(a.min[k]) - Rational(b.max[k]);
    const Rational gap = ab > ba ? ab : ba;
    if (gap > 0) sum += gap * gap;
  }
  return sum;
}

// Every pair that is close enough is found; every pair found is close enough, but for the margin
// that squaredReach() names.
void expectExact(const BroadPhaseScene& scene, const std::string& what) {
  const Rational squared_alarm = Rational(scene.alarm_distance) * Rational(scene.alarm_distance);
  const double margin = scene.alarm_distance * 2e-15 + 1e-161;
  const Rational loose = Rational(scene.alarm_distance) + Rational(margin);
  struct Exact {
    BoxPair pair;
    bool must_be_found, may_be_found;
  };
  std::vector<Exact> pairs;
  for (std::uint32_t i = 0; i < scene.boxes.size(); ++i) {
    for (std::uint32_t j = std::max(i + 1, static_cast<std::uint32_t>(scene.nb_static));
         j < scene.boxes.size(); ++j) {
      const Rational gap = exactSquaredGap(scene.boxes[i], scene.boxes[j]);
      pairs.push_back({{i, j}, gap <= squared_alarm, gap <= loose * loose});
    }
  }
  const PairFilter all = PairFilter::allowAll(scene.boxes.size());
  BroadPhaseScene filtered = scene;
  filtered.filter = &all;
  for (const SweepTuning& tuning : allPaths()) {
    SweepAndPrune sweep(tuning);
    const std::vector<BoxPair> found = pairsBySweep(scene, &sweep);
    for (const bool is_told : {false, true}) {
      ASSERT_EQ(pairsBySweep(filtered, &sweep, is_told), found)
          << what << ": a filter that allows all, told " << is_told;
    }
    std::size_t next = 0;
    for (const Exact& exact : pairs) {
      const auto [i, j] = exact.pair;
      const bool is_found = next < found.size() && found[next] == exact.pair;
      if (is_found) ++next;
      ASSERT_TRUE(is_found || !exact.must_be_found) << what << ": lost " << i << ", " << j;
      ASSERT_TRUE(!is_found || exact.may_be_found) << what << ": too far " << i << ", " << j;
    }
    ASSERT_EQ(next, found.size()) << what;
  }
}

double ulps(double x, int n) {
  for (; n > 0; --n) x = std::nextafter(x, INFINITY);
  for (; n < 0; ++n) x = std::nextafter(x, -INFINITY);
  return x;
}

// Boxes whose sides coincide with, or miss by units in the last place, the sides of others, at a
// distance of the alarm distance from one another.
TEST(SweepExactness, SidesAUnitInTheLastPlaceApartAreDecidedRightly) {
  RandomInputs random;
  for (int round = 0; round < 60; ++round) {
    BroadPhaseScene scene;
    scene.alarm_distance = round % 3 == 0 ? 0.0 : std::pow(10.0, random.uniform(-9.0, 2.0));
    const Vector3d middle = random.vector(-1.0, 1.0) * std::pow(10.0, random.integer(-6, 8));
    scene.add({middle, middle + random.vector(0.0, 1.0)});
    while (scene.boxes.size() < 50) {
      const Aabb& other = scene.boxes[static_cast<std::size_t>(
          random.integer(0, static_cast<int>(scene.boxes.size()) - 1))];
      Aabb box;
      for (int k = 0; k < 3; ++k) {
        const double gap = random.integer(0, 2) == 0 ? scene.alarm_distance
                                                     : scene.alarm_distance / std::sqrt(2.0);
        box.min[k] =
            random.integer(0, 1) ? other.min[k] : ulps(other.max[k] + gap, random.integer(-2, 2));
        box.max[k] = box.min[k] + random.integer(0, 2) * random.uniform(0.0, 0.5);
      }
      scene.add(box);
    }
    scene.nb_static = round % 2 == 0 ? 0 : 20;
    expectExact(scene, "round " + std::to_string(round));
  }
}

// Within the margin that squaredReach() names a pair may count or not, but on all paths alike.
// Midway between the two, single precision is finer than double was at their sides.
TEST(SweepExactness, AllPathsDecideAlikeWhereRoundingDecides) {
  RandomInputs random;
  int nb_found = 0;
  for (int round = 0; round < 2000; ++round) {
    BroadPhaseScene scene;
    scene.alarm_distance = random.uniform(0.1, 1.0);
    const double middle = random.uniform(-1.0, 1.0);
    const double side = middle - 0.5 * scene.alarm_distance;
    const double opposite = ulps(side + scene.alarm_distance, random.integer(-3, 6));
    scene.add({{side - 1.0, 0.0, 0.0}, {side, 1.0, 1.0}});
    scene.add({{middle, 100.0, 0.0}, {middle, 101.0, 1.0}});
    scene.add({{opposite, 0.0, 0.0}, {opposite + 1.0, 1.0, 1.0}});
    scene.nb_static = round % 2 == 0 ? 0 : 1;
    const std::vector<BoxPair> expected = pairsByBruteForce(scene);
    nb_found += static_cast<int>(expected.size());
    for (const SweepTuning& tuning : allPaths()) {
      SweepAndPrune sweep(tuning);
      ASSERT_EQ(pairsBySweep(scene, &sweep), expected) << "round " << round;
    }
  }
  EXPECT_GT(nb_found, 500);
  EXPECT_LT(nb_found, 1800);
}

TEST(SweepExactness, CoordinatesOfAHundredThousandKilometresAndSizesOfANanometreMix) {
  RandomInputs random;
  for (int round = 0; round < 30; ++round) {
    BroadPhaseScene scene;
    scene.alarm_distance = round % 2 == 0 ? 0.0 : std::pow(10.0, random.uniform(-9.0, 1.0));
    while (scene.boxes.size() < 60) {
      const double where = std::pow(10.0, random.uniform(-9.0, 8.0));
      const double size = std::pow(10.0, random.uniform(-9.0, 8.0));
      const Vector3d corner = random.vector(-1.0, 1.0) * where;
      scene.add({corner, corner + random.vector(0.0, 1.0) * size});
      const Vector3d touching = scene.boxes.back().max;
      scene.add({touching, touching + random.vector(0.0, 1e-9)});
    }
    expectExact(scene, "round " + std::to_string(round));
  }
}

TEST(SweepExactness, FarFromTheOriginNothingIsLostAndNothingInvented) {
  RandomInputs random;
  for (const double far : {1e6, 1e8, 1e15}) {
    BroadPhaseScene scene;
    for (int i = 0; i < 120; ++i) {
      const Vector3d corner = Vector3d(far, -far, far) + random.vector(0.0, 1.0);
      scene.add({corner, corner + random.vector(0.0, 0.2)});
    }
    expectExact(scene, "at " + std::to_string(far));
  }
}

TEST(SweepExactness, SquaresThatUnderflowLoseNothing) {
  RandomInputs random;
  for (int round = 0; round < 20; ++round) {
    BroadPhaseScene scene;
    const double tiny = std::pow(10.0, -random.uniform(150.0, 323.0));
    scene.alarm_distance = round % 4 == 0 ? 0.0 : tiny;
    for (int i = 0; i < 40; ++i) {
      const Vector3d corner = random.vector(-3.0, 3.0) * tiny;
      scene.add({corner, corner + random.vector(0.0, 1.0) * tiny});
    }
    expectExact(scene, "tiny " + std::to_string(round));
  }
}

}  // namespace collision_pairs::test_sweep_exactness
