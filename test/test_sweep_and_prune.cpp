#include <algorithm>
#include <limits>
#include <numeric>

#include <gtest/gtest.h>

#include "box_pairs.h"
#include "broad_phase_oracle.h"
#include "collision_pairs/input_error.h"
#include "collision_pairs/sweep_and_prune.h"
#include "random_inputs.h"
#include "sweep_axis.h"

namespace collision_pairs::test_sweep_and_prune {

using Eigen::Vector3d;

constexpr double INF = std::numeric_limits<double>::infinity();
constexpr double LARGEST = std::numeric_limits<double>::max();

void expectWhatBruteForceFinds(const BroadPhaseScene& scene, const std::string& what) {
  const std::vector<BoxPair> expected = pairsByBruteForce(scene);
  const PairFilter all = PairFilter::allowAll(scene.boxes.size());
  BroadPhaseScene filtered = scene;
  if (!scene.filter) filtered.filter = &all;
  for (const SweepTuning& tuning : allPaths()) {
    SweepAndPrune sweep(tuning);
    for (const bool is_told : {false, true}) {
      const std::vector<BoxPair> found =
          is_told ? pairsBySweep(filtered, &sweep, true) : pairsBySweep(scene, &sweep);
      ASSERT_EQ(found.size(), expected.size())
          << what << ", packed " << !tuning.packed_up_to.has_value() << ", columns of "
          << tuning.column_size << ", told " << is_told;
      ASSERT_TRUE(found == expected) << what;
    }
  }
  SweepAndPrune sweep;  // changes its way from cycle to cycle
  for (const BroadPhase way : {BroadPhase::SWEEP, BroadPhase::AUTO, BroadPhase::SWEEP}) {
    sweep.setBroadPhase(way);
    ASSERT_TRUE(pairsBySweep(scene, &sweep) == expected) << what << ", " << broadPhaseName(way);
    ASSERT_TRUE(pairsBySweep(filtered, &sweep, true) == expected)
        << what << ", told, " << broadPhaseName(way);
  }
}

BroadPhaseScene randomScene(RandomInputs* random, int nb_boxes, double size) {
  BroadPhaseScene scene;
  for (int i = 0; i < nb_boxes; ++i) {
    const Vector3d corner = random->vector(-1.0, 1.0);
    scene.add({corner, corner + random->vector(0.0, size)});
  }
  return scene;
}

BroadPhaseScene touchingGrid(int side) {
  BroadPhaseScene scene;
  for (int x = 0; x < side; ++x) {
    for (int y = 0; y < side; ++y) {
      for (int z = 0; z < side; ++z) {
        scene.add({Vector3d(x, y, z), Vector3d(x + 1, y + 1, z + 1)});
      }
    }
  }
  return scene;
}

TEST(SweepAndPrune, FindsWhatBruteForceFindsInRandomScenes) {
  RandomInputs random;
  for (int round = 0; round < 200; ++round) {
    BroadPhaseScene scene = randomScene(&random, random.integer(0, 250), random.uniform(0.0, 0.6));
    scene.alarm_distance = round % 3 == 0 ? 0.0 : random.uniform(0.0, 0.1);
    scene.nb_static = round % 2 == 0 ? 0 : scene.boxes.size() / 2;
    expectWhatBruteForceFinds(scene, "round " + std::to_string(round));
  }
}

TEST(SweepAndPrune, FindsWhatBruteForceFindsAmongVeryFewBoxes) {
  RandomInputs random;
  for (int nb_boxes = 0; nb_boxes <= 12; ++nb_boxes) {
    for (int nb_static = 0; nb_static <= nb_boxes; ++nb_static) {
      BroadPhaseScene scene = randomScene(&random, nb_boxes, 0.7);
      scene.nb_static = static_cast<std::size_t>(nb_static);
      scene.alarm_distance = nb_boxes % 2 * 0.1;
      expectWhatBruteForceFinds(scene, std::to_string(nb_boxes) + " boxes");
    }
  }
}

TEST(SweepAndPrune, IsAskedForByName) {
  EXPECT_EQ(parseBroadPhase("auto"), BroadPhase::AUTO);
  EXPECT_EQ(parseBroadPhase("sweep"), BroadPhase::SWEEP);
  EXPECT_THROW(parseBroadPhase("Sweep"), InputError);
}

TEST(SweepAndPrune, FindsWhatBruteForceFindsAmongThousandsOfBoxes) {
  RandomInputs random;
  for (const double alarm : {0.0, 0.01}) {
    for (const std::size_t nb_static : {0u, 3000u}) {
      BroadPhaseScene scene = randomScene(&random, 5000, 0.15);
      scene.alarm_distance = alarm;
      scene.nb_static = nb_static;
      expectWhatBruteForceFinds(scene, "alarm " + std::to_string(alarm));
    }
  }
}

TEST(SweepAndPrune, FindsNothingAmongNoneOrOneAndThePairAmongTwoAndThree) {
  const Aabb unit{Vector3d(0, 0, 0), Vector3d(1, 1, 1)};
  const Aabb far{Vector3d(5, 5, 5), Vector3d(6, 6, 6)};
  for (const SweepTuning& tuning : allPaths()) {
    SweepAndPrune sweep(tuning);
    BroadPhaseScene scene;
    EXPECT_TRUE(pairsBySweep(scene, &sweep).empty());
    scene.add(unit);
    EXPECT_TRUE(pairsBySweep(scene, &sweep).empty());
    scene.add(unit);
    EXPECT_EQ(pairsBySweep(scene, &sweep), (std::vector<BoxPair>{{0, 1}}));
    scene.add(far);
    EXPECT_EQ(pairsBySweep(scene, &sweep), (std::vector<BoxPair>{{0, 1}}));
  }
}

// A sweep that takes the end of one box before the beginning of the next finds some of these or
// none, as the ids happen to be.
TEST(SweepAndPrune, TouchingBoxesAreFoundInAnyOrderOfIds) {
  RandomInputs random;
  BroadPhaseScene scene = touchingGrid(10);
  constexpr std::size_t EVERY_NEIGHBOUR = 10476;
  for (int round = 0; round < 3; ++round) {
    EXPECT_EQ(pairsByBruteForce(scene).size(), EVERY_NEIGHBOUR);
    expectWhatBruteForceFinds(scene, "touching grid");
    if (round == 0) std::reverse(scene.boxes.begin(), scene.boxes.end());
    if (round == 1) std::shuffle(scene.boxes.begin(), scene.boxes.end(), random.engine());
  }
}

TEST(SweepAndPrune, TheSameBoxesInAnyOrderGiveTheSamePairs) {
  RandomInputs random;
  const BroadPhaseScene scene = randomScene(&random, 700, 0.3);
  SweepAndPrune sweep;
  const std::vector<BoxPair> expected = pairsBySweep(scene, &sweep);
  std::vector<std::uint32_t> order(scene.boxes.size());
  std::iota(order.begin(), order.end(), 0u);
  for (int round = 0; round < 10; ++round) {
    std::shuffle(order.begin(), order.end(), random.engine());
    BroadPhaseScene shuffled;
    for (const std::uint32_t i : order) shuffled.add(scene.boxes[i]);
    std::vector<BoxPair> found = pairsBySweep(shuffled, &sweep);
    for (BoxPair& pair : found) {
      const auto ids = std::minmax(order[pair.first], order[pair.second]);
      pair = {ids.first, ids.second};
    }
    std::sort(found.begin(), found.end());
    EXPECT_TRUE(found == expected);
  }
}

TEST(SweepAndPrune, PointsNestedAndEqualBoxesAreFound) {
  BroadPhaseScene scene;
  for (int i = 0; i < 40; ++i) {
    const double half = 0.025 * (i / 4);
    scene.add({Vector3d::Constant(-half), Vector3d::Constant(half)});
  }
  EXPECT_EQ(pairsByBruteForce(scene).size(), 40u * 39u / 2u);
  expectWhatBruteForceFinds(scene, "nested");
}

TEST(SweepAndPrune, BoxesInALineOrAPlaneAreFound) {
  RandomInputs random;
  for (int flat_axes = 1; flat_axes <= 3; ++flat_axes) {
    for (int first = 0; first < 3; ++first) {
      BroadPhaseScene scene = randomScene(&random, 500, 0.02);
      for (Aabb& box : scene.boxes) {
        for (int k = 0; k < flat_axes; ++k) {
          box.min[(first + k) % 3] = 3.0;
          box.max[(first + k) % 3] = 3.0;
        }
      }
      expectWhatBruteForceFinds(scene, std::to_string(flat_axes) + " flat axes");
    }
  }
}

TEST(SweepAndPrune, ClustersOfClustersAndOneBoxFarAwayAreFound) {
  RandomInputs random;
  BroadPhaseScene scene;
  for (int i = 0; i < 3000; ++i) {
    const Vector3d corner = Vector3d::Constant(1000.0 * random.integer(0, 3)) +
                            Vector3d::Constant(10.0 * random.integer(0, 5)) +
                            random.vector(0.0, 0.5);
    scene.add({corner, corner + random.vector(0.0, 0.1)});
  }
  scene.add({Vector3d::Constant(1e12), Vector3d::Constant(2e12)});
  expectWhatBruteForceFinds(scene, "clusters");
}

TEST(SweepAndPrune, HalfSpacesMeetAllThatReachIntoThem) {
  RandomInputs random;
  BroadPhaseScene scene = randomScene(&random, 600, 0.1);
  scene.boxes[0] = {Vector3d::Constant(-LARGEST), Vector3d(LARGEST, LARGEST, -0.5)};
  scene.boxes[7] = {Vector3d(0.9, -LARGEST, -LARGEST), Vector3d::Constant(LARGEST)};
  scene.boxes[8] = {Vector3d::Constant(-LARGEST), Vector3d::Constant(LARGEST)};
  scene.boxes[599] = {Vector3d::Constant(LARGEST), Vector3d::Constant(LARGEST)};
  for (const std::size_t nb_static : {0u, 5u, 300u}) {
    for (const double alarm : {0.0, 0.1, 1e150}) {
      scene.nb_static = nb_static;
      scene.alarm_distance = alarm;
      expectWhatBruteForceFinds(scene, "half-spaces");
    }
  }
}

TEST(SweepAndPrune, UnsoundBoxesAreRefusedByIdAndTheRestIsChecked) {
  RandomInputs random;
  const double nan = std::numeric_limits<double>::quiet_NaN();
  BroadPhaseScene scene = randomScene(&random, 1000, 0.2);
  std::vector<std::uint32_t> unsound;
  for (std::uint32_t i = 20; i < 1000; i += 10) {
    Aabb& box = scene.boxes[i];
    const double poison[] = {nan, INF, -INF, -2.0};
    (i % 20 == 0 ? box.max : box.min)[static_cast<int>(i / 10 % 3)] = poison[i / 20 % 4];
    if (!box.valid()) unsound.push_back(i);
  }
  ASSERT_GT(unsound.size(), 50u);
  scene.nb_static = 15;
  expectWhatBruteForceFinds(scene, "unsound boxes");
  SweepAndPrune sweep;
  pairsBySweep(scene, &sweep);
  EXPECT_EQ(sweep.refused(), unsound);
}

// As of a large robot of which nobody knows where it is: 2e8 pairs if all stood in one place.
TEST(SweepAndPrune, ManyUnsoundBoxesMeetNothingNorEachOther) {
  constexpr std::uint32_t COUNT = 20000;
  const Aabb none{Vector3d::Constant(INF), Vector3d::Constant(-INF)};
  const Aabb cube{Vector3d::Zero(), Vector3d::Ones()};
  SweepAndPrune sweep;
  for (const std::uint32_t nb_sound : {0u, 1u, 2u}) {
    sweep.begin(0.1);
    for (std::uint32_t i = 0; i < COUNT; ++i) sweep.add(i >= COUNT - nb_sound ? cube : none, i);
    const std::vector<BoxPair> pairs = sweep.end();
    ASSERT_EQ(pairs.size(), nb_sound == 2 ? 1u : 0u);
    EXPECT_EQ(sweep.refused().size(), COUNT - nb_sound);
    if (pairs.empty()) continue;
    EXPECT_EQ(pairs[0].first, COUNT - 2);
    EXPECT_EQ(pairs[0].second, COUNT - 1);
  }
}

TEST(SweepAndPrune, OneModelsBoxesAndForbiddenPairsAreLeftOut) {
  RandomInputs random;
  PairFilter filter = PairFilter::allowAll(20);
  for (std::uint32_t a = 0; a < 20; ++a) {
    for (std::uint32_t b = 0; b < a; ++b) filter.setClassPair(a, b, (a + b) % 3 != 0);
  }
  BroadPhaseScene scene = randomScene(&random, 400, 0.4);
  for (std::uint32_t& model : scene.models) model %= 20;
  expectWhatBruteForceFinds(scene, "models");
  scene.filter = &filter;
  for (const std::size_t nb_static : {0u, 10u, 200u, 400u}) {
    scene.nb_static = nb_static;
    expectWhatBruteForceFinds(scene, "filter");
  }
}

TEST(SweepAndPrune, OneStaticSetServesAnyAlarmDistance) {
  RandomInputs random;
  BroadPhaseScene scene = randomScene(&random, 2000, 0.05);
  scene.nb_static = 1900;
  const StaticBoxes fixed({scene.boxes.begin(), scene.boxes.begin() + 1900},
                          {scene.models.begin(), scene.models.begin() + 1900});
  SweepAndPrune sweep;
  for (const double alarm : {0.0, 0.3, 0.01}) {
    scene.alarm_distance = alarm;
    sweep.begin(alarm, &fixed);
    for (std::size_t i = 1900; i < 2000; ++i) sweep.add(scene.boxes[i], scene.models[i]);
    EXPECT_TRUE(sweep.end() == pairsByBruteForce(scene)) << alarm;
  }
}

TEST(SweepAndPrune, NothingIsLeftOfTheCycleBefore) {
  RandomInputs random;
  SweepAndPrune sweep;
  pairsBySweep(randomScene(&random, 3000, 0.2), &sweep);
  const BroadPhaseScene few = randomScene(&random, 30, 0.5);
  EXPECT_EQ(pairsBySweep(few, &sweep), pairsByBruteForce(few));
  EXPECT_TRUE(pairsBySweep({}, &sweep).empty());
  EXPECT_TRUE(sweep.refused().empty());
}

int axisOf(const std::vector<Record>& boxes) {
  return sweepAxis(measureSpread([&](std::size_t i) { return boxes[i]; }, boxes.size()));
}

TEST(SweepAndPrune, TheAxisIsThatOfGreatestVarianceFarFromTheOriginToo) {
  RandomInputs random;
  for (const double far : {0.0, 1e4}) {
    for (int widest = 0; widest < 3; ++widest) {
      for (const std::size_t nb_boxes : {10u, 1000u}) {
        std::vector<Record> boxes(nb_boxes);
        for (Record& box : boxes) {
          for (int k = 0; k < 3; ++k) {
            box.lo[k] = static_cast<float>(far + random.uniform(0.0, k == widest ? 4.0 : 1.0));
            box.hi[k] = box.lo[k] + 0.01f;
          }
        }
        EXPECT_EQ(axisOf(boxes), widest) << far;
      }
    }
  }
}

TEST(SweepAndPrune, ParallelRodsAreNotSweptAlongTheRods) {
  RandomInputs random;
  BroadPhaseScene scene;
  std::vector<Record> boxes;
  for (int i = 0; i < 1000; ++i) {
    const Vector3d corner(random.uniform(0, 20), random.uniform(0, 10), random.uniform(0, 9));
    const Vector3d end = corner + Vector3d(30.0, 0.1, 0.1);
    scene.add({corner, end});
    boxes.emplace_back();
    for (int k = 0; k < 3; ++k) {
      boxes.back().lo[k] = static_cast<float>(corner[k]);
      boxes.back().hi[k] = static_cast<float>(end[k]);
    }
  }
  SweepAndPrune sweep;
  EXPECT_EQ(pairsBySweep(scene, &sweep), pairsByBruteForce(scene));
  EXPECT_EQ(axisOf(boxes), 1);
}

TEST(SweepAndPrune, AnAlarmDistanceThatIsNoDistanceIsRefused) {
  SweepAndPrune sweep;
  EXPECT_THROW(sweep.begin(-0.1), std::invalid_argument);
  EXPECT_THROW(sweep.begin(INF), std::invalid_argument);
  EXPECT_THROW(sweep.begin(std::numeric_limits<double>::quiet_NaN()), std::invalid_argument);
}

TEST(SweepAndPrune, AllowedPairsOfAnotherNumberOfBoxesAreRefused) {
  const PairFilter filter = PairFilter::allowAll(3);
  const AllowedBoxPairs of_two({0, 1}, filter);
  SweepAndPrune sweep;
  for (const int nb_boxes : {0, 1, 3}) {
    sweep.begin(0.0, nullptr, &filter, &of_two);
    for (int i = 0; i < nb_boxes; ++i) {
      sweep.add({Vector3d::Zero(), Vector3d::Ones()}, static_cast<std::uint32_t>(i));
    }
    EXPECT_THROW(sweep.end(), std::invalid_argument) << nb_boxes;
  }
}

TEST(StaticBoxes, TheFirstUnsoundBoxIsNamed) {
  const Aabb sound{Vector3d(0, 0, 0), Vector3d(1, 1, 1)};
  const Aabb inverted{Vector3d(1, 1, 1), Vector3d(0, 0, 0)};
  try {
    StaticBoxes({sound, sound, inverted}, {0, 1, 2});
    FAIL() << "an inverted box was taken";
  } catch (const std::invalid_argument& error) {
    EXPECT_NE(std::string(error.what()).find("static box 2"), std::string::npos) << error.what();
  }
  EXPECT_THROW(StaticBoxes({sound}, {0, 1}), std::invalid_argument);
}

}  // namespace collision_pairs::test_sweep_and_prune
