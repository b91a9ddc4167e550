// Poses for a joint state that a request names; what it does not name comes from TF. Without a
// master.
#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "demo_scene.h"
#include "joint_query.h"
#include "refusal.h"

namespace collision_pairs::test_joint_query {

using Eigen::Vector3d;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

/// A lead that slides along x, a follower on the root that goes half as far and 1 m, and a lift on
/// the lead that slides along z.
class JointQueryTest : public testing::Test {
 protected:
  void SetUp() override {
    ros::Time::init();
    const std::string limit = "<limit lower='-9' upper='9'/>", along_x = "<axis xyz='1 0 0'/>";
    scene_ = CollisionScene::build(
        robotFrom(emptyLink("root") + boxLink("a", 0.1) + boxLink("b", 0.1) + boxLink("c", 0.1) +
                  joint("lead", "prismatic", "root", "a", "0 0 0", along_x + limit) +
                  joint("follower", "prismatic", "root", "b", "0 5 0",
                        along_x + limit + "<mimic joint='lead' multiplier='0.5' offset='1'/>") +
                  joint("lift", "prismatic", "a", "c", "0 0 0", "<axis xyz='0 0 1'/>" + limit)),
        Srdf{}, nullptr);
  }
  /// As soon as it is so.
  void publishLift(double stamp, double z) { publish("a", "c", stamp, z); }
  void publish(const std::string& parent, const std::string& child, double stamp, double z,
               bool is_static = false) {
    now_ = ros::Time(stamp);
    tf2_msgs::TFMessage message;
    message.transforms.resize(1);
    auto& transform = message.transforms[0];
    transform.header.stamp = ros::Time(stamp);
    transform.header.frame_id = parent;
    transform.child_frame_id = child;
    transform.transform.translation.z = z;
    transform.transform.rotation.w = 1.0;
    transforms_.take(message, is_static, now_);
  }
  JointQuery query(const std::vector<std::string>& names, ros::Time stamp = ros::Time(0)) const {
    return {names, *scene_, {transforms_, "root", stamp, now_}};
  }
  Vector3d at(const std::string& link, const JointQuery& query,
              const std::vector<double>& positions) const {
    BodyPoses poses;
    poses.resize(scene_->bodies().size());
    query.posesAt(positions, poses);
    return poses.X_WB[scene_->models()[scene_->findModel(link)].body].translation();
  }

