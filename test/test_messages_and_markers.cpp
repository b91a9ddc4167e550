#include <cmath>
#include <map>
#include <set>
#include <sstream>

#include <gtest/gtest.h>

#include "conversions.h"
#include "geometry_conversions.h"
#include "markers.h"
#include "mixed_robot.h"
#include "shown_limit.h"

namespace collision_pairs {
namespace {

using visualization_msgs::Marker;
using visualization_msgs::MarkerArray;

/// Boxes a and b in contact, c near b, d far away.
class Report : public testing::Test {
 protected:
  Report()
      : scene_(CollisionScene::build(robotFrom(slidingBoxes(4)), std::nullopt, nullptr)),
        detector_(scene_) {
    settings_.alarm_distance = 0.2;
    settings_.list_boxes = true;
    poses_.resize(scene_->bodies().size());
    const double x[] = {0.0, 0.9, 2.0, 9.0};
    for (int i = 0; i < 4; ++i) {
      poses_.X_WB[scene_->models()[i].body].translation().x() = x[i];
    }
    detector_.detect(poses_, settings_);
  }

  MarkerArray markers(bool only_investigated,
                      const std::optional<ShownLimit>& limit = std::nullopt) const {
    const CollisionPairs message =
        toMessage(detector_.report(), *scene_, settings_, "world", ros::Time(7), {});
    return toMarkers(message, &detector_.report(), only_investigated, limit);
  }

  ShownLimit limited(double scale, const std::string& first, const std::string& second) {
    SpeedLimit limit;
    limit.scale = scale;
    limit.first_link = first;
    limit.second_link = second;
    CollisionDetector detector(scene_);
    return shownLimit(limit, detector, poses_, Fidelity::MESH);
  }

  static std::vector<Marker> limitOf(const MarkerArray& array) {
    std::vector<Marker> found;
    for (const Marker& marker : array.markers) {
      if (marker.ns == "speed_limit") found.push_back(marker);
    }
    return found;
  }

  static std::map<std::string, int> countByNamespace(const MarkerArray& array) {
    std::map<std::string, int> count;
    for (const Marker& marker : array.markers) {
      if (marker.action == Marker::ADD) ++count[marker.ns];
    }
    return count;
  }

