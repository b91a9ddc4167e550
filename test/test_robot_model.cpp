#include <cmath>

#include <gtest/gtest.h>

#include "collision_pairs/input_error.h"
#include "collision_pairs/robot_model.h"
#include "mixed_robot.h"
#include "random_inputs.h"
#include "refusal.h"

namespace collision_pairs::test_robot_model {

using Pairs = std::vector<std::pair<std::string, std::string>>;

Pairs adjacentNames(const RobotModel& robot) {
  Pairs names;
  for (const auto& [a, b] : robot.adjacentLinks()) {
    names.push_back(std::minmax(robot.links()[a].name, robot.links()[b].name));
  }
  std::sort(names.begin(), names.end());
  return names;
}

Eigen::Isometry3d linkPose(const RobotModel& robot, const std::string& name,
                           const std::vector<double>& positions) {
  std::vector<Eigen::Isometry3d> X_RB;
  robot.forwardKinematics(positions, X_RB);
  const Link& link = robot.links()[robot.findLink(name)];
  return X_RB[link.body] * link.X_BL;
}

TEST(RobotModel, LinksOnFixedJointsAreOneBody) {
  const auto robot = robotFrom(boxLink("base", 1) + boxLink("lid", 1) + boxLink("arm", 1) +
                               boxLink("tool", 1) + joint("j1", "fixed", "base", "lid", "0 0 1") +
                               joint("j2", "revolute", "lid", "arm", "0 0 2") +
                               joint("j3", "fixed", "arm", "tool", "3 0 0"));
  EXPECT_EQ(robot->bodies().size(), 2u);
  EXPECT_EQ(robot->links()[robot->findLink("tool")].body,
            robot->links()[robot->findLink("arm")].body);
  EXPECT_TRUE(linkPose(*robot, "tool", robot->zeroPositions())
                  .translation()
                  .isApprox(Eigen::Vector3d(3, 0, 3), 1e-15));
}

// The square of its length is 0, or infinite.
TEST(RobotModel, AnAxisIsADirectionHoweverShortOrLongItIsWritten) {
  for (const char* length : {"1e-320", "1e-200", "1e200", "1e308"}) {
    const std::string axis = std::string("<axis xyz='0 ") + length + " 0'/>";
    const auto robot = robotFrom(emptyLink("a") + emptyLink("b") +
                                 joint("j", "continuous", "a", "b", "0 0 0", axis));
    EXPECT_EQ(robot->joints()[0].axis, Eigen::Vector3d::UnitY()) << length;
  }
}

TEST(RobotModel, ForwardKinematicsOfAPlanarArmIsTheTextbooks) {
  const std::string about_z = "<axis xyz='0 0 2'/><limit lower='-3' upper='3'/>";
  const auto robot =
      robotFrom(emptyLink("base") + boxLink("upper", 1) + boxLink("lower", 1) + boxLink("hand", 1) +
                joint("a", "revolute", "base", "upper", "0 0 0", about_z) +
                joint("b", "revolute", "upper", "lower", "0.7 0 0", about_z) +
                joint("c", "prismatic", "lower", "hand", "0.4 0 0",
                      "<axis xyz='1 0 0'/><limit lower='0' upper='1'/>"));
  RandomInputs random;
  for (int i = 0; i < 100; ++i) {
    std::vector<double> q = robot->zeroPositions();
    const double a = q[robot->findJoint("a")] = random.uniform(-3, 3);
    const double b = q[robot->findJoint("b")] = random.uniform(-3, 3);
    const double c = q[robot->findJoint("c")] = random.uniform(0, 1);
    const Eigen::Vector3d expected(0.7 * std::cos(a) + (0.4 + c) * std::cos(a + b),
                                   0.7 * std::sin(a) + (0.4 + c) * std::sin(a + b), 0.0);
    EXPECT_LT((linkPose(*robot, "hand", q).translation() - expected).norm(), 1e-15);
  }
}

TEST(RobotModel, ForwardKinematicsIsTheProductOfTheJointsOnePerBody) {
  const std::string axis = "<axis xyz='1 -2 0.5'/><limit lower='-3' upper='3'/>";
  std::string links = emptyLink("l0"), joints;
  const char* types[] = {"revolute", "prismatic", "continuous", "fixed", "floating", "revolute"};
  for (int i = 0; i < 6; ++i) {
    links += boxLink("l" + std::to_string(i + 1), 1);
    joints += "<joint name='j" + std::to_string(i) + "' type='" + types[i] + "'><parent link='l" +
              std::to_string(i) + "'/><child link='l" + std::to_string(i + 1) +
              "'/><origin xyz='0.1 0.2 -0.3' rpy='0.4 -1.1 2.0'/>" + axis + "</joint>";
  }
  const auto alone = robotFrom(links + joints);
  Eigen::Isometry3d X_WR(Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, 3).normalized()));
  X_WR.translation() << 5, -6, 7;
  const auto placed = RobotModel::merge({{alone, "left", X_WR}, {alone, "right", X_WR.inverse()}});
  RandomInputs random;
  for (const RobotModel* robot : {alone.get(), placed.get()}) {
    std::vector<Eigen::Isometry3d> X_RB, X_expected(robot->bodies().size());
    for (int i = 0; i < 100; ++i) {
      std::vector<double> q = robot->zeroPositions();
      for (double& position : q) position = random.uniform(-3, 3);
      robot->forwardKinematics(q, X_RB);
      for (std::size_t b = 0; b < X_RB.size(); ++b) {
        const Body& body = robot->bodies()[b];
        X_expected[b] = body.joint < 0 ? body.X_PJ
                                       : X_expected[body.parent] * body.X_PJ *
                                             robot->joints()[body.joint].motion(q[body.joint]);
        EXPECT_TRUE(X_RB[b].matrix().isApprox(X_expected[b].matrix(), 1e-14)) << b;
      }
    }
  }
}

