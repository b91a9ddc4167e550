// Where the bodies of a robot stood, from transforms and joint states put together here.
#include <algorithm>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "bag_poses.h"
#include "demo_scene.h"

namespace collision_pairs {
namespace test_bag_poses {

using Eigen::Vector3d;
using testing::ElementsAre;
using testing::EndsWith;
using testing::Not;

constexpr StampNs SECOND = 1000000000;

/// A base with a mount fixed on it at y = 2; above the mount an arm that slides along x, with a
/// tool fixed on it at x = 3; and a wheel on the tool that turns without end.
std::shared_ptr<const CollisionScene> armWithTool() {
  const std::string along_x = "<axis xyz='1 0 0'/><limit lower='-9' upper='9'/>";
  return CollisionScene::build(
      robotFrom(boxLink("base", 0.1) + emptyLink("mount") + boxLink("arm", 0.1) +
                emptyLink("tool") + boxLink("wheel", 0.1) +
                joint("weld", "fixed", "base", "mount", "0 2 0") +
                joint("slide", "prismatic", "mount", "arm", "0 0 0", along_x) +
                joint("flange", "fixed", "arm", "tool", "3 0 0") +
                joint("spin", "continuous", "tool", "wheel", "0 0 1", "<axis xyz='0 0 1'/>")),
      Srdf{}, nullptr);
}

class BagPosesTest : public testing::Test {
 protected:
  void transform(const std::string& parent, const std::string& child, double seconds, double x,
                 double y = 0.0, double z = 0.0) {
    take(parent, child, seconds, Vector3d(x, y, z), false);
  }
  /// As soon as it is so.
  void take(const std::string& parent, const std::string& child, double seconds, const Vector3d& p,
            bool is_static) {
    const auto stamp = static_cast<StampNs>(seconds * 1e9);
    bag_.take({parent, child, stamp, p, Eigen::Quaterniond::Identity()}, is_static, "", stamp);
    bag_.stamps.resize(bag_.transforms.frames().size());
  }
  void position(const std::string& joint, double seconds, double value,
                const std::string& topic = "/joint_states") {
    const auto stamp = static_cast<StampNs>(seconds * 1e9);
    bag_.joints[topic].push_back(
        {stamp, stamp, bag_.names.add("/joints"), bag_.names.add(joint), value});
  }
  void finish(const std::string& prefix = "") {
    BagPosesOptions options;
    options.prefix = prefix;
    for (auto& [topic, positions] : bag_.joints) {  // as they arrive
      std::stable_sort(positions.begin(), positions.end(),
                       [](const auto& a, const auto& b) { return a.received < b.received; });
    }
    poses_ = makeBagPoses(bag_, *scene_, options);
  }
  /// Where a link stood in the base; not a number where that is not known.
  Vector3d at(const std::string& link, double seconds) const {
    BodyPoses poses;
    poses_->at(static_cast<StampNs>(seconds * 1e9), poses);
    const int body = scene_->models()[scene_->findModel(link)].body;
    return poses.known[body] ? Vector3d(poses.X_WB[body].translation())
                             : Vector3d::Constant(std::nan(""));
  }
  bool knows(const std::string& link, double seconds) const {
    return at(link, seconds).allFinite();
  }
  /// Where any frame was in the base; not a number where that is not known.
  Vector3d frameAt(const std::string& frame, double seconds) const {
    Eigen::Isometry3d X = Eigen::Isometry3d::Identity();
    const bool is_known = poses_->frameAt(static_cast<StampNs>(seconds * 1e9), frame, X);
    return is_known ? Vector3d(X.translation()) : Vector3d::Constant(std::nan(""));
  }
  std::string refusal(const std::string& prefix = "") {
    try {
      finish(prefix);
    } catch (const InputError& error) {
      return error.what();
    }
    return "accepted";
  }

