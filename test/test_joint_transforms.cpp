// Transforms made of joint states: which robot's, of which bodies, and where they put them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "collision_pairs/input_error.h"
#include "joint_transforms.h"
#include "random_robot.h"

namespace collision_pairs::test_joint_transforms {

using testing::ElementsAre;
using testing::UnorderedElementsAre;

using Topics = std::map<std::string, std::set<std::string>>;
const std::string ALONG_X = "<axis xyz='1 0 0'/><limit lower='-9' upper='9'/>";

std::shared_ptr<const RobotModel> armAndWheel() {
  return robotFrom(boxLink("base", 0.1) + boxLink("arm", 0.1) + boxLink("wheel", 0.1) +
                   boxLink("finger", 0.1) + boxLink("kite", 0.1) +
                   joint("slide", "prismatic", "base", "arm", "0 2 0", ALONG_X) +
                   joint("spin", "continuous", "arm", "wheel", "0 0 1", "<axis xyz='0 0 1'/>") +
                   joint("copy", "prismatic", "base", "finger", "0 5 0",
                         ALONG_X + "<mimic joint='slide' multiplier='2' offset='0.5'/>") +
                   joint("string", "floating", "base", "kite", "0 0 0", ""));
}

std::vector<SceneBody> allBodies(const RobotModel& robot) {
  std::vector<SceneBody> bodies;
  for (std::size_t b = 0; b < robot.bodies().size(); ++b) {
    bodies.push_back({static_cast<int>(b), robot.links()[robot.bodies()[b].link].name});
  }
  return bodies;
}

sensor_msgs::JointState stateOf(const std::vector<std::string>& names,
                                const std::vector<double>& positions) {
  sensor_msgs::JointState state;
  state.header.stamp = ros::Time(7, 5);
  state.name = names;
  state.position = positions;
  return state;
}

std::vector<std::string> childrenOf(const tf2_msgs::TFMessage& message) {
  std::vector<std::string> children;
  for (const auto& transform : message.transforms) children.push_back(transform.child_frame_id);
  return children;
}

TEST(JointTransforms, AreOfTheBodiesBelowTheJointsThatAMessageNamesAndOfThoseThatMimicThem) {
  const auto robot = armAndWheel();
  JointTransforms made({{"/joint_states", {"slide", "spin", "copy"}}}, *robot, "");
  EXPECT_EQ(made.topic(), "/joint_states");
  const auto message = made.take(stateOf({"/slide", "copy", "of_another"}, {1.5, 7.0, 1.0}));
  EXPECT_THAT(childrenOf(message), UnorderedElementsAre("arm", "finger"));
  for (const auto& transform : message.transforms) {
    EXPECT_EQ(transform.header.stamp, ros::Time(7, 5));
    EXPECT_EQ(transform.header.frame_id, "base");
    const bool is_arm = transform.child_frame_id == "arm";
    EXPECT_EQ(transform.transform.translation.x, is_arm ? 1.5 : 7.0) << "what is named counts";
    EXPECT_EQ(transform.transform.translation.y, is_arm ? 2.0 : 5.0);
  }
  const auto wheel = made.take(stateOf({"spin", "slide"}, {0.5, std::nan("")}));
  EXPECT_THAT(childrenOf(wheel), ElementsAre("wheel")) << "a position that is none is left out";
  EXPECT_EQ(wheel.transforms[0].header.frame_id, "arm");
  EXPECT_TRUE(made.take(stateOf({"spin"}, {})).transforms.empty());
}

TEST(JointTransforms, ReadAMessageAsRobotStatePublisherDoes) {
  const auto robot = armAndWheel();
  JointTransforms made({{"/joint_states", {"slide", "spin"}}}, *robot, "");
  EXPECT_TRUE(made.take(stateOf({"slide", "spin"}, {1.0})).transforms.empty());
  EXPECT_TRUE(made.take(stateOf({"slide"}, {1.0, 2.0})).transforms.empty());
  for (const char* again : {"slide", "/slide"}) {
    const auto arm = made.take(stateOf({"slide", again}, {1.5, 2.5})).transforms;
    ASSERT_EQ(arm.size(), 2u) << "and the finger";
    for (const auto& t : arm) {
      EXPECT_EQ(t.transform.translation.x, t.child_frame_id == "arm" ? 1.5 : 3.5);
    }
  }
  EXPECT_TRUE(made.take(stateOf({"slide", "slide"}, {std::nan(""), 2.5})).transforms.empty());
}

// robot_state_publisher takes followers in the order of their names, one after the other.
TEST(JointTransforms, OfAJointThatFollowsAFollowerAreThoseOfRobotStatePublisher) {
  const auto chain = [](const std::string& last) {
    const auto slide = [](const std::string& joint, const std::string& leader) {
      return "<link name='of_" + joint + "'/><joint name='" + joint + "' type='prismatic'>" +
             "<limit lower='0' upper='9' effort='1' velocity='1'/><axis xyz='1 0 0'/>" +
             "<parent link='base'/><child link='of_" + joint + "'/>" +
             (leader.empty() ? "" : "<mimic joint='" + leader + "'/>") + "</joint>";
    };
    return robotFrom("<link name='base'/>" + slide("first", "") + slide("m", "first") +
                     slide(last, "m"));
  };
  for (const std::string last : {"a", "z"}) {
    const auto robot = chain(last);
    JointTransforms made({{"/joint_states", {"first"}}}, *robot, "");
    const auto message = made.take(stateOf({"first"}, {2.0}));
    EXPECT_EQ(message.transforms.size(), last == "a" ? 2u : 3u);
    const std::vector<std::string> unnamed = made.unnamedJoints(allBodies(*robot));
    EXPECT_EQ(unnamed, last == "a" ? std::vector<std::string>{"a"} : std::vector<std::string>());
  }
}

TEST(JointTransforms, WhatIsNotNamedIsAtZeroAndCountsAsUnnamed) {
  const auto robot = armAndWheel();
  const JointTransforms made({{"/joint_states", {"spin"}}}, *robot, "");
  EXPECT_THAT(childrenOf(made.atZero()), UnorderedElementsAre("arm", "finger", "kite"));
  EXPECT_THAT(made.unnamedJoints(allBodies(*robot)), UnorderedElementsAre("slide", "string"));
  EXPECT_THAT(made.unnamedJoints({{2, "wheel"}}), ElementsAre("slide"));
  EXPECT_EQ(made.nbMoved(allBodies(*robot)), 1u) << "the wheel";
  EXPECT_THAT(made.frames(), UnorderedElementsAre("arm", "finger", "kite", "wheel"));
  const JointTransforms none({}, *robot, "");
  EXPECT_EQ(none.topic(), "");
  EXPECT_EQ(none.nbMoved(allBodies(*robot)), 0u);
}

/// The plain names of joints, and those with the prefix in front.
TEST(JointTransforms, AreOfTheTopicThatBelongsToThePrefix) {
  const auto robot = armAndWheel();
  const auto topicOf = [&](const std::vector<std::string>& topics, const std::string& joints,
                           const std::string& prefix) {
    Topics found;
    for (const std::string& topic : topics) found[topic] = {joints + "slide"};
    return JointTransforms(found, *robot, prefix).topic();
  };
  for (const std::string slash : {"/", ""}) {
    const std::string plain = slash + "joint_states", left = slash + "left/joint_states",
                      right = slash + "right/joint_states";
    EXPECT_EQ(topicOf({plain, left}, "", ""), plain);
    EXPECT_EQ(topicOf({left}, "", ""), left) << "the only one";
    EXPECT_EQ(topicOf({left, right}, "", ""), "");
    EXPECT_EQ(topicOf({plain, left, right}, "", "left"), left);
    EXPECT_EQ(topicOf({plain, left, right}, "", "right"), right);
    EXPECT_EQ(topicOf({plain}, "", "left"), "");
    EXPECT_EQ(topicOf({plain, right}, "left/", "left"), plain);
    EXPECT_EQ(topicOf({plain, right}, "left_", "left_"), plain);
    EXPECT_EQ(topicOf({plain}, "right/", "left"), "");
  }
  const Topics both = {{"/joint_states", {"slide"}}, {"joint_states", {"slide", "spin"}}};
  EXPECT_EQ(JointTransforms(both, *robot, "").topic(), "joint_states") << "it names more joints";
}

TEST(JointTransforms, ChainedTheyAreForwardKinematics) {
  RandomInputs random;
  for (int i = 0; i < 50; ++i) {
    const auto robot = randomRobot(random, 8);
    const std::vector<double> positions = randomPositions(random, *robot);
    std::set<std::string> names;
    sensor_msgs::JointState state;
    for (std::size_t j = 0; j < robot->joints().size(); ++j) {
      const Joint& joint = robot->joints()[j];
      if (!joint.hasPosition()) continue;
      names.insert(joint.name);
      state.name.push_back(joint.name);
      state.position.push_back(positions[j]);
    }
    JointTransforms made({{"/joint_states", names}}, *robot, "");
    tf2_msgs::TFMessage message = made.take(state);
    for (const auto& fixed : made.atZero().transforms) message.transforms.push_back(fixed);
    std::map<std::string, std::pair<std::string, Eigen::Isometry3d>> tree;
    for (const auto& t : message.transforms) {
      const auto& p = t.transform.translation;
      const auto& q = t.transform.rotation;
      tree[t.child_frame_id] = {t.header.frame_id, Eigen::Translation3d(p.x, p.y, p.z) *
                                                       Eigen::Quaterniond(q.w, q.x, q.y, q.z)};
    }
    std::vector<Eigen::Isometry3d> X_RB;
    robot->forwardKinematics(positions, X_RB);
    ASSERT_EQ(tree.size() + 1, robot->bodies().size());
    for (const SceneBody& body : allBodies(*robot)) {
      Eigen::Isometry3d X = Eigen::Isometry3d::Identity();
      for (std::string frame = body.link; frame != "root"; frame = tree.at(frame).first) {
        X = tree.at(frame).second * X;
      }
      EXPECT_LT((X.matrix() - X_RB[body.body].matrix()).cwiseAbs().maxCoeff(), 1e-9);
    }
  }
}

}  // namespace collision_pairs::test_joint_transforms
