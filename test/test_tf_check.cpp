// What the report of a cycle, or of a request, says of poses from TF. Without a master.
#include <cmath>

#include <collision_pairs/CheckCollisions.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "demo_scene.h"
#include "query_services.h"
#include "tf_check.h"

namespace collision_pairs {
namespace test_tf_check {

using testing::ElementsAre;
using testing::HasSubstr;

/// Spheres a, b and c of radius 0.5 that float along x.
class TfCheck : public testing::Test {
 protected:
  void SetUp() override {
    ros::Time::init();
    std::string urdf = emptyLink("root");
    for (const std::string link : {"a", "b", "c"}) {
      urdf += linkWith(link, "<sphere radius='0.5'/>") +
              joint("to_" + link, "floating", "root", link, "0 0 0", "");
    }
    scene_.scene = CollisionScene::build(robotFrom(urdf), Srdf{}, nullptr);
    scene_.frame = "root";
    scene_.tf_poses = std::make_unique<TfPoses>(transforms_, scene_.scene->robot(),
                                                scene_.scene->bodies(), "root");
    detector_ = std::make_unique<CollisionDetector>(scene_.scene);
    settings_.alarm_distance = 2.0;
  }

  void publish(const std::string& link, double stamp, double x, bool is_static = false) {
    tf2_msgs::TFMessage message;
    message.transforms.resize(1);
    auto& transform = message.transforms[0];
    transform.header.stamp = ros::Time(stamp);
    transform.header.frame_id = "root";
    transform.child_frame_id = link;
    transform.transform.translation.x = x;
    transform.transform.rotation.w = 1.0;
    transforms_.take(message, is_static, now_);
  }
  /// From `x` at 999.5 s on at `speed`, seen twice.
  void slide(const std::string& link, double x, double speed) {
    publish(link, 999.5, x);
    publish(link, 1000.0, x + 0.5 * speed);
  }
  CollisionPairs check(double transform_time = 0.0) {
    const StampedPoses stamped = scene_.tf_poses->latest(now_);
    CollisionPairs message = checkPoses(scene_, stamped, doubtsOf(stamped, transforms_, now_),
                                        settings_, now_, transform_time, *detector_);
    addClosingMotion(scene_, stamped, detector_->report(), message);
    return message;
  }

