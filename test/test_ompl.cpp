// States and motions as planners of OMPL ask for them.
#include <atomic>
#include <random>
#include <thread>

#include <gtest/gtest.h>
#include <ompl/base/DiscreteMotionValidator.h>
#include <ompl/base/ScopedState.h>
#include <ompl/base/spaces/SE2StateSpace.h>
#include <ompl/geometric/SimpleSetup.h>
#include <ompl/geometric/planners/rrt/RRTConnect.h>

#include "collision_pairs/occupied_voxels.h"
#include "collision_pairs/ompl.h"
#include "motion_fixtures.h"
#include "random_inputs.h"
#include "refusal.h"

namespace collision_pairs::test_ompl {

namespace ob = ompl::base;
namespace og = ompl::geometric;

constexpr double PI = 3.14159265358979;

/// A bar of 1 m that turns about z and slides along it, and a plate of 2 mm in its way at 1 rad,
/// 1 m high.
std::shared_ptr<const CollisionScene> barAndPlate(double plate_height = 1.0) {
  const auto robot = robotFrom(emptyLink("root") + emptyLink("carriage") + bar("arm", 1.0) +
                               joint("lift", "prismatic", "root", "carriage", "0 0 0",
                                     "<axis xyz='0 0 1'/><limit lower='-2' upper='2'/>") +
                               hinge("turn", "carriage", "arm", "0 0 0"));
  RigidObject plate =
      boxAt("plate", {0.7 * std::cos(1.0), 0.7 * std::sin(1.0), 0.0}, {0.4, 0.002, plate_height});
  plate.X_PO.linear() = Eigen::AngleAxisd(1.0, Eigen::Vector3d::UnitZ()).matrix();
  return sceneOf(robot, {plate});
}

ob::SpaceInformationPtr spaceOf(int nb_dimensions) {
  auto space = std::make_shared<ob::RealVectorStateSpace>(nb_dimensions);
  space->setBounds(-PI, PI);
  return std::make_shared<ob::SpaceInformation>(space);
}

class Ompl : public testing::Test {
 protected:
  explicit Ompl(std::shared_ptr<const CollisionScene> scene = barAndPlate())
      : scene_(std::move(scene)),
        space_(spaceOf(2)),
        states_(std::make_shared<OmplStateValidityChecker>(space_, scene_, joints_)),
        motions_(std::make_shared<OmplMotionValidator>(space_, scene_, joints_)) {
    space_->setStateValidityChecker(states_);
    space_->setMotionValidator(motions_);
    space_->setup();
  }

  ob::ScopedState<ob::RealVectorStateSpace> state(double turn, double lift) const {
    ob::ScopedState<ob::RealVectorStateSpace> made(space_);
    made[0] = turn;
    made[1] = lift;
    return made;
  }

