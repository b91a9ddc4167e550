// Spheres in place of meshes: never a miss, few false alarms. Distances: test_fidelity_ladder.
#include <iostream>

#include <gmock/gmock.h>

#include "batch_verdicts.h"
#include "benchmark/demo_motion.h"
#include "joint_sampler.h"
#include "random_robot.h"

namespace collision_pairs::test_spheres {

constexpr std::size_t STATES = BatchCheck::STATES_WORTH_A_STAGE;
constexpr std::uint64_t SEED = 20261122;

/// What three ways of checking say of one state.
struct Said {
  Verdict exact, single, batch;
};

/// Of every `step`-th state.
std::vector<Said> saidOf(const std::shared_ptr<const CollisionScene>& scene,
                         const std::vector<std::vector<double>>& states, std::size_t step) {
  Verdicts exact(scene), spheres(scene);
  spheres.settings().fidelity = Fidelity::SPHERES;
  spheres.batch(states);  // answers must not depend on what was asked before
  const auto batch = spheres.batch(states);
  EXPECT_EQ(spheres.check().stageMemory() > 0, scene->unchecked().empty()) << "is a stage in use?";
  std::vector<Said> said;
  for (std::size_t i = 0; i < states.size(); i += step) {
    said.push_back({exact.exact(states[i]), spheres.exact(states[i]), batch[i]});
  }
  return said;
}

/// A batch knows more than spheres of what never moves, so it may be free where the single check is
/// not, but never where the exact check is not.
void expectNoMiss(const Said& said) {
  const auto isFree = [](Verdict verdict) { return verdict == Verdict::FREE; };
  EXPECT_TRUE(isFree(said.exact) || !isFree(said.batch));
  EXPECT_TRUE(isFree(said.batch) || !isFree(said.single));
}

TEST(Spheres, MissNoContactInScenesOfAllKinds) {
  RandomInputs random;
  int nb_alarms = 0, nb_contacts = 0, nb_free = 0;
  for (int round = 0; round < 15; ++round) {
    SCOPED_TRACE("scene " + std::to_string(round));
    const auto scene = CollisionScene::build(randomScene(random));
    std::vector<std::vector<double>> states;
    for (std::size_t i = 0; i < STATES; ++i) {
      states.push_back(randomPositions(random, scene->robot()));
    }
    for (const Said& said : saidOf(scene, states, 15)) {
      expectNoMiss(said);
      nb_contacts += said.exact == Verdict::COLLISION;
      nb_free += said.single == Verdict::FREE;
      nb_alarms += said.exact == Verdict::FREE && said.single != Verdict::FREE;
    }
    if (testing::Test::HasFailure()) return;
  }
  EXPECT_GT(nb_contacts, 1000);
  EXPECT_GT(nb_free, 1000);
  EXPECT_GT(nb_alarms, 0);
}

/// Of random states of the robot: the share of the free ones that is said to be in contact.
double falseAlarms(const std::shared_ptr<const CollisionScene>& scene, bool same_in_batch) {
  const std::shared_ptr<const RobotModel> robot(scene, &scene->robot());
  const JointSampler sampler(robot, SEED);
  std::vector<std::vector<double>> states(STATES);
  for (std::size_t i = 0; i < STATES; ++i) sampler.draw(i, states[i]);
  double nb_free = 0.0, nb_alarms = 0.0;
  for (const Said& said : saidOf(scene, states, EVERY_NTH_STATE)) {
    expectNoMiss(said);
    EXPECT_TRUE(said.single == said.batch || !same_in_batch);
    if (testing::Test::HasFailure()) break;
    nb_free += said.exact == Verdict::FREE;
    nb_alarms += said.exact == Verdict::FREE && said.single != Verdict::FREE;
  }
  std::cout << 100.0 * nb_alarms / nb_free << " % of " << nb_free << " free states\n";
  return nb_alarms / nb_free;
}

// Two joints decide the pair, within so narrow limits that a table of the exact check would learn
// that these states are free.
TEST(Spheres, AFalseAlarmStaysOneHoweverOftenItsStateIsAsked) {
  const std::string ball = "<mesh filename='ball'/>";  // bumpy: a bump of 0.165 m meets 0.135 m
  const std::string turns = "<axis xyz='0 0 1'/><limit lower='-0.1' upper='0.1'/>";
  const auto robot = RobotModel::fromUrdf(
      "<robot name='r'>" + emptyLink("root") + linkWith("a", ball) + emptyLink("b") +
          linkWith("c", ball) + joint("j1", "revolute", "root", "a", "0 0 0", turns) +
          joint("j2", "revolute", "a", "b", "0 0 0", turns) +
          joint("j3", "revolute", "b", "c", "0.302 0 0", turns) + "</robot>",
      testMesh);
  const auto scene = CollisionScene::build(robot, Srdf{}, nullptr);
  RandomInputs random;
  Verdicts exact(scene), spheres(scene);
  spheres.settings().fidelity = Fidelity::SPHERES;
  std::vector<std::vector<double>> alarms, states;
  for (std::size_t i = 0; alarms.size() < 30; ++i) {
    ASSERT_LT(i, STATES);
    const auto one = [&] { return random.uniform(-0.1, 0.1); };
    const std::vector<double> state = {one(), one(), one()};
    const bool is_free = exact.exact(state) == Verdict::FREE;
    if (is_free && spheres.exact(state) != Verdict::FREE) alarms.push_back(state);
  }
  for (std::size_t i = 0; i < STATES; ++i) states.push_back(alarms[i % alarms.size()]);
  EXPECT_THAT(spheres.batch(states), testing::Each(Verdict::COLLISION));
}

TEST(Spheres, AreFreeInNineteenOfTwentyFreeStatesOfTheDemoRobot) {
  const BenchmarkRobot demo = demoRobot();
  EXPECT_LE(falseAlarms(CollisionScene::build(demo.robot, demo.srdf, nullptr), true), 0.05);
}

class SpheresOfRobot : public testing::TestWithParam<std::string> {};

TEST_P(SpheresOfRobot, AreFreeInNineteenOfTwentyFreeStatesAloneAndInItsWorld) {
  for (const BenchmarkRobot& robot : benchmarkRobots()) {
    if (robot.name != GetParam()) continue;
    SceneDescription description;
    description.robots.push_back({robot.robot, robot.srdf, ""});
    SceneCache cache;
    EXPECT_LE(falseAlarms(CollisionScene::build(description, &cache), true), 0.05);
    description.world = robot.world;
    EXPECT_LE(falseAlarms(CollisionScene::build(description, &cache), false), 0.05)
        << "in its world";
    return;
  }
  GTEST_SKIP() << "skipped: no robots given";
}

INSTANTIATE_TEST_SUITE_P(Spheres, SpheresOfRobot, testing::Values("panda", "ur5", "pr2"));

}  // namespace collision_pairs::test_spheres