TEST(RobotModel, AtZeroAMimicJointIsWhereItsLeaderPutsIt) {
  const std::string axis = "<axis xyz='1 0 0'/><limit lower='2' upper='9'/>";
  const auto robot = robotFrom(emptyLink("root") + emptyLink("a") + emptyLink("b") +
                               joint("lead", "prismatic", "root", "a", "0 0 0", axis) +
                               joint("follow", "prismatic", "root", "b", "0 0 0",
                                     axis + "<mimic joint='lead' multiplier='0.5' offset='3'/>"));
  const auto q = robot->zeroPositions();
  EXPECT_EQ(q[robot->findJoint("lead")], 2.0) << "its nearest limit";
  EXPECT_EQ(q[robot->findJoint("follow")], 4.0);
}

TEST(RobotModel, RobotsWithALinkOrAJointOfOneNameAreNotMerged) {
  const auto named = [](const std::string& suffix, const std::string& joint_name) {
    return robotFrom(emptyLink("root" + suffix) + emptyLink("arm" + suffix) +
                     joint(joint_name, "continuous", "root" + suffix, "arm" + suffix));
  };
  EXPECT_NO_THROW(RobotModel::merge({{named("1", "turn1"), ""}, {named("2", "turn2"), ""}}));
  EXPECT_THROW(RobotModel::merge({{named("1", "turn"), ""}, {named("2", "turn"), ""}}), InputError);
  EXPECT_THROW(RobotModel::merge({{named("1", "turn1"), ""}, {named("1", "turn2"), ""}}),
               InputError);
}

