#include <cmath>
#include <sstream>

#include "geometry_conversions.h"
#include "printed.h"
#include "report_of_boxes.h"

namespace collision_pairs::test_messages {

using visualization_msgs::Marker;
using visualization_msgs::MarkerArray;

TEST_F(Report, AsAMessageSaysEveryPairWithItsState) {
  const CollisionPairs message =
      toMessage(detector_.report(), *without({"d", "a"}), settings_, "world", ros::Time(7));
  EXPECT_EQ(message.header.frame_id, "world");
  EXPECT_EQ(message.header.stamp, ros::Time(7));
  EXPECT_TRUE(message.in_collision);
  EXPECT_EQ(message.nb_boxes, 4u);
  EXPECT_EQ(message.nb_pairs, 2u);
  EXPECT_EQ(message.fidelity, "mesh");
  ASSERT_EQ(message.pairs.size(), 2u);
  EXPECT_EQ(message.pairs[0].first_link, "a");
  EXPECT_EQ(message.pairs[0].second_link, "b");
  EXPECT_EQ(message.pairs[0].state, CollisionPair::CONTACT);
  EXPECT_EQ(message.pairs[1].state, CollisionPair::NEAR);
  ASSERT_EQ(message.pairs[1].contacts.size(), 1u);
  EXPECT_NEAR(message.pairs[1].contacts[0].depth, -message.pairs[1].distance, 1e-15);
  EXPECT_NEAR(message.pairs[1].contacts[0].normal.x, 1.0, 1e-9);
  EXPECT_EQ(message.left_out, (std::vector<std::string>{"a", "d"}));
}

TEST_F(Report, AsAMessageSaysEverythingThatIsInIt) {
  CollisionReport report = detector_.report();
  report.min_distance = -0.5;
  report.min_distance_is_bound = true;
  report.tolerance = 0.001;
  report.nb_settled = {11, 12, 13, 14, 15};
  report.nb_unresolved = 21;
  report.budget_spent = true;
  report.nb_degraded = 22;
  report.nb_answered_natively = 23;
  report.narrow_phase = NarrowPhaseMethod::FCL;
  report.times = {1.0, 2.0, 3.0, 7.0};
  report.left_out = {3};
  report.contacts = {{{1, 2, 3}, {4, 5, 6}, {7, 8, 9}, 0.25, {0, 1}},
                     {{-1, -2, -3}, {-4, -5, -6}, {-7, -8, -9}, -0.125, {1, 2}}};
  report.pairs[0].nb_contacts = 2;
  report.pairs[1].state = PairState::UNRESOLVED;
  report.pairs[1].fidelity = Fidelity::SPHERES;
  settings_.time_budget = 9.0;
  settings_.fidelity = Fidelity::CONVEX;
  EXPECT_EQ(
      printed(toMessage(report, *without({"a"}), settings_, "world", ros::Time(7))),
      "header stamp 7.000000000 frame_id world verdict 1 in_collision 1 nb_boxes 4 nb_pairs 2 "
      "alarm_distance 0.2 tolerance 0.001 fidelity convex min_distance -0.5 min_distance_is_bound "
      "1 pairs[0] first_link a second_link b state 1 distance -0.1 fidelity mesh contacts[0] "
      "first_point x 1 y 2 z 3 second_point x 4 y 5 z 6 normal x 7 y 8 z 9 depth 0.25 contacts[1] "
      "first_point x -1 y -2 z -3 second_point x -4 y -5 z -6 normal x -7 y -8 z -9 depth -0.125 "
      "pairs[1] first_link b second_link c state 2 distance 0.1 fidelity spheres contacts[0] "
      "first_point x -1 y -2 z -3 second_point x -4 y -5 z -6 normal x -7 y -8 z -9 depth -0.125 "
      "left_out[0] a left_out[1] d nb_degraded 22 narrow_phase fcl nb_answered_natively 23 "
      "nb_settled[0] 11 nb_settled[1] 12 nb_settled[2] 13 nb_settled[3] 14 nb_settled[4] 15 "
      "nb_unresolved 21 budget_spent 1 time_budget 9 time_boxes 1 time_broad_phase 2 "
      "time_narrow_phase 3 time_total 7");
}

TEST_F(Report, AsAMessageSaysOfEveryStateAndCertaintyWhatItIs) {
  CollisionReport report = detector_.report();
  const auto pair = [&] {
    return toMessage(report, *scene_, settings_, "world", ros::Time(7)).pairs[0];
  };
  const std::pair<PairState, std::uint8_t> states[] = {
      {PairState::NEAR, CollisionPair::NEAR},
      {PairState::CONTACT, CollisionPair::CONTACT},
      {PairState::UNRESOLVED, CollisionPair::UNRESOLVED}};
  for (const auto& [state, said] : states) {
    report.pairs[0].state = state;
    EXPECT_EQ(pair().state, said);
  }
  const std::pair<Certainty, std::uint8_t> certainties[] = {
      {Certainty::EXACT, CollisionPair::EXACT},
      {Certainty::TOLERATED, CollisionPair::LOWER_BOUND},
      {Certainty::BEYOND, CollisionPair::LOWER_BOUND},
      {Certainty::BOUND, CollisionPair::DEPTH_BOUND},
      {Certainty::DEGRADED, CollisionPair::LOWER_BOUND},
      {Certainty::UNFINISHED, CollisionPair::LOWER_BOUND}};
  for (const auto& [certainty, said] : certainties) {
    report.pairs[0].certainty = certainty;
    EXPECT_EQ(pair().certainty, said);
  }
}

TEST_F(Report, OfADistanceWithoutEndSaysSoOnlyIfNothingIsLeftOut) {
  CollisionReport report = detector_.report();
  report.min_distance = HUGE_VAL;
  const auto distance = [&] {
    return toMessage(report, *scene_, settings_, "world", ros::Time(7)).min_distance;
  };
  EXPECT_EQ(distance(), HUGE_VAL);
  report.left_out = {3};
  EXPECT_EQ(distance(), 0.0);
  report.min_distance = 0.5;
  EXPECT_EQ(distance(), 0.5) << "of the others";
  report.left_out = {0, 1, 2, 3};
  EXPECT_EQ(distance(), 0.0);
}

TEST_F(Report, OfNothingHasNoOtherField) {
  EXPECT_EQ(
      printed(unknown("there is no robot", "world", ros::Time(7))),
      "header stamp 7.000000000 frame_id world verdict 2 unknown_because[0] there is no "
      "robot in_collision 1 min_distance_is_bound 1 nb_settled[0] nb_settled[1] nb_settled[2] "
      "nb_settled[3] nb_settled[4]");
}

TEST(PoseOfAMessage, ThatIsNoneSaysWhy) {
  const double nan = std::nan("");
  struct Case {
    double position[3], quaternion[4];
    const char* says;
  };
  const Case all[] = {{{nan, 2, 3}, {0, 0, 0, 1}, "its position is not finite"},
                      {{1, nan, 3}, {0, 0, 0, 1}, "its position is not finite"},
                      {{1, 2, HUGE_VAL}, {0, 0, 0, 1}, "its position is not finite"},
                      {{1, 2, 3}, {nan, 0, 0, 1}, "its quaternion is not finite"},
                      {{1, 2, 3}, {0, 0, 0, -HUGE_VAL}, "its quaternion is not finite"},
                      {{1, 2, 3}, {1, 2, 4, 2}, "its quaternion is of length 5, not 1"}};
  for (const Case& one : all) {
    geometry_msgs::Pose pose;
    geometry_msgs::Transform transform;
    const auto fill = [](const double* values, std::initializer_list<double*> fields) {
      for (double* field : fields) *field = *values++;
    };
    fill(one.position, {&pose.position.x, &pose.position.y, &pose.position.z});
    fill(one.quaternion,
         {&pose.orientation.x, &pose.orientation.y, &pose.orientation.z, &pose.orientation.w});
    auto& p = transform.translation;
    fill(one.position, {&p.x, &p.y, &p.z});
    transform.rotation = pose.orientation;
    EXPECT_EQ(whyNoIsometry(pose), one.says);
    EXPECT_EQ(whyNoIsometry(transform), one.says);
    Eigen::Isometry3d X;
    EXPECT_FALSE(toIsometry(pose, X));
  }
}

TEST_F(Report, InContactIsCollisionAlsoWhereSomethingElseIsUnknown) {
  const auto scene = without({"d"});
  const CollisionPairs message = toMessage(CollisionDetector(scene).detect(poses_, settings_),
                                           *scene, settings_, "world", ros::Time(7));
  EXPECT_EQ(message.verdict, CollisionPairs::COLLISION);
  EXPECT_TRUE(message.in_collision);
  EXPECT_TRUE(message.unknown_because.empty());
}

TEST_F(Report, OfBoxesApartIsFreeAndWithAnythingLeftOutUnknown) {
  BodyPoses poses;
  poses.resize(scene_->bodies().size());
  for (int i = 0; i < 4; ++i) {
    poses.X_WB[scene_->models()[i].body].translation().x() = 3.0 * i;
  }
  const auto messageOf = [&](const std::vector<std::string>& missing) {
    const auto scene = without(missing);
    return toMessage(CollisionDetector(scene).detect(poses, settings_), *scene, settings_, "world",
                     ros::Time(7));
  };
  EXPECT_EQ(messageOf({}).verdict, CollisionPairs::FREE);
  EXPECT_FALSE(messageOf({}).in_collision);
  EXPECT_TRUE(messageOf({}).unknown_because.empty());

  EXPECT_EQ(messageOf({"d"}).verdict, CollisionPairs::UNKNOWN);
  EXPECT_TRUE(messageOf({"d"}).in_collision);
  EXPECT_EQ(messageOf({"d"}).unknown_because,
            std::vector<std::string>{"geometry that could not be read: d"});

  poses.known[scene_->models()[2].body] = 0;
  EXPECT_EQ(messageOf({}).verdict, CollisionPairs::UNKNOWN);
  EXPECT_EQ(messageOf({}).unknown_because, std::vector<std::string>{"no usable pose: c"});

  poses.known[scene_->models()[2].body] = 1;
  poses.X_WB[scene_->models()[2].body].translation().x() = 3.5;  // b meets c
  settings_.time_budget = 1e-12;
  EXPECT_EQ(messageOf({}).verdict, CollisionPairs::UNKNOWN);
  EXPECT_EQ(messageOf({}).unknown_because,
            std::vector<std::string>{"unresolved pairs that may be in contact: b|c"});
}

TEST_F(Report, TellsCloudsThatAreUnknownFromLinksWithoutPoses) {
  SceneDescription description;
  description.robots.push_back({robotFrom(slidingBoxes(2)), std::nullopt, ""});
  for (const char* const name : {"left", "right"}) {
    description.clouds.push_back(cloudOf(name, 0.1, {}));
  }
  const auto scene = CollisionScene::build(description);
  BodyPoses poses;
  poses.resize(scene->bodies().size());
  for (int i = 0; i < 2; ++i) poses.X_WB[scene->models()[i].body].translation().x() = 3.0 * i;
  const CollisionPairs message =
      toMessage(CollisionDetector(scene).detect(poses, {}), *scene, {}, "world", ros::Time(7));
  EXPECT_EQ(message.verdict, CollisionPairs::UNKNOWN);
  EXPECT_EQ(message.unknown_because,
            std::vector<std::string>{"clouds that are unknown or incomplete: left, right"});
}

TEST_F(Report, OfToleratedDistancesSaysThatTheyAreLowerBoundsAndBySoMuch) {
  CollisionReport report = detector_.report();
  report.tolerance = 0.001;
  report.pairs.back().certainty = Certainty::TOLERATED;
  const CollisionPairs message = toMessage(report, *scene_, settings_, "world", ros::Time(7));
  EXPECT_EQ(message.tolerance, 0.001);
  EXPECT_EQ(message.pairs.back().certainty, CollisionPair::LOWER_BOUND);
  EXPECT_EQ(message.pairs.front().certainty, CollisionPair::EXACT);
}

TEST_F(Report, ALinkThatIsLeftOutForTwoReasonsIsNamedOnce) {
  BodyPoses poses;
  poses.resize(scene_->bodies().size());
  poses.known[scene_->models()[2].body] = 0;
  const auto scene = without({"c", "a"});
  const CollisionPairs message = toMessage(CollisionDetector(scene).detect(poses, settings_),
                                           *scene, settings_, "world", ros::Time(7));
  EXPECT_EQ(message.left_out, (std::vector<std::string>{"a", "c"}));
}

TEST_F(Report, DoesNotBlameOpenPairsThatAreKnownToBeApart) {
  BodyPoses poses;
  poses.resize(scene_->bodies().size());
  const double x[] = {0.0, 0.5, 1.6, 9.0};  // a meets b; b and c are near
  for (int i = 0; i < 4; ++i) {
    poses.X_WB[scene_->models()[i].body].translation().x() = x[i];
  }
  settings_.time_budget = 1e-12;
  EXPECT_EQ(detector_.detect(poses, settings_).unknown_because,
            std::vector<std::string>{"unresolved pairs that may be in contact: a|b"});
}

TEST_F(Report, OfLinksWithoutPosesBoundsNoDistance) {
  BodyPoses poses;
  poses.resize(scene_->bodies().size());
  for (const bool min_distance : {false, true}) {
    settings_.min_distance = min_distance;
    for (const std::size_t nb_known : {0u, 1u}) {
      if (nb_known == 1 && !min_distance) continue;  // then it is the alarm distance
      for (std::size_t i = 0; i < poses.known.size(); ++i) poses.known[i] = i < nb_known;
      const CollisionPairs message =
          toMessage(detector_.detect(poses, settings_), *scene_, settings_, "world", ros::Time(7));
      EXPECT_EQ(message.min_distance, 0.0) << min_distance << nb_known;
      EXPECT_TRUE(message.min_distance_is_bound);
    }
  }
}

TEST_F(Report, OfNothingIsUnknown) {
  const CollisionPairs message = unknown("there is no robot", "world", ros::Time(7));
  EXPECT_EQ(message.verdict, CollisionPairs::UNKNOWN);
  EXPECT_TRUE(message.in_collision);
  EXPECT_EQ(message.unknown_because, std::vector<std::string>{"there is no robot"});
  const MarkerArray array = toMarkers(message, nullptr, false);
  ASSERT_EQ(array.markers.size(), 3u);
  EXPECT_EQ(array.markers[1].text, "UNKNOWN");
  EXPECT_EQ(array.markers[2].text, "there is no robot");
}

TEST_F(Report, OfACheckThatLeavesOutAllPairsSaysWhyItIsUnknown) {
  BodyPoses poses;
  poses.resize(scene_->bodies().size());
  settings_.may_ignore = [](std::uint32_t, std::uint32_t) { return true; };  // all boxes meet
  const CollisionPairs message =
      toMessage(detector_.detect(poses, settings_), *scene_, settings_, "world", ros::Time(7));
  EXPECT_EQ(message.verdict, CollisionPairs::UNKNOWN);
  EXPECT_EQ(message.unchecked, "every pair is ignored");
  EXPECT_EQ(message.unknown_because, (std::vector<std::string>{"every pair is ignored"}));
}

TEST_F(Report, WithVerdictOnlySaysThatItsPairsAreNotAll) {
  settings_.verdict_only = true;
  const CollisionPairs message =
      toMessage(detector_.report(), *scene_, settings_, "world", ros::Time(7));
  EXPECT_TRUE(message.verdict_only);
  EXPECT_TRUE(message.in_collision);
  EXPECT_EQ(message.alarm_distance, 0.0);
}

/// Of one scene and its detector, with the links where `place` puts them.
class OfMixedLinks : public testing::Test {
 protected:
  OfMixedLinks() {
    poses_.resize(scene_->bodies().size());
    for (std::size_t i = 0; i < poses_.X_WB.size(); ++i) {
      poses_.X_WB[i].translation().y() = 10.0 * static_cast<double>(i + 1);
    }
  }
  void place(const std::string& link, double x) {
    auto& X_WB = poses_.X_WB[scene_->models()[scene_->findModel(link)].body];
    X_WB = Eigen::Translation3d(x, 0, 0) * Eigen::Isometry3d::Identity();
  }
  CollisionPairs message() {
    CheckSettings settings;
    settings.list_boxes = true;
    return toMessage(detector_.detect(poses_, settings), *scene_, settings, "world", ros::Time(7),
                     {});
  }
  std::shared_ptr<const CollisionScene> scene_ =
      CollisionScene::build(mixedRobot(2), std::nullopt, nullptr);
  CollisionDetector detector_{scene_};
  BodyPoses poses_;
};

TEST_F(OfMixedLinks, AContactNamesTheElementWithinItsLink) {
  place("z", 0.0);  // its second element is a sphere at x = 0.2 that reaches to 0.3
  place("c", 0.4);  // a sphere
  const CollisionPairs found = message();
  ASSERT_EQ(found.pairs.size(), 1u);
  ASSERT_EQ(found.pairs[0].contacts.size(), 1u);
  EXPECT_EQ(found.pairs[0].contacts[0].first_element, 0u);
  EXPECT_EQ(found.pairs[0].contacts[0].second_element, 1u);
  const auto as_first = scene_->models()[scene_->findModel("z")].first_element + 1;
  CollisionReport report = detector_.report();
  std::swap(report.contacts[0].elements.first, report.contacts[0].elements.second);
  ASSERT_EQ(report.contacts[0].elements.first, as_first);
  const auto swapped = toMessage(report, *scene_, {}, "world", ros::Time(7)).pairs[0];
  EXPECT_EQ(swapped.contacts[0].first_element, 1u);
  EXPECT_EQ(swapped.contacts[0].second_element, 0u);
}

TEST_F(OfMixedLinks, TheDepthOfMeshesIsSaidToBeABound) {
  place("d", 0.0);
  place("e", 0.1);
  const CollisionPairs found = message();
  ASSERT_EQ(found.pairs.size(), 1u);
  EXPECT_EQ(found.pairs[0].state, CollisionPair::CONTACT);
  EXPECT_EQ(found.pairs[0].certainty, CollisionPair::DEPTH_BOUND);
}

TEST_F(OfMixedLinks, SpheresThatTouchExactlyAreDrawnInContact) {
  place("c", 0.0);
  place("k", 0.3);
  const CollisionPairs found = message();
  ASSERT_EQ(found.pairs.size(), 1u);
  ASSERT_EQ(found.pairs[0].distance, 0.0);
  std::map<std::string, int> count;
  for (const Marker& marker : toMarkers(found, &detector_.report(), false).markers) {
    ++count[marker.ns];
  }
  EXPECT_EQ(count["boxes_in_contact"], 2);
  EXPECT_EQ(count["normals"], 1);
}

TEST(PoseOfAMessage, IsThePose) {
  RandomInputs random;
  for (int round = 0; round < 100; ++round) {
    const Eigen::Isometry3d X = random.pose(2.0);
    Eigen::Isometry3d X_found;
    ASSERT_TRUE(toIsometry(toPose(X), X_found));
    EXPECT_TRUE(X_found.isApprox(X, 1e-12));
    for (const double length : {0.9989, 0.9991, 1.0009, 1.0011}) {  // float32 is 1e-7 off, at most
      geometry_msgs::Pose scaled = toPose(X);
      for (double* q : {&scaled.orientation.x, &scaled.orientation.y, &scaled.orientation.z,
                        &scaled.orientation.w}) {
        *q *= length;
      }
      const bool is_taken = std::abs(length - 1.0) < 1e-3;
      EXPECT_EQ(toIsometry(scaled, X_found), is_taken) << length;
      if (!is_taken) continue;
      EXPECT_TRUE(X_found.isApprox(X, 1e-12)) << length;
    }
  }
  geometry_msgs::Pose pose = toPose(Eigen::Isometry3d::Identity());
  pose.position.y = std::nan("");
  Eigen::Isometry3d X_none;
  EXPECT_FALSE(toIsometry(pose, X_none));
}

}  // namespace collision_pairs::test_messages
