// Which links a group of an SRDF moves, against kinematics and against paths to the root.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "link_group.h"
#include "random_robot.h"
#include "refusal.h"

namespace collision_pairs::test_link_group {

using Names = std::set<std::string>;

Names movedNames(const Srdf& srdf, const RobotModel& robot, const std::string& group) {
  Names names;
  for (const int link : linksMovedBy(srdf, robot, group)) names.insert(robot.links()[link].name);
  return names;
}

bool isIn(const Names& names, const std::string& name) { return names.count(name) > 0; }

/// Poses of all links in the frame of the root.
std::vector<Eigen::Isometry3d> linkPoses(const RobotModel& robot, std::vector<double> positions) {
  robot.applyMimics(positions);
  std::vector<Eigen::Isometry3d> X_WB, X_WL;
  robot.forwardKinematics(positions, X_WB);
  for (const Link& link : robot.links()) X_WL.push_back(X_WB[link.body] * link.X_BL);
  return X_WL;
}

/// Links whose poses change when joints of these names, and what mimics them, do.
Names movedInFact(const RobotModel& robot, const Names& joints, RandomInputs& random) {
  std::vector<double> positions = randomPositions(random, robot);
  const auto before = linkPoses(robot, positions);
  for (std::size_t i = 0; i < positions.size(); ++i) {
    if (isIn(joints, robot.joints()[i].name)) positions[i] += random.uniform(0.1, 1.0);
  }
  const auto after = linkPoses(robot, positions);
  Names names;
  for (std::size_t i = 0; i < before.size(); ++i) {
    if (!before[i].isApprox(after[i], 1e-6)) names.insert(robot.links()[i].name);
  }
  return names;
}

TEST(LinksMovedBy, AGroupOfJointsAreThoseWhosePosesChangeWithThem) {
  RandomInputs random;
  int nb_groups = 0;
  for (int i = 0; i < 300; ++i) {
    const auto robot = randomRobot(random, 12);
    Srdf srdf;
    srdf.groups.resize(1);
    for (const Joint& joint : robot->joints()) {
      const bool has_own_position = joint.hasPosition() && !joint.mimic;
      if (has_own_position && random.integer(0, 3) == 0)
        srdf.groups[0].joints.push_back(joint.name);
    }
    const auto& joints = srdf.groups[0].joints;
    const Names expected = movedInFact(*robot, {joints.begin(), joints.end()}, random);
    if (expected.empty()) continue;
    ++nb_groups;
    EXPECT_EQ(movedNames(srdf, *robot, ""), expected) << i;
  }
  EXPECT_GT(nb_groups, 100);
}

/// The links from this one up to the root.
std::vector<std::string> pathToRoot(const RobotModel& robot, int link) {
  std::vector<std::string> path{robot.links()[link].name};
  for (int joint; (joint = robot.links()[link].parent_joint) >= 0;) {
    link = robot.joints()[joint].parent_link;
    path.push_back(robot.links()[link].name);
  }
  return path;
}

/// All links on or below those of these names.
Names below(const RobotModel& robot, const Names& tops) {
  Names names;
  for (std::size_t i = 0; i < robot.links().size(); ++i) {
    for (const std::string& on_path : pathToRoot(robot, static_cast<int>(i))) {
      if (isIn(tops, on_path)) names.insert(robot.links()[i].name);
    }
  }
  return names;
}

/// A random tree without mimic joints: what is in a group is on or below its own links.
std::shared_ptr<const RobotModel> randomTree(RandomInputs& random) {
  std::vector<Link> links(10);
  std::vector<Joint> joints(9);
  for (int i = 0; i < 10; ++i) {
    links[i].name = "link_" + std::to_string(i);
    if (i == 0) continue;
    Joint& joint = joints[i - 1];
    joint.name = "joint_" + std::to_string(i);
    joint.type = random.integer(0, 2) == 0 ? JointType::FIXED : JointType::CONTINUOUS;
    joint.parent_link = random.integer(std::max(0, i - 3), i - 1);
    joint.child_link = i;
  }
  return RobotModel::fromParts("tree", links, joints);
}

TEST(LinksMovedBy, LinksChainsAndSubgroupsAreThoseOnOrBelowThem) {
  RandomInputs random;
  for (int i = 0; i < 1000; ++i) {
    const auto robot = randomTree(random);
    const auto anyLink = [&] { return random.integer(1, 9); };
    Srdf srdf;
    srdf.groups.resize(3);
    for (int g = 0; g < 3; ++g) srdf.groups[g].name = std::to_string(g);
    const std::string link = robot->links()[anyLink()].name;
    srdf.groups[0].links = {link};
    srdf.groups[0].subgroups = {"1"};
    srdf.groups[1].subgroups = {"2", "0"};  // a cycle
    const std::vector<std::string> path = pathToRoot(*robot, anyLink());
    const int base = random.integer(1, static_cast<int>(path.size()) - 1);
    srdf.groups[2].chains = {{path[base], path[0]}};
    Names tops{link};
    EXPECT_EQ(movedNames(srdf, *robot, "2"), below(*robot, {path.begin(), path.begin() + base}));
    tops.insert(path.begin(), path.begin() + base);
    EXPECT_EQ(movedNames(srdf, *robot, "0"), below(*robot, tops)) << i;
    EXPECT_EQ(movedNames(srdf, *robot, "1"), below(*robot, tops)) << i;
  }
}

// A dual-arm chain: neither end is above the other.
TEST(LinksMovedBy, AChainWhoseBaseIsNotAboveItsTipIsTheWholeRobot) {
  std::vector<Link> links(3);
  for (int i = 0; i < 3; ++i) links[i].name = std::string(1, static_cast<char>('a' + i));
  std::vector<Joint> joints(2);
  for (int i = 0; i < 2; ++i) {
    joints[i].name = std::to_string(i);
    joints[i].type = JointType::CONTINUOUS;
    joints[i].parent_link = 0;
    joints[i].child_link = i + 1;
  }
  const auto robot = RobotModel::fromParts("arms", links, joints);
  Srdf srdf;
  srdf.groups.resize(1);
  srdf.groups[0].chains = {{"b", "c"}};
  EXPECT_EQ(movedNames(srdf, *robot, ""), (Names{"a", "b", "c"}));
}

TEST(LinksMovedBy, AVirtualJointAreThoseOnOrBelowItsLinkOfTheRootAll) {
  RandomInputs random;
  const auto robot = randomTree(random);
  Srdf srdf;
  srdf.groups.resize(3);
  srdf.groups[0] = {"mobile", {}, {"world_joint"}, {}, {}};
  srdf.groups[1] = {"base", {"link_0"}, {}, {}, {}};
  srdf.groups[2] = {"tip", {}, {"another"}, {}, {}};
  srdf.virtual_joints = {{"another", "link_9"}, {"world_joint", "link_0"}};
  EXPECT_EQ(movedNames(srdf, *robot, "tip"), (Names{"link_9"}));
  for (const std::string group : {"mobile", "base"}) {
    EXPECT_EQ(movedNames(srdf, *robot, group).size(), 10u) << group;
  }
}

TEST(LinksMovedBy, AGroupThatIsMissingAmbiguousOrEmptyIsRefused) {
  RandomInputs random;
  const auto robot = randomTree(random);
  Srdf srdf;
  const auto refused = [&](const std::string& group) {
    return refusal([&] { linksMovedBy(srdf, *robot, group); });
  };
  EXPECT_EQ(refused("arm"),
            "there is no group 'arm' in the SRDF of robot 'tree', which has no groups");
  srdf.groups.resize(4);
  srdf.groups[0] = {"arm", {"link_1"}, {}, {}, {}};
  srdf.groups[1] = {"hand", {"link_2"}, {}, {}, {}};
  srdf.groups[2] = {"arm", {"link_3"}, {}, {"both"}, {}};
  srdf.groups[3] = {"both", {}, {}, {"hand", "arm"}, {}};
  const std::string two = "the SRDF of robot 'tree' has two groups 'arm'; rename one of them";
  EXPECT_EQ(refused("arm"), two);
  EXPECT_EQ(refused("both"), two);
  EXPECT_EQ(refused("hand"), "accepted");
  EXPECT_EQ(refused("hnad"),
            "there is no group 'hnad' in the SRDF of robot 'tree'; did you mean 'hand'?");
  srdf.groups[1].links.clear();
  EXPECT_EQ(refused("hand"), "group 'hand' moves no link of robot 'tree'");
}

// Pairs of what they should have named would not be checked.
TEST(LinksMovedBy, ANameInTheGroupThatTheRobotDoesNotHaveIsRefused) {
  RandomInputs random;
  const auto robot = randomTree(random);
  Srdf srdf;
  srdf.groups.resize(3);
  srdf.groups[0] = {"whole", {"link_1"}, {}, {"part"}, {}};
  srdf.groups[2] = {"another", {"lonk_1"}, {}, {}, {}};  // not asked for
  srdf.virtual_joints = {{"world_joint", "link_0"}, {"stray_joint", "link_x"}};
  const auto refused = [&](const Srdf::Group& part) {
    srdf.groups[1] = part;
    return refusal([&] { linksMovedBy(srdf, *robot, "whole"); });
  };
  EXPECT_EQ(refused({"part", {"link_2"}, {"joint_3", "world_joint"}, {}, {{"link_0", "link_1"}}}),
            "accepted");
  EXPECT_EQ(refused({"part", {"lnk_2"}, {}, {}, {}}),
            "group 'part' names link 'lnk_2', which robot 'tree' does not have; did you mean "
            "'link_2'?");
  EXPECT_EQ(refused({"part", {}, {"joit_3"}, {}, {}}),
            "group 'part' names joint 'joit_3', which robot 'tree' does not have; did you mean "
            "'joint_3'?");
  EXPECT_EQ(refused({"part", {}, {"wold_joint"}, {}, {}}),
            "group 'part' names joint 'wold_joint', which robot 'tree' does not have; did you mean "
            "'world_joint'?");
  EXPECT_EQ(refused({"part", {}, {"stray_joint"}, {}, {}}),
            "virtual_joint 'stray_joint' names link 'link_x', which robot 'tree' does not have; "
            "did you mean "
            "'link_0'?");
  EXPECT_EQ(refused({"part", {}, {}, {}, {{"link_0", "link4"}}}),
            "group 'part' names link 'link4', which robot 'tree' does not have; did you mean "
            "'link_4'?");
  EXPECT_EQ(refused({"part", {}, {}, {}, {{"lnk_1", "link_4"}}}),
            "group 'part' names link 'lnk_1', which robot 'tree' does not have; did you mean "
            "'link_1'?");
}

}  // namespace collision_pairs::test_link_group