  const OmplJoints joints_{{"turn", "lift"}, {}, {}};
  const std::shared_ptr<const CollisionScene> scene_;
  const ob::SpaceInformationPtr space_;
  const std::shared_ptr<OmplStateValidityChecker> states_;
  const std::shared_ptr<OmplMotionValidator> motions_;
};

TEST_F(Ompl, JointsAreTakenInTheOrderOfTheirNames) {
  EXPECT_TRUE(states_->isValid(state(0.0, 0.0).get()));
  EXPECT_FALSE(states_->isValid(state(1.0, 0.0).get()));
  EXPECT_TRUE(states_->isValid(state(0.0, 1.0).get()));
  EXPECT_TRUE(states_->isValid(state(1.0, 0.6).get()));
}

TEST_F(Ompl, TheClearanceIsTheSmallestDistanceAndNotPositiveInContact) {
  EXPECT_NEAR(states_->clearance(state(1.0, 0.6).get()), 0.6 - 0.5 - 0.01, 1e-12);
  EXPECT_LT(states_->clearance(state(1.0, 0.5).get()), 0.0);
}

TEST_F(Ompl, WhatCannotBeCheckedIsNotValid) {
  const double nan = std::nan("");
  EXPECT_FALSE(states_->isValid(state(nan, 0.0).get()));
  EXPECT_EQ(states_->clearance(state(nan, 0.0).get()), 0.0);
  EXPECT_FALSE(motions_->checkMotion(state(0.0, 0.0).get(), state(0.0, nan).get()));
  EXPECT_TRUE(states_->isValid(state(0.0, 0.0).get())) << "the next state is checked";
}

TEST_F(Ompl, AThinPlateBetweenTwoValidStatesIsNotSteppedOver) {
  const auto from = state(0.8, 0.0), to = state(1.2, 0.0);
  ASSERT_TRUE(states_->isValid(from.get()) && states_->isValid(to.get()));
  EXPECT_TRUE(ob::DiscreteMotionValidator(space_).checkMotion(from.get(), to.get()))
      << "by samples it is; otherwise this is no test";
  EXPECT_FALSE(motions_->checkMotion(from.get(), to.get()));
  EXPECT_TRUE(motions_->checkMotion(from.get(), state(0.9, 0.5).get()));
  EXPECT_EQ(motions_->getValidMotionCount(), 1u);
  EXPECT_EQ(motions_->getInvalidMotionCount(), 1u);
}

TEST_F(Ompl, TheLastValidStateIsJustBeforeTheContact) {
  const auto from = state(0.5, 0.0), to = state(1.5, 0.0);
  auto last = state(9.0, 9.0);
  std::pair<ob::State*, double> last_valid(last.get(), -1.0);
  ASSERT_FALSE(motions_->checkMotion(from.get(), to.get(), last_valid));
  EXPECT_DOUBLE_EQ(last[0], 0.5 + last_valid.second);
  EXPECT_TRUE(states_->isValid(last.get()));
  EXPECT_LT(states_->clearance(last.get()), 2e-3);
  const auto before = state(0.5 + 0.99 * last_valid.second, 0.0);
  EXPECT_TRUE(motions_->checkMotion(from.get(), before.get()));
  last_valid = {nullptr, -1.0};
  EXPECT_FALSE(motions_->checkMotion(state(1.0, 0.0).get(), to.get(), last_valid));
  EXPECT_EQ(last_valid.second, 0.0);
  last_valid.second = -1.0;
  EXPECT_TRUE(motions_->checkMotion(from.get(), from.get(), last_valid));
  EXPECT_EQ(last_valid.second, -1.0) << "of a valid motion it is left alone";
}

TEST_F(Ompl, ManyThreadsGetTheAnswersOfOne) {
  constexpr int NB_STATES = 400;
  std::vector<ob::ScopedState<ob::RealVectorStateSpace>> states;
  for (int i = 0; i < NB_STATES; ++i) states.push_back(state(0.7 + 0.6 * i / NB_STATES, 0.3));
  std::vector<char> expected;
  for (const auto& s : states) expected.push_back(states_->isValid(s.get()));
  ASSERT_NE(expected, std::vector<char>(NB_STATES, expected[0]));
  std::atomic<int> nb_wrong{0};
  std::vector<std::thread> threads;
  for (int t = 0; t < 8; ++t) {
    threads.emplace_back([&] {
      for (int i = 0; i < NB_STATES; ++i)
        nb_wrong += states_->isValid(states[i].get()) != expected[i];
      for (int i = 0; i + 9 < NB_STATES; i += 10) {
        const bool is_valid = motions_->checkMotion(states[i].get(), states[i + 9].get());
        nb_wrong += is_valid && !(expected[i] && expected[i + 9]);
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(nb_wrong, 0);
}

TEST_F(Ompl, AnEdgeIsValidIfItIsCertifiedAndOnlyThen) {
  MotionCheck check(scene_);
  const RobotModel& robot = scene_->robot();
  const int turn = robot.findJoint("turn"), lift = robot.findJoint("lift");
  std::mt19937_64 random(32);
  std::uniform_real_distribution<double> anywhere(-1.9, 1.9);
  int nb_valid = 0;
  constexpr int NB_EDGES = 1000;
  for (int i = 0; i < NB_EDGES; ++i) {
    JointMotion motion{robot.zeroPositions(), robot.zeroPositions()};
    for (std::vector<double>* end : {&motion.from, &motion.to}) {
      (*end)[turn] = anywhere(random);
      (*end)[lift] = anywhere(random);
    }
    const auto from = state(motion.from[turn], motion.from[lift]);
    const auto to = state(motion.to[turn], motion.to[lift]);
    const bool is_valid = motions_->checkMotion(from.get(), to.get());
    ASSERT_EQ(is_valid, check.check(motion, {}).verdict == Verdict::FREE) << i;
    nb_valid += is_valid;
  }
  EXPECT_GT(nb_valid, NB_EDGES / 10);
  EXPECT_LT(nb_valid, NB_EDGES - NB_EDGES / 10);
}

// A base that stands in its table.
TEST(OmplMotions, LeaveOutWhatTheMotionCannotChangeIfToldSo) {
  const auto robot =
      robotFrom(boxLink("base", 0.4) + bar("arm", 1.0) + hinge("turn", "base", "arm", "0 0 0.5"));
  const auto scene = sceneOf(robot, {boxAt("table", {0.0, 0.0, -0.3}, {2.0, 2.0, 0.3}),
                                     boxAt("post", {0.7, 0.7, 0.5}, {0.1, 0.1, 0.1})});
  const auto space = spaceOf(1);
  ob::ScopedState<ob::RealVectorStateSpace> from(space), free(space), behind_post(space);
  from[0] = 0.0;
  free[0] = -0.5;
  behind_post[0] = 1.0;
  MotionSettings settings;
  EXPECT_FALSE(OmplMotionValidator(space, scene, {{"turn"}, {}, {}}, settings)
                   .checkMotion(from.get(), free.get()));
  settings.only_moved = true;
  const OmplMotionValidator motions(space, scene, {{"turn"}, {}, {}}, settings);
  EXPECT_TRUE(motions.checkMotion(from.get(), free.get()));
  EXPECT_FALSE(motions.checkMotion(from.get(), behind_post.get()));

  ob::ScopedState<ob::RealVectorStateSpace> in_post(space);
  in_post[0] = 0.785;
  EXPECT_FALSE(motions.checkMotion(from.get(), in_post.get()));
  const auto post_alone = sceneOf(robot, {boxAt("post", {0.7, 0.7, 0.5}, {0.1, 0.1, 0.1})});
  settings.only_moved = false;
  settings.clearance_of = [](auto, auto) { return -1.0; };
  EXPECT_FALSE(OmplMotionValidator(space, post_alone, {{"turn"}, {}, {}}, settings)
                   .checkMotion(from.get(), free.get()))
      << "nothing is left";
  const auto arm = static_cast<std::uint32_t>(post_alone->findModel("arm"));
  const auto post = static_cast<std::uint32_t>(post_alone->findModel("post"));
  settings.clearance_of = [=](auto first, auto second) {
    return std::pair(first, second) ==
                   std::pair<std::uint32_t, std::uint32_t>(std::minmax(arm, post))
               ? -1.0
               : 0.0;
  };
  EXPECT_TRUE(OmplMotionValidator(space, post_alone, {{"turn"}, {}, {}}, settings)
                  .checkMotion(from.get(), in_post.get()));
}

TEST_F(Ompl, JointsThatAreNotNamedStayWhereTheyAreSaidToBe) {
  OmplJoints only_turn{{"turn"}, scene_->robot().zeroPositions(), {}};
  const auto space = spaceOf(1);
  ob::ScopedState<ob::RealVectorStateSpace> at_plate(space);
  at_plate[0] = 1.0;
  EXPECT_FALSE(OmplStateValidityChecker(space, scene_, only_turn).isValid(at_plate.get()));
  only_turn.positions[scene_->robot().findJoint("lift")] = 0.6;
  EXPECT_TRUE(OmplStateValidityChecker(space, scene_, only_turn).isValid(at_plate.get()));
}

/// A ball that slides along x.
std::shared_ptr<const RobotModel> ball() {
  return robotFrom(emptyLink("root") + linkWith("ball", "<sphere radius='0.5'/>") +
                   joint("x", "prismatic", "root", "ball", "0 0 0",
                         "<axis xyz='1 0 0'/><limit lower='-9' upper='9'/>"));
}

TEST(OmplStates, AreValidAndClearAsADirectCheckSaysThem) {
  const auto scene = sceneOf(ball(), {boxAt("corner", {2.0, 1.4, 0.0}, {2.0, 2.0, 2.0}),
                                      boxAt("far", {-7.0, 0.0, 0.0}, {1.0, 1.0, 1.0})});
  const auto space = spaceOf(1);
  CollisionDetector detector(scene);
  int nb_valid[2] = {0, 0};
  for (const Fidelity fidelity : {Fidelity::AABB, Fidelity::MESH}) {
    CheckSettings settings;
    settings.fidelity = fidelity;
    CheckSettings with_others = settings;  // which do not count
    with_others.alarm_distance = 9.0;
    with_others.time_budget = 1e-9;
    with_others.max_contacts = 1;
    with_others.verdict_only = true;
    with_others.is_enough = [](const Contact&) -> bool { throw std::logic_error("is not asked"); };
    const OmplStateValidityChecker states(space, scene, {{"x"}, {}, {}}, with_others);
    EXPECT_EQ(states.getSpecs().clearanceComputationType, ob::StateValidityCheckerSpecs::EXACT);
    with_others.tolerance = 0.01;
    EXPECT_EQ(OmplStateValidityChecker(space, scene, {{"x"}, {}, {}}, with_others)
                  .getSpecs()
                  .clearanceComputationType,
              ob::StateValidityCheckerSpecs::BOUNDED_APPROXIMATE);
    settings.alarm_distance = 0.0;
    settings.min_distance = true;
    for (double x = -8.0; x < 3.0; x += 0.05) {
      ob::ScopedState<ob::RealVectorStateSpace> state(space);
      state[0] = x;
      std::vector<double> positions = scene->robot().unnamedPositions();
      positions[scene->robot().findJoint("x")] = x;
      std::vector<Eigen::Isometry3d> X_RB;
      BodyPoses poses;
      scene->robot().forwardKinematics(positions, X_RB);
      scene->gatherPoses(X_RB, poses);
      const CollisionReport& report = detector.detect(poses, settings);
      EXPECT_EQ(states.isValid(state.get()), report.verdict == Verdict::FREE) << x;
      EXPECT_EQ(states.clearance(state.get()), report.min_distance) << x;
      nb_valid[fidelity == Fidelity::MESH] += report.verdict == Verdict::FREE;
    }
  }
  EXPECT_LT(nb_valid[0], nb_valid[1]);
}

TEST(OmplMotions, CountWithTheFidelityAndTheClearanceOfTheirSettings) {
  const auto scene = sceneOf(ball(), {boxAt("corner", {2.0, 1.4, 0.0}, {2.0, 2.0, 2.0})});
  const auto space = spaceOf(1);
  ob::ScopedState<ob::RealVectorStateSpace> from(space), to(space);
  from[0] = -3.0;
  to[0] = 0.6;  // its cube reaches into the corner, which is 0.066 m from it
  const auto isValid = [&](Fidelity fidelity, double clearance) {
    MotionSettings settings;
    settings.fidelity = fidelity;
    settings.clearance = clearance;
    const OmplMotionValidator motions(space, scene, {{"x"}, {}, {}}, settings);
    std::pair<ob::State*, double> last_valid(nullptr, -1.0);
    const bool is_valid = motions.checkMotion(from.get(), to.get());
    EXPECT_EQ(motions.checkMotion(from.get(), to.get(), last_valid), is_valid);
    return is_valid;
  };
  EXPECT_TRUE(isValid(Fidelity::MESH, 0.0));
  EXPECT_FALSE(isValid(Fidelity::AABB, 0.0));
  EXPECT_FALSE(isValid(Fidelity::MESH, 0.1));
}

TEST(OmplClouds, AreObstaclesOfStatesAndMotionsAndWithoutThemNothingIsValid) {
  SceneDescription description =
      described(ball(), {boxAt("far", {-9.0, 0.0, 0.0}, {1.0, 1.0, 1.0})});
  description.clouds.push_back(cloudOf("cloud", 0.5, {}));
  const auto scene = CollisionScene::build(description);
  const auto space = spaceOf(1);
  ob::ScopedState<ob::RealVectorStateSpace> from(space), before(space), behind(space), in(space);
  from[0] = -2.0;
  before[0] = -1.0;
  in[0] = 0.3;
  behind[0] = 2.0;
  const std::vector<VoxelCell> at_zero = {VoxelCell(0, 0, 0)};
  const OmplJoints seen{{"x"}, {}, {std::make_shared<const OccupiedVoxels>(0.5, at_zero)}};
  const OmplStateValidityChecker states(space, scene, seen);
  EXPECT_TRUE(states.isValid(from.get()));
  EXPECT_FALSE(states.isValid(in.get()));
  EXPECT_NEAR(states.clearance(from.get()), 1.5, 1e-9);
  const OmplMotionValidator motions(space, scene, seen);
  EXPECT_TRUE(motions.checkMotion(from.get(), before.get()));
  EXPECT_FALSE(motions.checkMotion(from.get(), in.get()));
  EXPECT_FALSE(motions.checkMotion(from.get(), behind.get()));
  const OmplJoints unseen{{"x"}, {}, {}};
  const OmplStateValidityChecker blind(space, scene, unseen);
  EXPECT_FALSE(blind.isValid(from.get()));
  EXPECT_EQ(blind.clearance(from.get()), 0.0) << "whatever is far from it";
  EXPECT_FALSE(OmplMotionValidator(space, scene, unseen).checkMotion(from.get(), before.get()));
}

TEST(OmplJoints, ThatAreNotNamedStandWhereTheirLimitsAllow) {
  const auto scene = sceneOf(
      robotFrom(emptyLink("root") + linkWith("ball", "<sphere radius='0.5'/>") + emptyLink("rail") +
                joint("y", "prismatic", "root", "rail", "0 0 0",
                      "<axis xyz='0 1 0'/><limit lower='2' upper='3'/>") +
                joint("x", "prismatic", "rail", "ball", "0 0 0",
                      "<axis xyz='1 0 0'/><limit lower='-9' upper='9'/>")),
      {boxAt("at_zero", {0.0, 0.0, 0.0}, {1.0, 1.0, 1.0})});
  const auto space = spaceOf(1);
  ob::ScopedState<ob::RealVectorStateSpace> state(space);
  state[0] = 0.0;
  EXPECT_NEAR(OmplStateValidityChecker(space, scene, {{"x"}, {}, {}}).clearance(state.get()), 1.0,
              1e-9);
}

// A bar follows a joint that no planner moves; what the caller says of the follower is anything.
TEST(OmplJoints, ThatMimicOneThatIsNotNamedStandWhereItTakesThem) {
  const auto robot =
      robotFrom(emptyLink("root") + emptyLink("axle") + bar("arm", 1.0) + bar("other", 1.0) +
                hinge("lead", "root", "axle", "0 0 5") + hinge("own", "root", "other", "0 0 9") +
                joint("follow", "continuous", "root", "arm", "0 0 0",
                      "<axis xyz='0 0 1'/><mimic joint='lead' multiplier='0.5' offset='0.1'/>"));
  const auto scene = sceneOf(robot, {boxAt("post", {0.6, 0.3, 0.0}, {0.2, 0.2, 1.0})});
  const auto space = spaceOf(1);
  const OmplJoints both{{"lead", "follow"}, {}, {}};  // in no state drawn does it follow
  EXPECT_EQ(refusal([&] { OmplMotionValidator(spaceOf(2), scene, both); }),
            "joint 'follow' mimics 'lead'; name that joint alone");
  OmplJoints nowhere{{"own"}, robot->zeroPositions(), {}};
  nowhere.positions[robot->findJoint("lead")] = std::nan("");
  EXPECT_EQ(refusal([&] { OmplMotionValidator(space, scene, nowhere); }),
            "joint 'lead' is not named, and its position is not finite");
  ob::ScopedState<ob::RealVectorStateSpace> from(space), to(space);
  from[0] = 0.0;
  to[0] = 0.1;
  RandomInputs random;
  int nb_in_contact = 0;
  for (int i = 0; i < 200; ++i) {
    OmplJoints joints{{"own"}, robot->zeroPositions(), {}};
    const double lead = random.uniform(-PI, PI);
    joints.positions[robot->findJoint("lead")] = lead;
    joints.positions[robot->findJoint("follow")] = random.uniform(-PI, PI);
    BodyPoses poses;
    std::vector<Eigen::Isometry3d> X_RB;
    std::vector<double> consistent = joints.positions;
    consistent[robot->findJoint("follow")] = 0.5 * lead + 0.1;
    robot->forwardKinematics(consistent, X_RB);
    scene->gatherPoses(X_RB, poses);
    const bool is_free = CollisionDetector(scene).detect(poses, {}).verdict == Verdict::FREE;
    nb_in_contact += !is_free;
    EXPECT_EQ(OmplStateValidityChecker(space, scene, joints).isValid(from.get()), is_free) << i;
    const OmplMotionValidator motions(space, scene, joints);
    std::pair<ob::State*, double> last_valid{nullptr, 0.0};
    EXPECT_EQ(motions.checkMotion(from.get(), to.get()), is_free) << i;
    EXPECT_EQ(motions.checkMotion(from.get(), to.get(), last_valid), is_free) << i;
  }
  EXPECT_GT(nb_in_contact, 20);
  EXPECT_LT(nb_in_contact, 180);
}

// A planner would look for a valid state until its time is over.
TEST_F(Ompl, SettingsForWhichNoStateIsValidAreRefused) {
  CheckSettings negative;
  negative.tolerance = -1.0;
  EXPECT_THROW(OmplStateValidityChecker(space_, scene_, joints_, negative), InputError);
  MotionSettings of_motions[5];
  of_motions[0].clearance = -1.0;
  of_motions[1].resolution = 0.0;
  of_motions[2].clearance_of = [](auto, auto) { return 0.1; };
  of_motions[3].clearance = 1e300;
  of_motions[4].resolution = 1e300;
  for (const MotionSettings& settings : of_motions) {
    EXPECT_THROW(OmplMotionValidator(space_, scene_, joints_, settings), InputError);
  }
  const CloudVoxels surplus(3);
  EXPECT_THROW(OmplStateValidityChecker(space_, scene_, {joints_.names, {}, surplus}), InputError);
  EXPECT_THROW(OmplMotionValidator(space_, scene_, {joints_.names, {}, surplus}), InputError);
}

TEST_F(Ompl, ASpaceThatDoesNotFitIsRefused) {
  const auto turns = std::make_shared<ob::SpaceInformation>(std::make_shared<ob::SE2StateSpace>());
  const auto refused = [&](const ob::SpaceInformationPtr& space) {
    return refusal([&] { OmplStateValidityChecker(space, scene_, joints_); });
  };
  EXPECT_EQ(refused(turns), "the state space is not a RealVectorStateSpace");
  EXPECT_EQ(refused(spaceOf(3)), "the state space has 3 dimensions, but 2 joints are named");
  struct Shortest : ob::RealVectorStateSpace {  // the shorter way round
    using RealVectorStateSpace::RealVectorStateSpace;
  };
  const auto round = std::make_shared<ob::SpaceInformation>(std::make_shared<Shortest>(2));
  EXPECT_EQ(refused(round), "accepted");
  EXPECT_EQ(
      refusal([&] { OmplMotionValidator(round, scene_, joints_); }),
      "the state space is derived from RealVectorStateSpace, so that its motions may be others "
      "than straight lines, which alone are certified");
  EXPECT_THROW(OmplMotionValidator(space_, scene_, {{"turn", "lft"}, {}, {}}), InputError);
  EXPECT_THROW(OmplMotionValidator(space_, scene_, {{"turn", "lift"}, {0.0}, {}}), InputError);
}

TEST_F(Ompl, APlannerFindsAPathThatNoSampleContradicts) {
  og::SimpleSetup setup(space_);
  setup.setStartAndGoalStates(state(0.5, 0.0), state(1.5, 0.0));
  setup.setPlanner(std::make_shared<og::RRTConnect>(space_));
  ASSERT_TRUE(setup.solve(20.0));
  og::PathGeometric path = setup.getSolutionPath();
  ASSERT_GE(path.getStateCount(), 3u);
  path.interpolate(10000);
  for (const ob::State* at : path.getStates()) ASSERT_TRUE(states_->isValid(at));
}

}  // namespace collision_pairs::test_ompl
