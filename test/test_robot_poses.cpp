// Why bodies of a robot have no pose, from transforms put together here.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "demo_scene.h"
#include "robot_poses.h"

namespace collision_pairs {
namespace {

using Eigen::Vector3d;
using testing::ElementsAre;

constexpr StampNs SECOND = 1000000000;

/// The newest poses of a base, of an arm that slides on it with a tool fixed to the arm, and of a
/// wheel that spins on the tool.
class NewestPoses : public testing::Test {
 protected:
  void take(const std::string& parent, const std::string& child, double seconds,
            bool is_static = false) {
    const auto stamp = static_cast<StampNs>(seconds * 1e9);
    buffer_.take({parent, child, stamp, Vector3d(1, 0, 0), Eigen::Quaterniond::Identity()},
                 is_static, "", 10 * SECOND);
  }
  FoundBodies found(const std::vector<std::string>& static_joints = {}) const {
    const RobotPoses poses(buffer_, *robot_, "base", "", static_joints);
    return poses.newest(10 * SECOND, std::vector<char>(poses.nbBodies(), 1));
  }
  std::string between(const std::string& target, const std::string& source,
                      StampNs stamp = 10 * SECOND) const {
    try {
      poseBetween(buffer_, target, source, {Instant::AT, stamp});
    } catch (const InputError& error) {
      return error.what();
    }
    return "known";
  }
  const std::shared_ptr<const RobotModel> robot_ = robotFrom(
      emptyLink("base") + emptyLink("arm") + emptyLink("tool") + emptyLink("wheel") +
      joint("slide", "prismatic", "base", "arm") + joint("flange", "fixed", "arm", "tool") +
      joint("spin", "continuous", "tool", "wheel"));
  TransformBuffer buffer_{PoseLimits{2.0, 1.0, 0.5}};
};

TEST_F(NewestPoses, WhyOneIsNotKnownIsSaidInTheseWords) {
  take("base", "arm", 9.875);
  EXPECT_THAT(found().problems, ElementsAre("", "", "TF has no frame of that name"));
  take("tool", "wheel", 9.875);
  EXPECT_THAT(found().problems, ElementsAre("", "", "")) << "the URDF fixes the tool to the arm";
  take("cart", "arm", 9.9375);
  EXPECT_EQ(found().problems[1], "transform of 'cart': TF does not say where it is (in 'base')");
}

TEST_F(NewestPoses, LinksThatTfNamesLaterAreFoundFromThenOn) {
  const RobotPoses poses(buffer_, *robot_, "base");
  const auto known = [&] { return poses.newest(10 * SECOND, std::vector<char>(3, 1)).known; };
  EXPECT_THAT(known(), ElementsAre(1, 0, 0));
  take("base", "arm", 9.875);
  EXPECT_THAT(known(), ElementsAre(1, 1, 0));
  take("tool", "wheel", 9.875);
  EXPECT_THAT(known(), ElementsAre(1, 1, 1));
}

TEST_F(NewestPoses, OneThatLagsBehindTheOthersIsSaidTo) {
  take("base", "arm", 8.5);
  for (const double seconds : {8.5, 9.5}) take("base", "wheel", seconds);
  EXPECT_THAT(found().problems, ElementsAre("", "", "")) << "just as far as it may";
  EXPECT_EQ(found().stamp, 8 * SECOND + SECOND / 2);
  take("base", "wheel", 9.75);
  EXPECT_THAT(found().problems,
              ElementsAre("",
                          "its newest transform is 1.25 s older than the newest of all links, and "
                          "max_transform_age is 1.00 s",
                          ""));
  EXPECT_EQ(found().stamp, 9 * SECOND + 3 * SECOND / 4);
}

TEST_F(NewestPoses, WhatStandsOnlyByStaticTransformsNamesTheJointThatIsNotFixed) {
  take("base", "arm", 0, true);
  take("tool", "wheel", 9.5);
  const std::string why =
      "only /tf_static places it, but joint 'slide' is not fixed: publish it on "
      "/tf, or list the joint in static_joints";
  EXPECT_THAT(found().problems, ElementsAre("", why, why));
  EXPECT_THAT(found({"slide"}).problems, ElementsAre("", "", ""));
  EXPECT_THAT(found({"spin"}).problems, ElementsAre("", why, why));
  try {
    found({"spin", "slid"});
    ADD_FAILURE() << "was taken";
  } catch (const InputError& error) {
    EXPECT_STREQ(error.what(),
                 "static_joints: 'slid' is not a joint of the robot; did you mean 'slide'?");
  }
}

TEST_F(NewestPoses, WhyOneFrameIsNotKnownInAnotherIsSaidInTheseWords) {
  take("map", "a", 9.75);
  take("map", "a", 10);
  take("map", "b", 0, true);
  take("else", "c", 10);
  EXPECT_EQ(between("a", "/b"), "known");
  EXPECT_EQ(between("a", "a", SECOND), "known");
  EXPECT_EQ(between("none", "other"), "TF has no frame 'none'");
  EXPECT_EQ(between("a", "other"), "TF has no frame 'other'");
  EXPECT_EQ(between("a", "c"), "TF does not connect 'a' and 'c'");
  const std::string late =
      "its newest transform is 0.25 s older than that stamp (no extrapolation)";
  EXPECT_EQ(between("a", "b", 10 * SECOND + SECOND / 4), late);
  EXPECT_EQ(between("b", "a", 10 * SECOND + SECOND / 4), late);
}

}  // namespace
}  // namespace collision_pairs