  ros::Time now_{1000.0};
  TransformInput transforms_;
  ActiveScene scene_;
  CheckSettings settings_;
  std::unique_ptr<CollisionDetector> detector_;
};

TEST_F(TfCheck, TheTimeToContactIsThatOfTheFirstPairToMeet) {
  slide("b", 0.0, 0.0);
  slide("a", -3.0, 2.0);  // ends 1 m before b: half a second
  slide("c", 2.5, -0.5);  // ends 1.25 m behind b: two and a half
  const CollisionPairs message = check();
  ASSERT_EQ(message.pairs.size(), 2u);
  EXPECT_NEAR(message.pairs[0].closing_speed, 2.0, 1e-9);
  EXPECT_NEAR(message.pairs[1].closing_speed, 0.5, 1e-9);
  EXPECT_TRUE(message.time_to_contact_is_known);
  EXPECT_NEAR(message.time_to_contact, 0.5, 1e-4);
}

TEST_F(TfCheck, TheTimeToContactIsNotKnownWhereOneOfThePairsWasNotSeenBefore) {
  publish("a", 1000.0, -2.0);
  slide("b", 0.0, 0.0);
  slide("c", 2.5, -0.5);
  const CollisionPairs message = check();
  ASSERT_EQ(message.pairs.size(), 2u);
  EXPECT_FALSE(message.pairs[0].closing_speed_is_known);
  EXPECT_TRUE(message.pairs[1].closing_speed_is_known);
  EXPECT_FALSE(message.time_to_contact_is_known);
  EXPECT_EQ(message.time_to_contact, 0.0);
}

TEST_F(TfCheck, WhatNeverMovesIsReportedAsOfNow) {
  const std::vector<std::string> stand{"to_a", "to_b", "to_c"};
  scene_.tf_poses = std::make_unique<TfPoses>(transforms_, scene_.scene->robot(),
                                              scene_.scene->bodies(), "root", stand);
  double x = 0.0;
  for (const char* link : {"a", "b", "c"}) publish(link, 1.0, x += 5.0, true);
  const CollisionPairs message = check();
  EXPECT_EQ(message.verdict, CollisionPairs::FREE);
  EXPECT_EQ(message.header.stamp, now_);
}

TEST_F(TfCheck, TheTotalIncludesTheTimeOfTheTransformsAndOfTheClosingMotion) {
  slide("a", -1.5, 0.0);
  slide("b", 0.0, 0.0);
  EXPECT_GE(check(100.0).time_total, 100.0);
  CollisionPairs message = check(100.0);
  EXPECT_EQ(message.time_transforms, 100.0);
  message.time_total = 0.0;
  addClosingMotion(scene_, scene_.tf_poses->latest(now_), detector_->report(), message);
  EXPECT_GT(message.time_total, 0.0);
}

TEST_F(TfCheck, TheClosingSpeedIsThatOfTheLastTenthOfASecond) {
  slide("b", 0.0, 0.0);
  publish("a", 999.5, -2.5);
  publish("a", 999.9, -2.5);
  publish("a", 999.95, -2.25);
  publish("a", 1000.0, -1.5);
  const CollisionPairs message = check();
  ASSERT_EQ(message.pairs.size(), 1u);
  EXPECT_NEAR(message.pairs[0].closing_speed, 10.0, 1e-6);
}

TEST_F(TfCheck, TheClosingSpeedIsNotKnownBeforeTheFirstTenthOfASecondOfTheClock) {
  for (const double now : {0.05, 0.5}) {
    now_ = ros::Time(now);
    for (const double earlier : {0.2, 0.0}) {
      publish("a", now - earlier * now, -1.5);
      publish("b", now - earlier * now, 0.0);
    }
    const CollisionPairs message = check();
    ASSERT_EQ(message.pairs.size(), 1u);
    EXPECT_EQ(message.pairs[0].closing_speed_is_known, now > 0.1) << now;
  }
}

TEST_F(TfCheck, ADoubtAboutTheSceneIsADoubtAboutEveryReport) {
  double x = 0.0;
  for (const char* link : {"a", "b", "c"}) slide(link, x += 5.0, 0.0);
  EXPECT_EQ(check().verdict, CollisionPairs::FREE);
  SceneDescription description;
  description.robots.push_back({robotFrom(slidingBoxes(3)), std::nullopt, ""});
  description.restriction.names = {"d*"};
  scene_.scene = CollisionScene::build(description);
  scene_.tf_poses =
      std::make_unique<TfPoses>(transforms_, scene_.scene->robot(), scene_.scene->bodies(), "root");
  detector_ = std::make_unique<CollisionDetector>(scene_.scene);
  const CollisionPairs message = check();
  EXPECT_EQ(message.verdict, CollisionPairs::UNKNOWN);
  EXPECT_THAT(message.unknown_because, ElementsAre(HasSubstr("leave no pair")));
}

TEST_F(TfCheck, WhatNeverMovesIsSeenToStand) {
  scene_.tf_poses =
      std::make_unique<TfPoses>(transforms_, scene_.scene->robot(), scene_.scene->bodies(), "root",
                                std::vector<std::string>{"to_a", "to_b", "to_c"});
  double x = 0.0;
  for (const char* link : {"a", "b", "c"}) publish(link, 1.0, x += 1.5, true);
  const CollisionPairs message = check();
  ASSERT_EQ(message.pairs.size(), 3u);
  for (const CollisionPair& pair : message.pairs) {
    EXPECT_TRUE(pair.closing_speed_is_known);
    EXPECT_EQ(pair.closing_speed, 0.0);
  }
}

TEST_F(TfCheck, DoubtsNameTenLinksCountTheRestAndSayWhatIsRefused) {
  StampedPoses stamped;
  EXPECT_TRUE(doubtsOf(stamped, transforms_, now_).empty());
  std::vector<std::string> ten;
  for (int i = 0; i < 10; ++i) ten.push_back("link " + std::to_string(i));
  stamped.problems = ten;
  EXPECT_EQ(doubtsOf(stamped, transforms_, now_), ten);
  stamped.problems.insert(stamped.problems.end(), {"link 10", "link 11"});
  std::vector<std::string> expected = ten;
  expected.push_back("and 2 more links");
  EXPECT_EQ(doubtsOf(stamped, transforms_, now_), expected);
  expected.insert(expected.begin(), NO_CLOCK);
  EXPECT_EQ(doubtsOf(stamped, transforms_, ros::Time(0)), expected);
  for (int i = 0; i < 12; ++i) publish(std::string("f") + static_cast<char>('a' + i), 0.0, 1.0);
  const std::vector<std::string> with_refused = doubtsOf(stamped, transforms_, now_);
  ASSERT_EQ(with_refused.size(), 11u + 10u);
  EXPECT_EQ(with_refused[11], "refused " + transforms_.refused()[0]);
  EXPECT_TRUE(doubtsOf(StampedPoses(), transforms_, now_).empty()) << "it concerns nobody";
  EXPECT_EQ(doubtsOf(StampedPoses(), transforms_, ros::Time(0)),
            std::vector{std::string(NO_CLOCK)});
}

TEST(Request, IsRefusedForANumberThatIsNotFinite) {
  CheckCollisions::Request request;
  for (double* number : {&request.alarm_distance, &request.tolerance, &request.time_budget}) {
    for (const double value : {HUGE_VAL, -HUGE_VAL, std::nan("")}) {
      *number = value;
      EXPECT_THROW(settingsFor(request, CheckSettings()), InputError);
    }
    *number = 0.0;
  }
  CheckSettings node;
  node.tolerance = 0.25;
  EXPECT_EQ(settingsFor(request, node).tolerance, 0.25);
  request.tolerance = -1.0;  // none
  EXPECT_EQ(settingsFor(request, node).tolerance, 0.0);
  request.tolerance = 0.5;
  EXPECT_EQ(settingsFor(request, node).tolerance, 0.5);
}

TEST(Request, SaysWhatIsOtherThanTheNodesSettings) {
  CheckSettings node;
  node.alarm_distance = 0.1;
  node.time_budget = 0.01;
  node.fidelity = Fidelity::CONVEX;
  node.verdict_only = node.min_distance = true;
  CheckCollisions::Request request;
  CheckSettings settings = settingsFor(request, node);
  EXPECT_EQ(settings.alarm_distance, 0.1);
  EXPECT_EQ(settings.time_budget, 0.01);
  EXPECT_EQ(settings.fidelity, Fidelity::CONVEX);
  EXPECT_FALSE(settings.verdict_only) << "that is the request's alone";
  EXPECT_FALSE(settings.min_distance);
  request.alarm_distance = request.time_budget = -1.0;  // none
  request.fidelity = "obb";
  request.verdict_only = request.min_distance = true;
  settings = settingsFor(request, node);
  EXPECT_EQ(settings.alarm_distance, 0.0);
  EXPECT_EQ(settings.time_budget, 0.0);
  EXPECT_EQ(settings.fidelity, Fidelity::OBB);
  EXPECT_TRUE(settings.verdict_only);
  EXPECT_TRUE(settings.min_distance);
  request.alarm_distance = 0.3;
  request.time_budget = 0.5;
  settings = settingsFor(request, node);
  EXPECT_EQ(settings.alarm_distance, 0.3);
  EXPECT_EQ(settings.time_budget, 0.5);
}

}  // namespace test_tf_check
}  // namespace collision_pairs