  std::shared_ptr<const CollisionScene> scene_ = armWithTool();
  BagContents bag_;
  std::unique_ptr<const BagPoses> poses_;
};

TEST_F(BagPosesTest, ABodyThatIsKnownByALinkAwayFromItsOriginIsWhereItIs) {
  transform("base", "tool", 1, 5, 2);  // of the arm's body TF knows the tool only
  finish();
  EXPECT_EQ(at("arm", 1), Vector3d(2, 2, 0));
}

TEST_F(BagPosesTest, WhatStandsOnALinkThatTheUrdfFixesIsKnownWithoutItsTransform) {
  transform("mount", "arm", 1, 7);  // nothing says where the mount stands on the base
  finish();
  EXPECT_EQ(at("arm", 1), Vector3d(7, 2, 0));
}

TEST_F(BagPosesTest, AfterAPrefixASlashMayFollow) {
  for (const char* const robot : {"left_", "right/"}) {
    transform(robot + std::string("base"), robot + std::string("tool"), 1, 5, robot[0] == 'l');
  }
  finish("left_");
  EXPECT_EQ(at("arm", 1), Vector3d(2, 1, 0));
  for (const char* const prefix : {"right", "/right", "right/", "//right//"}) {
    finish(prefix);
    EXPECT_EQ(at("arm", 1), Vector3d(2, 0, 0)) << prefix;
  }
}

TEST_F(BagPosesTest, AfterAPrefixASlashMayFollowInNamesOfJointsToo) {
  for (const char* const robot : {"left_", "right/"}) {
    for (const char* const joint : {"slide", "spin"}) {
      position(robot + std::string(joint), 1, robot[0] == 'l' ? 0.5 : 0.75);
    }
  }
  finish("left_");
  EXPECT_EQ(at("arm", 1), Vector3d(0.5, 2, 0));
  finish("right");
  EXPECT_EQ(at("arm", 1), Vector3d(0.75, 2, 0));
}

// A live buffer forgets what is older than 10 s.
TEST_F(BagPosesTest, OfALongRecordingTheBeginningIsKnownFromTransformsToo) {
  for (int i = 1; i <= 50; ++i) transform("base", "arm", 0.5 * i, i, 2);
  finish();
  EXPECT_EQ(poses_->stamps().size(), 50u);
  for (int i = 1; i <= 50; ++i) EXPECT_EQ(at("arm", 0.5 * i), Vector3d(i, 2, 0)) << i;
}

TEST_F(BagPosesTest, FramesOfFixedJointsAddNoStampsWhereOthersMove) {
  transform("base", "arm", 1, 0);
  transform("base", "arm", 2, 1);
  transform("arm", "tool", 1.5, 3);
  finish();
  EXPECT_THAT(poses_->stamps(), ElementsAre(SECOND, 2 * SECOND));
}

TEST_F(BagPosesTest, JointStatesAreTakenWhereTransformsKnowFewerBodies) {
  transform("base", "arm", 1, 0, 2);
  position("slide", 1, 4);
  position("spin", 1, 0);
  finish();
  EXPECT_EQ(poses_->source(), "joint states of /joint_states");
  EXPECT_EQ(at("arm", 1), Vector3d(4, 2, 0));
  EXPECT_EQ(at("wheel", 1), Vector3d(7, 2, 1));
}

TEST_F(BagPosesTest, ALinkWithoutAFrameIsNamed) {
  transform("base", "arm", 1, 0, 2);
  finish();
  EXPECT_THAT(poses_->notes(), ElementsAre(EndsWith("TF has no frame for them: wheel")));
}

TEST_F(BagPosesTest, BelowAJointThatIsNotKnownThenNothingIs) {
  position("slide", 2, 4);
  for (const double seconds : {1.0, 2.0}) position("spin", seconds, 0);
  finish();
  EXPECT_FALSE(knows("arm", 1));
  EXPECT_FALSE(knows("wheel", 1)) << "its own joint is known, but not that of the arm";
  EXPECT_TRUE(knows("wheel", 2));
}

TEST_F(BagPosesTest, WhatAMimicJointMovesIsKnownWhereItsLeaderIs) {
  const std::string along_x = "<axis xyz='1 0 0'/><limit lower='-9' upper='9'/>";
  scene_ = CollisionScene::build(
      robotFrom(boxLink("base", 0.1) + boxLink("arm", 0.1) + boxLink("finger", 0.1) +
                joint("slide", "prismatic", "base", "arm", "0 0 0", along_x) +
                joint("copy", "prismatic", "base", "finger", "0 5 0",
                      along_x + "<mimic joint='slide' multiplier='2' offset='0.5'/>")),
      Srdf{}, nullptr);
  position("slide", 2, 1.5);
  for (const double seconds : {1.0, 2.0}) position("copy", seconds, 7);  // not asked
  finish();
  EXPECT_FALSE(knows("finger", 1));
  EXPECT_EQ(at("finger", 2), Vector3d(3.5, 5, 0));
}

TEST_F(BagPosesTest, AContinuousJointTakesTheShorterWayRound) {
  position("slide", 1, 0);
  position("slide", 2, 0);
  position("spin", 1, 3.0);
  position("spin", 2, -3.0);
  finish();
  BodyPoses poses;
  poses_->at(SECOND * 3 / 2, poses);
  const auto& X_WB = poses.X_WB[scene_->models()[scene_->findModel("wheel")].body];
  EXPECT_TRUE((X_WB.linear() * Vector3d::UnitX()).isApprox(-Vector3d::UnitX(), 1e-12));
}

TEST_F(BagPosesTest, AJointThatIsNotNamedIsSaidToBeTakenAtZero) {
  position("slide", 1, 4);
  finish();
  EXPECT_THAT(poses_->jointsAtZero(), ElementsAre("spin"));
  EXPECT_THAT(poses_->notes(), ElementsAre(EndsWith("taken as zero: spin")));
  EXPECT_EQ(at("wheel", 1), Vector3d(7, 2, 1));
}

TEST_F(BagPosesTest, AJointThatCannotBeAtZeroIsTakenAtItsNearestLimit) {
  scene_ = CollisionScene::build(
      robotFrom(boxLink("base", 0.1) + boxLink("arm", 0.1) + boxLink("hand", 0.1) +
                joint("lift", "prismatic", "base", "arm", "0 0 0",
                      "<axis xyz='0 0 1'/><limit lower='1' upper='9'/>") +
                joint("slide", "prismatic", "arm", "hand", "0 0 0",
                      "<axis xyz='1 0 0'/><limit lower='-9' upper='9'/>")),
      Srdf{}, nullptr);
  position("slide", 1, 4);
  finish();
  EXPECT_EQ(at("hand", 1), Vector3d(4, 0, 1));
}

TEST_F(BagPosesTest, AFloatingJointIsSaidToBeTakenAtZeroSinceNoJointStateNamesIt) {
  scene_ = CollisionScene::build(
      robotFrom(boxLink("base", 0.1) + boxLink("arm", 0.1) + boxLink("kite", 0.1) +
                joint("slide", "prismatic", "base", "arm", "0 0 0",
                      "<axis xyz='1 0 0'/><limit lower='-9' upper='9'/>") +
                joint("string", "floating", "base", "kite", "0 0 0", "")),
      Srdf{}, nullptr);
  position("slide", 1, 4);
  finish();
  EXPECT_THAT(poses_->jointsAtZero(), ElementsAre("string"));
  EXPECT_THAT(poses_->notes(), ElementsAre(EndsWith("taken as zero: string")));
}

TEST_F(BagPosesTest, WhereBothKnowAsManyBodiesTransformsAreTaken) {
  transform("base", "arm", 1, 1, 2);
  transform("arm", "wheel", 1, 0);
  position("slide", 1, 4);
  position("spin", 1, 0);
  finish();
  EXPECT_EQ(poses_->source(), "TF");
  EXPECT_EQ(poses_->nbKnown(), 2u);
  EXPECT_EQ(at("arm", 1), Vector3d(1, 2, 0));
}

/// The joint of the arm is the first of all.
TEST_F(BagPosesTest, OfJointsOnlyThoseCountThatMoveABodyOfTheScene) {
  const std::string along_x = "<axis xyz='1 0 0'/><limit lower='-9' upper='9'/>";
  scene_ = CollisionScene::build(
      robotFrom(boxLink("base", 0.1) + boxLink("arm", 0.1) + boxLink("hand", 0.1) +
                emptyLink("eye") + joint("slide", "prismatic", "base", "arm", "0 0 0", along_x) +
                joint("reach", "prismatic", "arm", "hand", "0 0 1", along_x) +
                joint("look", "prismatic", "arm", "eye", "0 0 0", along_x)),
      Srdf{}, nullptr);
  for (const double seconds : {1.0, 2.0, 3.0}) position("reach", seconds, 0.25);
  finish();
  EXPECT_EQ(poses_->nbKnown(), 1u) << "the hand";
  EXPECT_THAT(poses_->jointsAtZero(), ElementsAre("slide"));
  EXPECT_THAT(poses_->stamps(), ElementsAre(SECOND, 2 * SECOND, 3 * SECOND));
  position("slide", 2, 0.5);
  finish();
  EXPECT_EQ(poses_->nbKnown(), 2u);
  EXPECT_THAT(poses_->notes(), ElementsAre());
  EXPECT_EQ(at("hand", 2), Vector3d(0.75, 0, 1));
  BodyPoses poses;
  const std::string why =
      "no two of its transforms around that stamp are within 1.00 s of each other (in 'base')";
  EXPECT_THAT(poses_->at(SECOND, poses),
              ElementsAre("link 'arm': " + why, "link 'hand': transform of 'arm': " + why));
  EXPECT_THAT(poses_->at(2 * SECOND, poses), ElementsAre());
}

/// The plain names of joints, and those with the prefix in front.
TEST_F(BagPosesTest, JointStatesAreThoseOfTheTopicThatBelongsToThePrefix) {
  const std::string none = "none";
  const auto sourceOf = [&](const std::vector<std::string>& topics, const std::string& joints,
                            const std::string& prefix) {
    bag_.joints.clear();
    for (const std::string& topic : topics) position(joints + "slide", 1, 1, topic);
    return refusal(prefix) == "accepted" ? poses_->source() : none;
  };
  const auto of = [](const std::string& topic) { return "joint states of " + topic; };
  for (const std::string slash : {"/", ""}) {
    const std::string plain = slash + "joint_states", left = slash + "left/joint_states",
                      right = slash + "right/joint_states";
    EXPECT_EQ(sourceOf({plain, left}, "", ""), of(plain));
    EXPECT_EQ(sourceOf({left}, "", ""), of(left)) << "the only one";
    EXPECT_EQ(sourceOf({left, right}, "", ""), none);
    EXPECT_EQ(sourceOf({plain, left, right}, "", "left"), of(left));
    EXPECT_EQ(sourceOf({plain, left, right}, "", "right"), of(right));
    EXPECT_EQ(sourceOf({plain}, "", "left"), none);
    EXPECT_EQ(sourceOf({plain, right}, "left/", "left"), of(plain));
    EXPECT_EQ(sourceOf({plain, right}, "left_", "left_"), of(plain));
    EXPECT_EQ(sourceOf({plain}, "right/", "left"), none);
  }
  bag_.joints.clear();
  position("slide", 1, 1, "/joint_states");
  for (const char* joint : {"slide", "spin"}) position(joint, 1, 1, "joint_states");
  finish();
  EXPECT_EQ(poses_->source(), of("joint_states")) << "it names more of the joints";
}

/// Frames and topics may each tell the prefix.
TEST_F(BagPosesTest, ARobotThatTheBagDoesNotMentionIsRefusedWithThePrefixesOfThoseThatItMayBe) {
  const std::string words = "neither its transforms nor its joint states mention robot 'test'";
  EXPECT_EQ(refusal(), words);
  transform("map", "cart", 1, 0);
  transform("map", "xarm", 1, 0);
  EXPECT_EQ(refusal(), words);
  transform("map", "cell/left/arm", 1, 0);
  EXPECT_EQ(refusal(), words + "; try --prefix cell/left");
  transform("cell/left/arm", "right/tool", 1, 0);
  EXPECT_EQ(refusal("l"), words + "; try --prefix cell/left or right");
  position("elbow", 1, 0, "/far/joint_states");
  position("elbow", 1, 0, "near/joint_states");
  position("elbow", 1, 0, "/joint_states");
  EXPECT_EQ(refusal(), words + "; try --prefix cell/left or far or near or right");
}

TEST_F(BagPosesTest, OfLinksThatAreOnlyStaticItIsSaidThatNoStampMovesThem) {
  take("base", "arm", 1, Vector3d::Zero(), true);
  take("arm", "wheel", 1, Vector3d::Zero(), true);
  EXPECT_EQ(refusal(),
            "there is no stamp to check: of its 2 links on moving joints that TF names, /tf moves "
            "none: they are on /tf_static only, and no joint states move them");
}

TEST_F(BagPosesTest, AnyFrameIsPlacedByJointStatesAndWhatTransformsConnectToALink) {
  for (const std::string prefix : {"", "left_", "left/"}) {
    const std::string camera = prefix + "camera", lamp = prefix + "lamp";
    position(prefix + "slide", 1, 4);
    position(prefix + "spin", 2, 0);
    transform(prefix + "tool", camera, 1, 0, 0, 0.5);
    transform(prefix + "wheel", lamp, 1, 0, 0, 0.5);
    transform("nowhere", "else", 1, 0);
    finish(prefix == "left/" ? "left" : prefix);
    ASSERT_EQ(poses_->source(), "joint states of /joint_states");
    EXPECT_EQ(frameAt(prefix + "arm", 1), Vector3d(4, 2, 0));
    EXPECT_EQ(frameAt("/" + prefix + "tool", 1), Vector3d(7, 2, 0));
    EXPECT_EQ(frameAt(prefix + "mount", 1), Vector3d(0, 2, 0));
    EXPECT_EQ(frameAt(camera, 1), Vector3d(7, 2, 0.5));
    for (const std::string& unknown : {lamp, std::string("else"), std::string("no_frame")}) {
      EXPECT_FALSE(frameAt(unknown, 1).allFinite()) << unknown;
    }
    EXPECT_FALSE(frameAt(prefix + "wheel", 1).allFinite()) << "its joint is not known then";
    EXPECT_FALSE(frameAt(prefix + "arm", 2).allFinite());
    EXPECT_FALSE(frameAt(camera, 2).allFinite());
    if (!prefix.empty()) {
      EXPECT_FALSE(frameAt("arm", 1).allFinite()) << "of another robot";
    }
  }
}

TEST_F(BagPosesTest, AnyFrameIsPlacedByTransforms) {
  transform("base", "tool", 1, 5, 2);
  transform("tool", "camera", 1, 0, 0, 0.5);
  finish();
  ASSERT_EQ(poses_->source(), "TF");
  EXPECT_EQ(frameAt("camera", 1), Vector3d(5, 2, 0.5));
  EXPECT_EQ(frameAt("/tool", 1), Vector3d(5, 2, 0));
  EXPECT_FALSE(frameAt("camera", 2).allFinite());
  EXPECT_FALSE(frameAt("no_frame", 1).allFinite());
}

}  // namespace test_bag_poses
}  // namespace collision_pairs