  std::shared_ptr<const CollisionScene> scene_;
  CollisionDetector detector_;
  CheckSettings settings_;
  BodyPoses poses_;
};

TEST_F(Report, AsAMessageSaysEveryPairWithItsState) {
  const CollisionPairs message = toMessage(detector_.report(), *scene_, settings_, "world",
                                           ros::Time(7), {"z_broken", "a_broken"});
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
  EXPECT_EQ(message.left_out, (std::vector<std::string>{"a_broken", "z_broken"}));
}

TEST_F(Report, InContactIsCollisionAlsoWhereSomethingElseIsUnknown) {
  const CollisionPairs message =
      toMessage(detector_.report(), *scene_, settings_, "world", ros::Time(7), {"broken"});
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
  const auto messageOf = [&](const std::vector<std::string>& broken) {
    return toMessage(detector_.detect(poses, settings_), *scene_, settings_, "world", ros::Time(7),
                     broken);
  };
  EXPECT_EQ(messageOf({}).verdict, CollisionPairs::FREE);
  EXPECT_FALSE(messageOf({}).in_collision);
  EXPECT_TRUE(messageOf({}).unknown_because.empty());

  EXPECT_EQ(messageOf({"tool"}).verdict, CollisionPairs::UNKNOWN);
  EXPECT_TRUE(messageOf({"tool"}).in_collision);
  EXPECT_EQ(messageOf({"tool"}).unknown_because,
            std::vector<std::string>{"geometry that could not be read: tool"});

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
      toMessage(CollisionDetector(scene).detect(poses, {}), *scene, {}, "world", ros::Time(7), {});
  EXPECT_EQ(message.verdict, CollisionPairs::UNKNOWN);
  EXPECT_EQ(message.unknown_because,
            std::vector<std::string>{"clouds that are unknown or incomplete: left, right"});
}

TEST_F(Report, OfToleratedDistancesSaysThatTheyAreLowerBoundsAndBySoMuch) {
  CollisionReport report = detector_.report();
  report.tolerance = 0.001;
  report.pairs.back().certainty = Certainty::TOLERATED;
  const CollisionPairs message = toMessage(report, *scene_, settings_, "world", ros::Time(7), {});
  EXPECT_EQ(message.tolerance, 0.001);
  EXPECT_EQ(message.pairs.back().certainty, CollisionPair::LOWER_BOUND);
  EXPECT_EQ(message.pairs.front().certainty, CollisionPair::EXACT);
}

TEST_F(Report, ALinkThatIsLeftOutForTwoReasonsIsNamedOnce) {
  BodyPoses poses;
  poses.resize(scene_->bodies().size());
  poses.known[scene_->models()[2].body] = 0;
  const CollisionPairs message = toMessage(detector_.detect(poses, settings_), *scene_, settings_,
                                           "world", ros::Time(7), {"c", "a_broken"});
  EXPECT_EQ(message.left_out, (std::vector<std::string>{"a_broken", "c"}));
}

TEST_F(Report, NamesUpToTenLinksAndCountsTheRest) {
  const auto reasonFor = [&](int count) {
    std::vector<std::string> broken;
    for (int i = 0; i < count; ++i) broken.push_back("l" + std::to_string(i));
    return whyUnknown(detector_.report(), *scene_, broken).front();
  };
  EXPECT_EQ(reasonFor(10),
            "geometry that could not be read: l0, l1, l2, l3, l4, l5, l6, l7, l8, l9");
  EXPECT_EQ(reasonFor(12), reasonFor(10) + " and 2 more");
}

TEST_F(Report, DoesNotBlameOpenPairsThatAreKnownToBeApart) {
  BodyPoses poses;
  poses.resize(scene_->bodies().size());
  const double x[] = {0.0, 0.5, 1.6, 9.0};  // a meets b; b and c are near
  for (int i = 0; i < 4; ++i) {
    poses.X_WB[scene_->models()[i].body].translation().x() = x[i];
  }
  settings_.time_budget = 1e-12;
  EXPECT_EQ(whyUnknown(detector_.detect(poses, settings_), *scene_, {}),
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
      const CollisionPairs message = toMessage(detector_.detect(poses, settings_), *scene_,
                                               settings_, "world", ros::Time(7), {});
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
      toMessage(detector_.detect(poses, settings_), *scene_, settings_, "world", ros::Time(7), {});
  EXPECT_EQ(message.verdict, CollisionPairs::UNKNOWN);
  EXPECT_EQ(message.unchecked, "every pair is ignored");
  EXPECT_EQ(message.unknown_because, (std::vector<std::string>{"every pair is ignored"}));
}

TEST(WhyUnknown, NamesWhatASceneDoesNotCheckAlsoWithoutAReport) {
  const auto scene = CollisionScene::build(robotFrom("<link name='only'/>"), std::nullopt, nullptr);
  EXPECT_FALSE(scene->unchecked().empty());
  EXPECT_EQ(whyUnknown({}, *scene, {}), std::vector<std::string>{scene->unchecked()});
}

TEST_F(Report, ALongReasonIsDrawnInLinesAndCut) {
  for (const std::string& why :
       {std::string(500, 'x'), "link 'x': " + std::string(200, ' '),
        std::string("no usable pose: a, b, c, d, e, f, g, h, i, j, k, l")}) {
    const std::string text =
        toMarkers(unknown(why, "world", ros::Time(7)), nullptr, false).markers.at(2).text;
    std::istringstream lines(text);
    for (std::string line; std::getline(lines, line);) EXPECT_LE(line.size(), 52u);
    EXPECT_LT(text.size(), 140u);
  }
}

TEST_F(Report, WithVerdictOnlySaysThatItsPairsAreNotAll) {
  settings_.verdict_only = true;
  const CollisionPairs message =
      toMessage(detector_.report(), *scene_, settings_, "world", ros::Time(7), {});
  EXPECT_TRUE(message.verdict_only);
  EXPECT_EQ(message.alarm_distance, 0.0);
}

TEST_F(Report, MarkersShowTheVerdictInItsColourAboveAllBoxes) {
  const Marker text = markers(false).markers.at(1);
  EXPECT_EQ(text.ns, "verdict");
  EXPECT_EQ(text.text, "COLLISION");
  EXPECT_EQ(markers(false).markers.at(2).text, "a | b");
  EXPECT_GT(text.color.r, 0.8f);
  EXPECT_LT(text.color.g, 0.2f);
  EXPECT_GT(text.pose.position.z, 0.5);
  EXPECT_TRUE(text.header.stamp.isZero()) << "rviz has to draw it also where the poses are old";
}

TEST_F(Report, BoxesAndContactsAreDrawnWhereTheLinksWereAtItsStamp) {
  int nb_drawn = 0;
  for (const Marker& marker : markers(false).markers) {
    EXPECT_EQ(marker.header.frame_id, "world");
    if (marker.action != Marker::ADD || marker.ns == "verdict") continue;
    EXPECT_EQ(marker.header.stamp, ros::Time(7)) << marker.ns;
    ++nb_drawn;
  }
  EXPECT_GT(nb_drawn, 4);
}

TEST_F(Report, MarkersTellTheThreeKindsOfBoxesApart) {
  const auto count = countByNamespace(markers(false));
  EXPECT_EQ(count.at("boxes_in_contact"), 2);
  EXPECT_EQ(count.at("investigated_boxes"), 1);
  EXPECT_EQ(count.at("other_boxes"), 1);
  EXPECT_EQ(count.at("normals"), 1);
  std::set<std::tuple<float, float, float>> colours;
  for (const Marker& marker : markers(false).markers) {
    if (marker.type != Marker::CUBE || marker.action != Marker::ADD) continue;
    colours.insert({marker.color.r, marker.color.g, marker.color.b});
  }
  EXPECT_EQ(colours.size(), 3u);
}

TEST_F(Report, MarkersNameTheDeepestPairAndPointFromItsFirstLinkToItsSecond) {
  BodyPoses poses;
  poses.resize(scene_->bodies().size());
  const double x[] = {0.0, 0.9, 1.5, 9.0};
  for (int i = 0; i < 4; ++i) {
    poses.X_WB[scene_->models()[i].body].translation().x() = x[i];
  }
  detector_.detect(poses, settings_);
  EXPECT_EQ(markers(false).markers.at(2).text, "b | c");
  for (const Marker& marker : markers(false).markers) {
    if (marker.type != Marker::ARROW || marker.action != Marker::ADD) continue;
    EXPECT_GT(marker.points.at(1).x, marker.points.at(0).x);
  }
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

TEST_F(Report, OtherBoxesAreHiddenOnRequest) {
  const auto count = countByNamespace(markers(true));
  EXPECT_EQ(count.count("other_boxes"), 0u);
  EXPECT_EQ(count.at("boxes_in_contact"), 2);
  EXPECT_EQ(count.at("investigated_boxes"), 1);
}

TEST_F(Report, ALimitIsDrawnAboveTheVerdictWithALineBetweenItsPair) {
  const std::vector<Marker> drawn = limitOf(markers(false, limited(0.25, "b", "c")));
  ASSERT_EQ(drawn.size(), 3u);
  EXPECT_EQ(drawn[0].text, "speed 25 %\nb | c");
  EXPECT_TRUE(drawn[0].header.stamp.isZero());
  EXPECT_GT(drawn[0].pose.position.z, markers(false).markers.at(1).pose.position.z);
  EXPECT_EQ(drawn[1].type, Marker::LINE_LIST);
  ASSERT_EQ(drawn[1].points.size(), 2u);
  EXPECT_NEAR(drawn[1].points[0].x, 1.4, 1e-9);
  EXPECT_NEAR(drawn[1].points[1].x, 1.5, 1e-9);
}

TEST_F(Report, ALimitIsDrawnBelowAVerdictThatHasNoDetail) {
  for (int i = 0; i < 4; ++i) poses_.X_WB[scene_->models()[i].body].translation().x() = 3.0 * i;
  detector_.detect(poses_, settings_);
  const MarkerArray array = markers(false, limited(1.0, "", ""));
  EXPECT_EQ(array.markers.at(1).text, "FREE");
  EXPECT_LT(limitOf(array).front().pose.position.z, array.markers.at(1).pose.position.z);
}

TEST_F(Report, ALimitHasTheColourOfWhatPasses) {
  const auto colour = [&](double scale) {
    const Marker text = limitOf(markers(false, limited(scale, "b", "c"))).front();
    return std::make_tuple(text.color.r > 0.9f, text.color.g > 0.5f, text.color.g > 0.1f);
  };
  EXPECT_EQ(colour(1.0), std::make_tuple(false, true, true));
  EXPECT_EQ(colour(0.5), std::make_tuple(true, true, true));
  EXPECT_EQ(colour(0.0), std::make_tuple(true, false, false));
}

TEST_F(Report, ALimitWhosePairIsFarOrNotThereHasNoLine) {
  EXPECT_EQ(limitOf(markers(false, limited(0.5, "a", "d"))).size(), 1u);
  EXPECT_EQ(limitOf(markers(false, limited(0.5, "a", "gone"))).size(), 1u);
  EXPECT_EQ(limitOf(markers(false, limited(0.5, "", ""))).front().text, "speed 50 %");
  EXPECT_TRUE(limitOf(markers(false)).empty());
}

TEST_F(Report, MarkersClearWhatWasThereAndAreDrawable) {
  const MarkerArray array = markers(false, limited(0.5, "b", "c"));
  EXPECT_EQ(array.markers.front().action, Marker::DELETEALL);
  std::set<std::pair<std::string, int>> ids;
  for (std::size_t i = 1; i < array.markers.size(); ++i) {
    const Marker& marker = array.markers[i];
    EXPECT_TRUE(ids.insert({marker.ns, marker.id}).second) << marker.ns << marker.id;
    EXPECT_EQ(marker.pose.orientation.w, 1.0);
    EXPECT_GT(marker.type == Marker::TEXT_VIEW_FACING ? marker.scale.z : marker.scale.x, 0.0);
    EXPECT_GT(marker.color.a, 0.0f);
    EXPECT_EQ(marker.header.frame_id, "world");
    if (marker.type == Marker::CUBE) {
      EXPECT_GT(marker.scale.y, 0.0);
      EXPECT_GT(marker.scale.z, 0.0);
    }
  }
}

}  // namespace
}  // namespace collision_pairs
