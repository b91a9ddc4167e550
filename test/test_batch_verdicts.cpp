// Verdicts of batches beside those of the exact check, on real robots.
//
// A small run by default; scripts/test --long makes it the run of 1,000,000 states each that
// docs/many_states.md states.
#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <iostream>

#include "batch_verdicts.h"
#include "benchmark/demo_motion.h"
#include "joint_sampler.h"

namespace collision_pairs::test_batch_verdicts {

constexpr std::uint64_t SEED = 20261121;
constexpr std::size_t AT_A_TIME = 10000;

std::uint64_t nbStates() { return std::getenv("COLLISION_PAIRS_LONG") ? 1000000 : 40000; }

void expectSame(const std::shared_ptr<const CollisionScene>& scene) {
  const std::shared_ptr<const RobotModel> robot(scene, &scene->robot());
  const JointSampler sampler(robot, SEED);
  Verdicts verdicts(scene);
  std::vector<std::vector<double>> states(AT_A_TIME);
  std::uint64_t nb[3] = {0, 0, 0}, nb_differ = 0;
  for (std::uint64_t begin = 0; begin < nbStates(); begin += AT_A_TIME) {
    for (std::size_t i = 0; i < AT_A_TIME; ++i) sampler.draw(begin + i, states[i]);
    const auto found = verdicts.batch(states);
    for (std::size_t i = 0; i < AT_A_TIME; ++i) {
      ++nb[static_cast<int>(found[i])];
      nb_differ += found[i] != verdicts.exact(states[i]);
    }
  }
  EXPECT_GT(verdicts.check().stageMemory(), 0u) << "the stage was not in use";
  EXPECT_EQ(nb_differ, 0u);
  std::cout << nb[0] << " free, " << nb[1] << " in collision, " << nb[2] << " unknown; "
            << nb_differ << " differ\n";
}

void expectSameVerdicts(const BenchmarkRobot& robot) {
  expectSame(CollisionScene::build(robot.robot, robot.srdf, nullptr));
  if (robot.world) expectSame(CollisionScene::build(robot.robot, robot.srdf, robot.world));
}

TEST(BatchVerdicts, AreThoseOfTheExactCheckOnTheDemoRobot) { expectSameVerdicts(demoRobot()); }

TEST(BatchVerdicts, SayWhatEachStateTookIfAskedAndNothingOtherwise) {
  const BenchmarkRobot demo = demoRobot();
  const auto scene = CollisionScene::build(demo.robot, demo.srdf, nullptr);
  const JointSampler sampler(demo.robot, SEED);
  BatchCheck batch(scene, 1);
  CheckSettings settings;
  settings.verdict_only = true;
  const auto position = [&](std::size_t i, std::vector<double>& q) { sampler.draw(i, q); };
  batch.runJoints(BatchCheck::STATES_WORTH_A_STAGE, settings, position, {},
                  [](std::size_t, const CollisionReport& r) { ASSERT_EQ(r.times.total, 0.0); });
  ASSERT_GT(batch.stageMemory(), 0u) << "the stage was not in use";
  settings.stage_times = true;
  double sum = 0.0;
  const auto start = std::chrono::steady_clock::now();
  batch.runJoints(2000, settings, position, {}, [&](std::size_t, const CollisionReport& r) {
    ASSERT_GT(r.times.total, 0.0);
    sum += r.times.total;
  });
  const std::chrono::duration<double> whole = std::chrono::steady_clock::now() - start;
  EXPECT_LE(sum, whole.count()) << "one thread";
}

TEST(BatchVerdicts, AreThoseOfTheExactCheckOnTheDemoRobotAmongObjects) {
  const BenchmarkRobot demo = demoRobot();
  SceneDescription description;
  description.robots.push_back({demo.robot, demo.srdf, ""});
  for (int i = 0; i < 12; ++i) {
    RigidObject object;
    object.name = "object_" + std::to_string(i);
    object.elements.push_back({i % 2 ? Shape(Box{{0.1, 0.2, 0.3}}) : Shape(Cylinder{0.1, 0.4}),
                               Eigen::Isometry3d::Identity()});
    object.X_PO = Eigen::AngleAxisd(i, Eigen::Vector3d(0.6, 0.0, 0.8));
    object.X_PO.translation() = Eigen::Vector3d(std::cos(i), std::sin(i), 0.1 * i) * 1.05;
    description.objects.push_back(object);
  }
  description.objects.push_back(floorAt(-0.5, {}));
  expectSame(CollisionScene::build(description));
}

class OfRobot : public testing::TestWithParam<std::string> {};

TEST_P(OfRobot, AreThoseOfTheExactCheckAloneAndInItsWorld) {
  for (const BenchmarkRobot& robot : benchmarkRobots()) {
    if (robot.name == GetParam()) return expectSameVerdicts(robot);
  }
  GTEST_SKIP() << "skipped: no robots given";
}

INSTANTIATE_TEST_SUITE_P(BatchVerdicts, OfRobot, testing::Values("panda", "ur5", "pr2"));

}  // namespace collision_pairs::test_batch_verdicts