  std::shared_ptr<const CollisionScene> scene_;
  ros::Time now_{1000.0};
  TransformInput transforms_;
};

TEST_F(JointQueryTest, MovesWhatIsNamedAndWhatFollowsIt) {
  const JointQuery both = query({"lift", "lead"});
  int nb_placed = 0;
  EXPECT_THAT(both.unknownBecause(), IsEmpty());
  EXPECT_EQ(at("a", both, {7.0, 4.0}), Vector3d(4, 0, 0));
  EXPECT_EQ(at("b", both, {7.0, 4.0}), Vector3d(3, 5, 0));  // 0.5 * 4 + 1
  EXPECT_EQ(at("c", both, {7.0, 4.0}), Vector3d(4, 0, 7));
  for (const auto& X_PB : both.placedBodies()) nb_placed += X_PB.has_value();
  EXPECT_EQ(nb_placed, 1) << "the root";
}

TEST_F(JointQueryTest, LeavesWhatIsNotNamedWhereTfHasIt) {
  publishLift(999.5, 0.25);
  const JointQuery lead = query({"lead"});
  EXPECT_THAT(lead.unknownBecause(), IsEmpty());
  EXPECT_THAT(lead.jointsFromTf(), ElementsAre("lift"));
  EXPECT_EQ(at("c", lead, {2.0}), Vector3d(2, 0, 0.25));
}

TEST_F(JointQueryTest, TakesWhatIsNewestAtOneInstantOrTheNewestOfEach) {
  publish("map", "root", 999.5, 1.0);
  publishLift(999.5, 0.25);
  publishLift(999.75, 0.5);
  const auto ask = [&](bool is_of_one_instant, double heard = 0.0) {
    return JointQuery({"lead"}, *scene_,
                      {transforms_, "map", {}, now_, nullptr, ros::Time(heard), is_of_one_instant});
  };
  EXPECT_EQ(at("c", ask(true), {2.0}), Vector3d(2, 0, 1.25));
  EXPECT_EQ(ask(true).stamp(), ros::Time(999.5));
  EXPECT_EQ(at("c", ask(false), {2.0}), Vector3d(2, 0, 1.5));
  for (const bool is_of_one_instant : {true, false}) {
    EXPECT_THAT(ask(is_of_one_instant, 1000.5).unknownBecause(), IsEmpty());
    EXPECT_THAT(ask(is_of_one_instant, 1000.625).unknownBecause(),
                ElementsAre(HasSubstr("link 'root': its newest transform is ")));
    EXPECT_EQ(ask(is_of_one_instant, 1001.0).unknownBecause().size(), 2u) << "nothing may be used";
  }
}

TEST_F(JointQueryTest, FindsLinksThatOnlyFixedJointsConnectWithWhatTfPlaces) {
  const std::string up = "<axis xyz='0 0 1'/><limit lower='-9' upper='9'/>";
  scene_ = CollisionScene::build(
      robotFrom(emptyLink("root") + emptyLink("pedestal") + boxLink("a", 0.1) + emptyLink("hand") +
                boxLink("c", 0.1) + joint("stands", "fixed", "root", "pedestal", "0 0 1") +
                joint("lead", "prismatic", "root", "a", "0 0 0", up) +
                joint("holds", "fixed", "a", "hand", "0 0 2") +
                joint("lift", "prismatic", "hand", "c", "0 0 0", up)),
      Srdf{}, nullptr);
  publish("pedestal", "hand", 999.5, 4.0);
  publish("hand", "c", 999.5, 0.25);
  const TfPoses poses(transforms_, scene_->robot(), scene_->bodies(), "pedestal");
  const JointQuery from_tf({}, *scene_, {transforms_, "pedestal", {}, now_, &poses});
  EXPECT_THAT(from_tf.unknownBecause(), IsEmpty());
  EXPECT_THAT(from_tf.jointsFromTf(), ElementsAre("lead", "lift"));
  EXPECT_DOUBLE_EQ(at("a", from_tf, {}).z(), 2.0);
  EXPECT_DOUBLE_EQ(at("c", from_tf, {}).z(), 4.25);
  const JointQuery lead({"lead"}, *scene_, {transforms_, "pedestal", {}, now_, &poses});
  EXPECT_DOUBLE_EQ(at("a", lead, {0.5}).z(), -0.5);
  EXPECT_DOUBLE_EQ(at("c", lead, {0.5}).z(), 1.75);
}

TEST_F(JointQueryTest, TakesTheBodyOfItsFrameFromWhereTheCycleTakesIt) {
  const std::string joints = joint("mount", "fixed", "root", "base", "1 0 0") +
                             joint("lift", "floating", "root", "arm", "0 0 0", "") +
                             joint("turn", "floating", "arm", "tool", "0 0 0", "");
  const auto scene =
      CollisionScene::build(robotFrom(boxLink("root", 0.1) + emptyLink("base") +
                                      boxLink("arm", 0.1) + boxLink("tool", 0.1) + joints),
                            Srdf{}, nullptr);
  const TfPoses poses(transforms_, scene->robot(), scene->bodies(), "base");
  const auto requireBoth = [&](double stamp, const Vector3d& p_WB) {
    publish("root", "arm", stamp, 1.0);
    publish("arm", "tool", stamp, 1.0);
    const JointQuery query({}, *scene, {transforms_, "base", ros::Time(0), now_, &poses});
    std::vector<Eigen::Isometry3d> X_WB;
    query.bodyPosesAt({}, X_WB);
    EXPECT_EQ(X_WB.front().translation(), p_WB);
    const StampedPoses cycle = poses.latest(now_);
    for (std::size_t i = 0; i < scene->bodies().size(); ++i) {
      ASSERT_TRUE(cycle.poses.known[i]);
      EXPECT_TRUE(cycle.poses.X_WB[i].isApprox(X_WB[scene->bodies()[i].body])) << i;
    }
  };
  requireBoth(999.8, {-1, 0, 0});  // as the URDF has it
  publish("base", "root", 999.9, 5.0);
  requireBoth(999.9, {0, 0, 5});  // as TF has it
}

TEST_F(JointQueryTest, SuspectsAJointThatIsNotNamedAndThatOnlyStaticTransformsPlace) {
  publish("a", "c", 999.5, 0.25, true);
  const TfPoses poses(transforms_, scene_->robot(), scene_->bodies(), "root");
  const auto ask = [&](const std::vector<std::string>& names) {
    return JointQuery(names, *scene_, {transforms_, "root", ros::Time(0), now_, &poses});
  };
  EXPECT_THAT(ask({"lead"}).unknownBecause(),
              ElementsAre(HasSubstr("link 'c': only /tf_static places it, but joint 'lift'")));
  EXPECT_EQ(at("c", ask({"lead"}), {2.0}), Vector3d(2, 0, 0.25)) << "where it is said to be";
  EXPECT_THAT(ask({"lead", "lift"}).unknownBecause(), IsEmpty());
}

TEST_F(JointQueryTest, SuspectsTheRootWhereOnlyStaticTransformsLeadToItFromALinkOfTheRobot) {
  publish("a", "c", 999.5, 0.25, true);
  publish("root", "a", 999.5, 0.0);
  const TfPoses poses(transforms_, scene_->robot(), scene_->bodies(), "c");
  const JointQuery lead({"lead"}, *scene_, {transforms_, "c", ros::Time(999.5), now_, &poses});
  EXPECT_THAT(
      lead.unknownBecause(),
      testing::Contains(HasSubstr("link 'root': only /tf_static places it, but joint 'lift'")));
}

// Also where all joints are named: transforms and clouds cannot be seen to age.
TEST_F(JointQueryTest, SuspectsARootAndCloudsWhileASimulatedClockStandsStill) {
  const auto reasons = [&](const std::string& frame, bool is_static) {
    TransformInput input(TransformSettings{PoseLimits{0.03, 1.0, 0.5}, true});
    tf2_msgs::TFMessage message;
    message.transforms.resize(1);
    message.transforms[0].header.stamp = now_;
    message.transforms[0].header.frame_id = "map";
    message.transforms[0].child_frame_id = "root";
    message.transforms[0].transform.rotation.w = 1.0;
    input.take(message, is_static, {now_, 0.0});
    input.followClock({now_, 0.06});
    return JointQuery({"lead", "lift"}, *scene_, {input, frame, {}, now_}).unknownBecause();
  };
  EXPECT_THAT(reasons("map", false), ElementsAre(HasSubstr("/clock stands still")));
  EXPECT_THAT(reasons("map", true), IsEmpty()) << "what is static does not age";
  EXPECT_THAT(reasons("root", false), IsEmpty()) << "TF is not asked";
  SceneDescription seen;
  seen.robots.push_back(
      {robotFrom(emptyLink("root") + boxLink("a", 0.1) +
                 joint("lead", "prismatic", "root", "a", "0 0 0", "<limit lower='-9' upper='9'/>") +
                 boxLink("c", 0.1) +
                 joint("lift", "prismatic", "a", "c", "0 0 0", "<limit lower='-9' upper='9'/>")),
       std::nullopt, ""});
  seen.clouds.push_back(cloudOf("cloud", 0.1, {}));
  scene_ = CollisionScene::build(seen);
  EXPECT_THAT(reasons("root", false), ElementsAre(HasSubstr("/clock stands still")));
}

TEST_F(JointQueryTest, SuspectsWhatTfLastSaidTooLongAgo) {
  publishLift(998.0, 0.25);
  transforms_.followClock(now_ = ros::Time(1000.0));
  EXPECT_THAT(query({"lead"}).unknownBecause(),
              ElementsAre(HasSubstr("link 'c': its newest transform is 2.00 s old")));
  EXPECT_DOUBLE_EQ(at("c", query({"lead"}), {0.0}).z(), 0.25) << "where it was last";
  EXPECT_THAT(query({"lead", "lift"}).unknownBecause(), IsEmpty());
}

TEST_F(JointQueryTest, SuspectsARootThatStandsInAnotherFrameAndWasPlacedTooLongAgo) {
  publish("map", "root", 998.0, 0.5);
  transforms_.followClock(now_ = ros::Time(1000.0));
  const std::vector<std::string> all = {"lead", "lift"};
  const JointQuery in_map(all, *scene_, {transforms_, "map", ros::Time(0), now_});
  EXPECT_THAT(in_map.unknownBecause(), ElementsAre(HasSubstr("link 'root': its newest transform")));
  EXPECT_DOUBLE_EQ(at("a", in_map, {0.0, 0.0}).z(), 0.5);
  EXPECT_THAT(query(all).unknownBecause(), IsEmpty());
}

TEST_F(JointQueryTest, AStampThatTheRequestNamesMayBeLongAgo) {
  publishLift(997.0, 0.25);
  publishLift(998.0, 0.75);
  const JointQuery lead = query({"lead"}, ros::Time(997.5));
  EXPECT_THAT(lead.unknownBecause(), IsEmpty());
  EXPECT_NEAR(at("c", lead, {2.0}).z(), 0.5, 1e-12);
}

TEST_F(JointQueryTest, TakesWhatNobodyKnowsAtZeroAndSuspectsIt) {
  const JointQuery lead = query({"lead"});
  EXPECT_THAT(lead.jointsAtZero(), ElementsAre("lift"));
  EXPECT_THAT(lead.unknownBecause(), ElementsAre(HasSubstr("joint 'lift'")));
}

TEST_F(JointQueryTest, RefusesPositionsThatAreNotOneForEachNameOrNotFinite) {
  const JointQuery lead = query({"lead"});
  const std::vector<double> two = {1.0, 2.0}, none;
  for (const auto& positions : {two, none}) {
    EXPECT_THROW(at("a", lead, positions), InputError);
    EXPECT_THROW(lead.jointPositionsAt(positions), InputError);
  }
  EXPECT_THROW(at("a", lead, {std::nan("")}), InputError);
  EXPECT_EQ(refusal([&] { lead.jointPositionsAt(two); }),
            "1 joints are named, but there are 2 positions");
}

TEST_F(JointQueryTest, GivesThePositionsOfAllJoints) {
  const auto positions = query({"lift", "lead"}).jointPositionsAt({7.0, 4.0});
  const RobotModel& robot = scene_->robot();
  EXPECT_EQ(positions[robot.findJoint("lead")], 4.0);
  EXPECT_EQ(positions[robot.findJoint("lift")], 7.0);
  EXPECT_EQ(positions[robot.findJoint("follower")], 3.0);
}

TEST_F(JointQueryTest, SuspectsOnlyWhatAnythingThatIsCheckedHangsOn) {
  scene_ = CollisionScene::build(
      robotFrom(emptyLink("root") + emptyLink("carrier") + boxLink("a", 0.1) + boxLink("b", 0.1) +
                emptyLink("sensor") + joint("carry", "prismatic", "root", "carrier") +
                joint("lift", "prismatic", "carrier", "a") +
                joint("lower", "prismatic", "root", "b") +
                joint("look", "revolute", "a", "sensor")),
      Srdf{}, nullptr);
  const JointQuery some = query({"lift", "lower"});
  EXPECT_THAT(some.jointsAtZero(), testing::UnorderedElementsAre("carry", "look"));
  EXPECT_THAT(some.unknownBecause(), ElementsAre(HasSubstr("joint 'carry'")));
  EXPECT_THAT(query({"lift", "lower", "carry"}).unknownBecause(), IsEmpty());
}

TEST_F(JointQueryTest, DoesNotAskWhereARobotIsOfWhichNothingIsChecked) {
  SceneDescription description;
  description.robots.push_back(
      {robotFrom(emptyLink("root") + boxLink("a", 0.1) + boxLink("b", 0.1) +
                 joint("lift", "prismatic", "root", "a") +
                 joint("lower", "prismatic", "root", "b")),
       std::nullopt, ""});
  description.robots.push_back({robotFrom(boxLink("other", 0.1)), std::nullopt, ""});
  EXPECT_THROW(JointQuery({}, *CollisionScene::build(description), {transforms_, "root", {}, now_}),
               InputError);
  description.settings.ignored_links = {{"other"}};
  scene_ = CollisionScene::build(description);
  EXPECT_THAT(query({"lift", "lower"}).unknownBecause(), IsEmpty());
}

}  // namespace collision_pairs::test_joint_query