TEST(RobotModel, RobotsThatAreMergedMoveAsEachAlone) {
  const auto robot = mixedRobot();
  const Eigen::Isometry3d X_WR =
      Eigen::Translation3d(1, 2, 3) * Eigen::AngleAxisd(0.7, Eigen::Vector3d::UnitX());
  const auto both =
      RobotModel::merge({{robot, "", Eigen::Isometry3d::Identity()}, {robot, "two", X_WR}});
  std::vector<Eigen::Isometry3d> alone, merged;
  robot->forwardKinematics(robot->zeroPositions(), alone);
  both->forwardKinematics(both->zeroPositions(), merged);
  ASSERT_EQ(merged.size(), 2 * alone.size());
  for (std::size_t i = 0; i < alone.size(); ++i) {
    EXPECT_TRUE(merged[i].isApprox(alone[i], 1e-15));
    EXPECT_TRUE(merged[alone.size() + i].isApprox(X_WR * alone[i], 1e-15));
  }
  // So does what was merged before.
  std::vector<Eigen::Isometry3d> again;
  RobotModel::merge({{both, "", X_WR}, {robot, "three", X_WR.inverse()}})
      ->forwardKinematics(std::vector<double>(3 * robot->joints().size()), again);
  ASSERT_EQ(again.size(), 3 * alone.size());
  for (std::size_t i = 0; i < alone.size(); ++i) {
    EXPECT_TRUE(again[i].isApprox(X_WR * alone[i], 1e-15));
    EXPECT_TRUE(again[alone.size() + i].isApprox(X_WR * X_WR * alone[i], 1e-15));
    EXPECT_TRUE(again[2 * alone.size() + i].isApprox(X_WR.inverse() * alone[i], 1e-15));
  }
  const Link& link = both->links()[both->findLink("two/z")];
  EXPECT_EQ(both->links()[both->joints()[link.parent_joint].parent_link].name, "two/root");
}

TEST(RobotModel, PositionsWithoutOneEntryForEachJointAreRefused) {
  const auto robot =
      robotFrom(emptyLink("a") + emptyLink("b") + emptyLink("c") +
                joint("turn", "continuous", "a", "b") + joint("hold", "fixed", "b", "c"));
  std::vector<Eigen::Isometry3d> X_RB;
  for (const std::size_t size : {std::size_t{0}, std::size_t{1}, std::size_t{3}}) {
    std::vector<double> q(size, 0.0);
    EXPECT_THROW(robot->forwardKinematics(q, X_RB), InputError) << size;
    EXPECT_THROW(robot->applyMimics(q), InputError) << size;
  }
}

TEST(RobotModel, ZeroIsTheNearerLimitWhereZeroIsOutOfBounds) {
  const auto robot =
      robotFrom(emptyLink("a") + emptyLink("b") + emptyLink("c") + emptyLink("d") +
                joint("above", "revolute", "a", "b", "0 0 0", "<limit lower='0.5' upper='1'/>") +
                joint("below", "revolute", "b", "c", "0 0 0", "<limit lower='-2' upper='-0.25'/>") +
                joint("free", "continuous", "c", "d", "0 0 0", ""));
  const auto q = robot->zeroPositions();
  EXPECT_EQ(q[robot->findJoint("above")], 0.5);
  EXPECT_EQ(q[robot->findJoint("below")], -0.25);
  EXPECT_EQ(q[robot->findJoint("free")], 0.0);
}

TEST(RobotModel, MimicsFollowThroughChains) {
  const std::string limit = "<limit lower='-9' upper='9'/>";
  const auto robot = robotFrom(emptyLink("a") + emptyLink("b") + emptyLink("c") + emptyLink("d") +
                               joint("first", "revolute", "a", "b", "0 0 0",
                                     limit + "<mimic joint='second' multiplier='2' offset='1'/>") +
                               joint("second", "revolute", "b", "c", "0 0 0",
                                     limit + "<mimic joint='third' multiplier='-1'/>") +
                               joint("third", "revolute", "c", "d", "0 0 0", limit));
  std::vector<double> q(3, 0.0);
  q[robot->findJoint("third")] = 0.5;
  robot->applyMimics(q);
  EXPECT_EQ(q[robot->findJoint("second")], -0.5);
  EXPECT_EQ(q[robot->findJoint("first")], 0.0);
}

TEST(RobotModel, MimicsOfOneRobotFollowNoJointOfAnother) {
  const std::string limit = "<limit lower='-9' upper='9'/>";
  const auto alone = robotFrom(
      emptyLink("a") + emptyLink("b") + emptyLink("c") +
      joint("lead", "revolute", "a", "b", "0 0 0", limit) +
      joint("follow", "revolute", "b", "c", "0 0 0", limit + "<mimic joint='lead' offset='1'/>"));
  const Eigen::Isometry3d here = Eigen::Isometry3d::Identity();
  const auto both = RobotModel::merge({{alone, "left", here}, {alone, "right", here}});
  std::vector<double> q(4, 0.0);
  q[both->findJoint("left/lead")] = 0.25;
  q[both->findJoint("right/lead")] = 0.5;
  both->applyMimics(q);
  EXPECT_EQ(q[both->findJoint("left/follow")], 1.25);
  EXPECT_EQ(q[both->findJoint("right/follow")], 1.5);
}

