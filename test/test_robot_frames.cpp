// Which frames of a bag are those of the robot with a prefix.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "robot_frames.h"

namespace collision_pairs::test_robot_frames {

using testing::ElementsAre;
using testing::IsEmpty;

const std::vector<std::string> LINKS = {"base", "arm", "tool"};

BagIndex bagWith(const std::vector<std::pair<std::string, std::string>>& edges) {
  BagIndex bag;
  for (const auto& [parent, child] : edges) bag.transforms.insert({parent, child, false});
  return bag;
}

TEST(RobotFrames, AfterAPrefixASlashMayFollow) {
  const BagIndex bag = bagWith({{"left_base", "left_arm"}, {"right/base", "right/arm"}});
  const RobotFrames left(bag, LINKS, "left_"), right(bag, LINKS, "right"), none(bag, LINKS, "");
  EXPECT_EQ(left.ofRobot("left_arm"), "arm");
  EXPECT_EQ(left.ofRobot("/left_base"), "base");
  EXPECT_EQ(left.ofRobot("right/arm"), "right/arm");
  EXPECT_EQ(left.inBag("base"), "left_base");
  EXPECT_EQ(right.ofRobot("right/arm"), "arm");
  EXPECT_EQ(right.inBag("arm"), "right/arm");
  EXPECT_EQ(right.ofRobot("right/tool"), "tool") << "that TF does not name";
  EXPECT_EQ(left.ofRobot("left_tool"), "tool");
  EXPECT_EQ(none.ofRobot("/left_arm"), "left_arm");
}

TEST(RobotFrames, WithoutItsPrefixALinkIsAnotherRobots) {
  const BagIndex bag = bagWith({{"world", "arm"}, {"base", "left/arm"}, {"base", "tool"}});
  const RobotFrames left(bag, LINKS, "left");
  EXPECT_EQ(left.ofRobot("left/arm"), "arm");
  EXPECT_NE(left.ofRobot("arm"), "arm");
  EXPECT_NE(left.ofRobot("tool"), "tool");
  EXPECT_EQ(left.ofRobot("base"), "base") << "the root, which is not there under its prefixed name";
  EXPECT_EQ(left.inBag("base"), "base");
  EXPECT_EQ(left.ofRobot("world"), "world") << "no link";
  const BagIndex with_root = bagWith({{"base", "tool"}, {"left/base", "left/arm"}});
  EXPECT_NE(RobotFrames(with_root, LINKS, "left").ofRobot("base"), "base");
}

TEST(RobotFrames, PrefixesThatWouldFitAreFoundInFramesAndTopics) {
  EXPECT_THAT(possiblePrefixes(bagWith({{"map", "cart"}, {"map", "xarm"}}), LINKS), IsEmpty());
  BagIndex bag = bagWith({{"map", "cell/left/arm"}, {"cell/left/arm", "right/tool"}});
  bag.joints = {{"/far/joint_states", {}}, {"near/joint_states", {}}, {"/joint_states", {}}};
  EXPECT_THAT(possiblePrefixes(bag, LINKS), ElementsAre("cell/left", "far", "near", "right"));
}

}  // namespace collision_pairs::test_robot_frames
