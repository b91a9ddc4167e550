// A robot made of links and joints is the one that its URDF gives.
#include <algorithm>
#include <limits>
#include <numeric>

#include <gtest/gtest.h>

#include "collision_pairs/input_error.h"
#include "random_robot.h"
#include "refusal.h"

namespace collision_pairs::test_robot_parts {

constexpr double NAN_ = std::numeric_limits<double>::quiet_NaN();
constexpr double INF = std::numeric_limits<double>::infinity();

struct Parts {
  std::vector<Link> links;
  std::vector<Joint> joints;

  std::shared_ptr<const RobotModel> robot() const {
    return RobotModel::fromParts("r", links, joints);
  }
};

std::vector<int> shuffled(RandomInputs& random, std::size_t size) {
  std::vector<int> order(size);
  std::iota(order.begin(), order.end(), 0);
  std::shuffle(order.begin(), order.end(), random.engine());
  return order;
}

/// Those of the robot in random order, without what fromParts() has to find out.
Parts partsOf(RandomInputs& random, const RobotModel& robot) {
  const std::vector<int> link_of = shuffled(random, robot.links().size());
  const std::vector<int> joint_of = shuffled(random, robot.joints().size());
  Parts parts;
  parts.links.resize(link_of.size());
  parts.joints.resize(joint_of.size());
  for (std::size_t i = 0; i < link_of.size(); ++i) {
    Link link = robot.links()[i];
    link.parent_joint = link.body = random.integer(-9, 9);
    link.X_BL = random.pose(1.0);
    parts.links[link_of[i]] = link;
  }
  for (std::size_t i = 0; i < joint_of.size(); ++i) {
    Joint joint = robot.joints()[i];
    joint.parent_link = link_of[joint.parent_link];
    joint.child_link = link_of[joint.child_link];
    if (joint.mimic) joint.mimic->joint = joint_of[joint.mimic->joint];
    parts.joints[joint_of[i]] = joint;
  }
  return parts;
}

/// Pose of a link in the root's frame, by name; positions by name of the joint.
Eigen::Matrix4d poseOf(const RobotModel& robot, const std::string& link, const RobotModel& other,
                       const std::vector<double>& of_other) {
  std::vector<double> positions(robot.joints().size());
  for (std::size_t i = 0; i < positions.size(); ++i) {
    positions[i] = of_other[other.findJoint(robot.joints()[i].name)];
  }
  robot.applyMimics(positions);
  std::vector<Eigen::Isometry3d> X_RB;
  robot.forwardKinematics(positions, X_RB);
  const Link& found = robot.links()[robot.findLink(link)];
  return (X_RB[found.body] * found.X_BL).matrix();
}

std::string nameOf(const RobotModel& robot, int link) { return robot.links()[link].name; }

using Names = std::vector<std::pair<std::string, std::string>>;

Names adjacentNames(const RobotModel& robot) {
  Names names;
  for (const auto& [a, b] : robot.adjacentLinks()) {
    names.push_back(std::minmax(nameOf(robot, a), nameOf(robot, b)));
  }
  std::sort(names.begin(), names.end());
  return names;
}

TEST(RobotParts, InAnyOrderGiveTheRobotOfTheUrdfToTheLastBit) {
  RandomInputs random;
  for (int i = 0; i < 200; ++i) {
    const auto read = randomRobot(random, random.integer(1, 15));
    const auto made = partsOf(random, *read).robot();
    ASSERT_EQ(made->links().size(), read->links().size());
    ASSERT_EQ(made->bodies().size(), read->bodies().size());
    EXPECT_EQ(adjacentNames(*made), adjacentNames(*read));
    const std::vector<double> positions = randomPositions(random, *read);
    for (const Link& link : read->links()) {
      const Link& same = made->links()[made->findLink(link.name)];
      EXPECT_EQ(same.has_geometry, link.has_geometry);
      EXPECT_EQ(same.elements.size(), link.elements.size());
      EXPECT_EQ(nameOf(*made, made->bodies()[same.body].link),
                nameOf(*read, read->bodies()[link.body].link));
      EXPECT_EQ(poseOf(*made, link.name, *read, positions),
                poseOf(*read, link.name, *read, positions))
          << link.name;
    }
    for (std::size_t j = 0; j < made->joints().size(); ++j) {
      const Joint& joint = made->joints()[j];
      EXPECT_LT(joint.parent_link, joint.child_link);
      EXPECT_EQ(made->links()[joint.child_link].parent_joint, static_cast<int>(j));
      EXPECT_EQ(made->findJoint(joint.name), static_cast<int>(j));
    }
  }
}

TEST(RobotParts, InTheOrderOfARobotKeepItsNumbers) {
  RandomInputs random;
  for (int i = 0; i < 50; ++i) {
    const auto read = randomRobot(random, random.integer(1, 15));
    const auto made = RobotModel::fromParts("r", read->links(), read->joints(), {"a word"});
    EXPECT_EQ(made->name(), "r");
    EXPECT_EQ(made->warnings(), std::vector<std::string>{"a word"});
    for (std::size_t l = 0; l < read->links().size(); ++l) {
      EXPECT_EQ(made->links()[l].name, read->links()[l].name);
      EXPECT_EQ(made->links()[l].body, read->links()[l].body);
    }
    for (std::size_t j = 0; j < read->joints().size(); ++j) {
      EXPECT_EQ(made->joints()[j].name, read->joints()[j].name);
      EXPECT_EQ(made->joints()[j].axis, read->joints()[j].axis);
    }
    EXPECT_EQ(made->zeroPositions(), read->zeroPositions());
  }
}

/// root, with a box and a sphere below it; joint "lift" leads joint "tilt".
Parts threeLinks() {
  Parts parts;
  parts.links.resize(3);
  parts.joints.resize(2);
  parts.links[0].name = "root";
  parts.links[1].name = "box";
  parts.links[1].elements = {{Box{{1.0, 1.0, 1.0}}, Eigen::Isometry3d::Identity()}};
  parts.links[2].name = "ball";
  parts.links[2].elements = {{Sphere{0.5}, Eigen::Isometry3d::Identity()}};
  for (int i = 0; i < 2; ++i) {
    parts.joints[i].type = JointType::REVOLUTE;
    parts.joints[i].parent_link = i;
    parts.joints[i].child_link = i + 1;
    parts.joints[i].lower = -1.0;
    parts.joints[i].upper = 1.0;
  }
  parts.joints[0].name = "lift";
  parts.joints[1].name = "tilt";
  parts.joints[1].mimic = Joint::Mimic{0, 2.0, 0.25};
  return parts;
}

TEST(RobotParts, OfAFloatingJointAreABodyOfTheirOwn) {
  Parts parts = threeLinks();
  parts.joints[1].type = JointType::FLOATING;
  parts.joints[1].mimic.reset();
  EXPECT_EQ(parts.robot()->bodies().size(), 3u);
  parts.joints[1].type = JointType::FIXED;
  EXPECT_EQ(parts.robot()->bodies().size(), 2u);
}

TEST(RobotParts, HaveGeometryIfTheyHaveAnElementOrLostOne) {
  Parts parts = threeLinks();
  parts.links[2].elements.clear();
  parts.links[2].has_geometry = true;
  const auto robot = parts.robot();
  EXPECT_FALSE(robot->links()[0].has_geometry);
  EXPECT_TRUE(robot->links()[1].has_geometry);
  EXPECT_TRUE(robot->links()[2].has_geometry);
}

TEST(RobotParts, TakeAnAxisOfAnyLength) {
  for (const double length : {1e-320, 1e-200, 0.3, 1.0, 1e200, 1e308}) {
    Parts parts = threeLinks();
    parts.joints[0].axis = {0.0, length, 0.0};
    EXPECT_EQ(parts.robot()->joints()[0].axis, Eigen::Vector3d::UnitY()) << length;
  }
}

TEST(RobotParts, ThatAreWrongAreNamed) {
  const auto refusalAfter = [](const std::function<void(Parts&)>& spoil) {
    Parts parts = threeLinks();
    spoil(parts);
    return refusal([&] { parts.robot(); });
  };
  struct Case {
    std::function<void(Parts&)> spoil;
    std::string says;
  };
  const auto scaled = [](Eigen::Isometry3d& X) { X.linear() *= 1.001; };
  const auto mirrored = [](Eigen::Isometry3d& X) { X.linear().col(0) *= -1.0; };
  const std::string no_pose = " is not a rotation and a translation in finite numbers";
  const std::string bad_box =
      "link 'box': box: a size is nan, but must be a finite number of metres, 0 or more";
  const Case cases[] = {
      {[](Parts& p) { p = {}; }, "it has no link"},
      {[](Parts& p) { p.links[1].name = ""; }, "link 1 has no name"},
      {[](Parts& p) { p.joints[1].name = ""; }, "joint 1 has no name"},
      {[](Parts& p) { p.links[2].name = "box"; }, "a second link 'box'"},
      {[](Parts& p) { p.joints[1].name = "lift"; }, "a second joint 'lift'"},
      {[](Parts& p) { p.joints[1].parent_link = 3; },
       "joint 'tilt': there is no link 3: they are numbered from 0 to 2"},
      {[](Parts& p) { p.joints[0].child_link = -1; },
       "joint 'lift': there is no link -1: they are numbered from 0 to 2"},
      {[](Parts& p) { p.joints[1].child_link = 1; },
       "link 'box' has two parents, joints 'lift' and 'tilt'"},
      {[](Parts& p) { p.joints.pop_back(); },
       "two root links, 'root' and 'ball'; join one to the other, or make them two robots of one "
       "scene"},
      {[](Parts& p) {
         p.joints.push_back(p.joints[0]);
         p.joints[2].name = "back";
         p.joints[2].parent_link = 2;
         p.joints[2].child_link = 0;
       },
       "no root link: the links form a cycle"},
      {[](Parts& p) {
         p.joints[0].parent_link = 2;
         p.joints[0].child_link = 1;
       },
       "link 'box' is part of, or attached to, a cycle of links"},
      {[](Parts& p) { p.joints[1].parent_link = 2; },
       "link 'ball' is part of, or attached to, a cycle of links"},
      {[](Parts& p) { p.joints[0].axis.setZero(); },
       "joint 'lift': its axis is zero, or not finite"},
      {[](Parts& p) { p.joints[0].axis.x() = INF; },
       "joint 'lift': its axis is zero, or not finite"},
      {[](Parts& p) { p.joints[0].axis.y() = NAN_; },
       "joint 'lift': its axis is zero, or not finite"},
      {[](Parts& p) { p.joints[0].X_PJ.translation().x() = NAN_; }, "joint 'lift': X_PJ" + no_pose},
      {[](Parts& p) { p.joints[1].X_PJ.linear()(2, 1) = INF; }, "joint 'tilt': X_PJ" + no_pose},
      {[&](Parts& p) { scaled(p.joints[0].X_PJ); }, "joint 'lift': X_PJ" + no_pose},
      {[&](Parts& p) { mirrored(p.joints[0].X_PJ); }, "joint 'lift': X_PJ" + no_pose},
      {[&](Parts& p) { mirrored(p.links[2].elements[0].X_LE); },
       "link 'ball': X_LE of element 0" + no_pose},
      {[](Parts& p) { p.joints[0].upper = INF; }, "joint 'lift': its limits are not finite"},
      {[](Parts& p) { p.joints[0].lower = NAN_; }, "joint 'lift': its limits are not finite"},
      {[](Parts& p) { p.joints[0].lower = 2.0; },
       "joint 'lift': its lower limit is above its upper limit"},
      {[](Parts& p) { p.joints[1].mimic->joint = 2; },
       "joint 'tilt': what it mimics: there is no joint 2: they are numbered from 0 to 1"},
      {[](Parts& p) { p.joints[0].type = JointType::FIXED; },
       "joint 'tilt': it mimics 'lift', which has no position"},
      {[](Parts& p) { p.joints[1].type = JointType::FLOATING; },
       "joint 'tilt': it mimics another, but has no position that could follow"},
      {[](Parts& p) { p.joints[1].mimic->joint = 1; },
       "joint 'tilt': it mimics 'tilt', which is part of a circle of mimics"},
      {[](Parts& p) {
         p.joints[0].mimic = Joint::Mimic{1, 1.0, 0.0};
       },
       "joint 'lift': it mimics 'tilt', which is part of a circle of mimics"},
      {[](Parts& p) { p.joints[1].mimic->multiplier = NAN_; },
       "joint 'tilt': multiplier or offset of its mimic is not finite"},
      {[](Parts& p) { p.joints[1].mimic->offset = INF; },
       "joint 'tilt': multiplier or offset of its mimic is not finite"},
      {[](Parts& p) { std::get<Box>(p.links[1].elements[0].shape).size.y() = NAN_; }, bad_box},
      {[](Parts& p) { p.links[2].elements[0].shape = Mesh{nullptr}; },
       "link 'ball': mesh has no data"},
  };
  EXPECT_EQ(refusalAfter([](Parts&) {}), "accepted");
  for (const Case& one : cases) EXPECT_EQ(refusalAfter(one.spoil), "robot 'r': " + one.says);
}

TEST(RobotParts, WithoutAMotionNeedNeitherAxisNorLimits) {
  Parts parts = threeLinks();
  parts.joints[1].mimic.reset();
  for (const JointType type : {JointType::FIXED, JointType::FLOATING}) {
    parts.joints[1].type = type;
    parts.joints[1].axis.setZero();
    parts.joints[1].upper = INF;
    EXPECT_NO_THROW(parts.robot());
  }
}

}  // namespace collision_pairs::test_robot_parts