TEST(RobotModel, NeighboursAreJoinedThroughLinksWithoutGeometryToo) {
  const auto robot =
      robotFrom(boxLink("a", 1) + emptyLink("between") + boxLink("b", 1) + boxLink("c", 1) +
                joint("j1", "revolute", "a", "between") + joint("j2", "revolute", "between", "b") +
                joint("j3", "revolute", "b", "c"));
  EXPECT_EQ(adjacentNames(*robot), (Pairs{{"a", "b"}, {"b", "c"}}));
}

TEST(RobotModel, TwoArmsOnOneEmptyFrameAreNotNeighbours) {
  const auto robot = robotFrom(emptyLink("frame") + boxLink("left", 1) + boxLink("right", 1) +
                               joint("j1", "revolute", "frame", "left") +
                               joint("j2", "revolute", "frame", "right"));
  EXPECT_TRUE(robot->adjacentLinks().empty());
}

TEST(RobotModel, ALinkWhoseMeshIsBrokenStillHasGeometry) {
  std::vector<BrokenElement> broken;
  const auto robot = RobotModel::fromUrdf("<robot name='r'>" + boxLink("a", 1) +
                                              linkWith("b", "<mesh filename='file:///none.stl'/>") +
                                              boxLink("c", 1) + joint("j1", "revolute", "a", "b") +
                                              joint("j2", "revolute", "b", "c") + "</robot>",
                                          noMeshes, &broken);
  ASSERT_EQ(broken.size(), 1u);
  EXPECT_EQ(broken[0].link, "b");
  const Link& link = robot->links()[robot->findLink("b")];
  EXPECT_EQ(link.missing, std::vector<std::string>{broken[0].reason});
  EXPECT_EQ(robot->withElements([](const Link& its) { return its.elements; })
                ->links()[robot->findLink("b")]
                .missing,
            link.missing);
  EXPECT_EQ(adjacentNames(*robot), (Pairs{{"a", "b"}, {"b", "c"}}));
}

TEST(RobotModel, AChainOfTenThousandLinksIsRead) {
  std::string xml = emptyLink("l0");
  for (int i = 1; i <= 10000; ++i) {
    const std::string n = std::to_string(i);
    xml += emptyLink("l" + n) +
           joint("j" + n, "continuous", "l" + std::to_string(i - 1), "l" + n, "0 0 1", "");
  }
  const auto robot = robotFrom(xml);
  EXPECT_NEAR(linkPose(*robot, "l10000", robot->zeroPositions()).translation().z(), 10000.0, 1e-9);
}

TEST(RobotModel, PlacedAtWhatIsNoPoseIsRefused) {
  const auto robot = robotFrom(boxLink("a", 1));
  const auto expectRefused = [&](const Eigen::Isometry3d& X_WR) {
    const std::vector<RobotModel::Placed> two = {{robot, "", Eigen::Isometry3d::Identity()},
                                                 {robot, "two", X_WR}};
    EXPECT_EQ(
        refusal([&] { RobotModel::merge(two); }),
        "robot '" + robot->name() + "': X_WR is not a rotation and a translation in finite numbers")
        << X_WR.matrix();
  };
  RandomInputs random;
  for (int i = 0; i < 100; ++i) {
    Eigen::Isometry3d mirrored = random.pose(1.0), scaled = mirrored, unknown = mirrored;
    mirrored.linear().col(random.integer(0, 2)) *= -1.0;
    scaled.linear() *= i % 2 ? random.uniform(1.001, 3.0) : random.uniform(0.0, 0.999);
    unknown.matrix()(random.integer(0, 2), random.integer(0, 3)) = NAN;
    for (const Eigen::Isometry3d& X_WR : {mirrored, scaled, unknown}) expectRefused(X_WR);
  }
}

}  // namespace collision_pairs::test_robot_model
