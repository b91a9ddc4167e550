#include <cmath>
#include <map>
#include <set>
#include <sstream>
#include <tuple>

#include "printed.h"
#include "report_of_boxes.h"

namespace collision_pairs::test_markers {

using visualization_msgs::Marker;
using visualization_msgs::MarkerArray;

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

std::vector<std::string> printedAll(const MarkerArray& array) {
  std::vector<std::string> all;
  for (const Marker& marker : array.markers) all.push_back(printed(marker));
  return all;
}

/// Boxes of different sizes, the last one without bounds, one contact and one that is near.
TEST_F(Report, MarkersHaveTheirPlaceSizeAndColour) {
  const CollisionPairs message =
      toMessage(detector_.report(), *scene_, settings_, "world", ros::Time(7));
  CollisionReport report = detector_.report();
  constexpr double HUGE = 1e300;
  report.boxes = {{{0, 0, 0}, {1, 2, 3}},
                  {{2, 1, -1}, {2.5, 4, 0}},
                  {{-1, -2, 4}, {-0.5, -1, 4}},
                  {{-HUGE, -HUGE, -HUGE}, {HUGE, HUGE, 0.5}}};
  report.contacts[0].p_WFirst = {1, 2, 3};
  report.contacts[0].p_WSecond = {4, 5, 6};
  report.contacts[0].nhat_W = {0, 0.6, 0.8};
  report.contacts[1].p_WFirst = {-1, -2, -3};
  report.contacts[1].p_WSecond = {-4, -5, -6};
  ShownLimit limit = limited(0.256, "b", "c");
  limit.nearest = report.contacts[1];
  const std::vector<std::string> expected = {
      "header stamp 7.000000000 frame_id world action 3",
      "header frame_id world ns verdict type 9 pose position x 0.75 y 1 z 5.1383 orientation w 1 "
      "scale z 0.599103 color r 0.95 g 0.05 b 0.05 a 1 text COLLISION",
      "header frame_id world ns verdict id 1 type 9 pose position x 0.75 y 1 z 4.35946 orientation "
      "w 1 scale z 0.209686 color r 0.95 g 0.05 b 0.05 a 1 text a | b",
      "header stamp 7.000000000 frame_id world ns boxes_in_contact type 1 pose position x 0.5 y 1 "
      "z 1.5 orientation w 1 scale x 1 y 2 z 3 color r 0.9 g 0.1 b 0.1 a 0.45",
      "header stamp 7.000000000 frame_id world ns boxes_in_contact id 1 type 1 pose position x "
      "2.25 y 2.5 z -0.5 orientation w 1 scale x 0.5 y 3 z 1 color r 0.9 g 0.1 b 0.1 a 0.45",
      "header stamp 7.000000000 frame_id world ns investigated_boxes id 2 type 1 pose position x "
      "-0.75 y -1.5 z 4 orientation w 1 scale x 0.5 y 1 z 1e-06 color r 1 g 0.75 a 0.3",
      "header stamp 7.000000000 frame_id world ns other_boxes id 3 type 1 pose position x 0.75 y 1 "
      "z -1.5 orientation w 1 scale x 7 y 12 z 4 color r 0.6 g 0.65 b 0.7 a 0.12",
      "header stamp 7.000000000 frame_id world ns contacts type 5 pose orientation w 1 scale x "
      "0.0320156 color r 1 a 1 points[0] x 1 y 2 z 3 points[1] x 4 y 5 z 6",
      "header stamp 7.000000000 frame_id world ns contacts id 1 type 7 pose orientation w 1 scale "
      "x 0.160078 y 0.160078 z 0.160078 color r 1 a 1 points[0] x 1 y 2 z 3 points[1] x 4 y 5 z 6",
      "header stamp 7.000000000 frame_id world ns normals pose orientation w 1 scale x 0.0640312 y "
      "0.14407 color r 0.1 g 0.2 b 1 a 1 points[0] x 4 y 5 z 6 points[1] x 4 y 5.76837 z 7.0245",
      "header stamp 7.000000000 frame_id world ns contacts id 2 type 5 pose orientation w 1 scale "
      "x 0.0320156 color r 1 g 0.55 a 1 points[0] x -1 y -2 z -3 points[1] x -4 y -5 z -6",
      "header stamp 7.000000000 frame_id world ns contacts id 3 type 7 pose orientation w 1 scale "
      "x 0.160078 y 0.160078 z 0.160078 color r 1 g 0.55 a 1 points[0] x -1 y -2 z -3 points[1] x "
      "-4 y -5 z -6",
      "header frame_id world ns speed_limit type 9 pose position x 0.75 y 1 z 5.85722 orientation "
      "w 1 scale z 0.269597 color r 1 g 0.55 a 1 text speed 26 %|b | c",
      "header stamp 7.000000000 frame_id world ns speed_limit id 2 type 5 pose orientation w 1 "
      "scale x 0.0640312 color r 1 g 0.55 a 1 points[0] x -1 y -2 z -3 points[1] x -4 y -5 z -6",
      "header stamp 7.000000000 frame_id world ns speed_limit id 3 type 7 pose orientation w 1 "
      "scale x 0.320156 y 0.320156 z 0.320156 color r 1 g 0.55 a 1 points[0] x -1 y -2 z -3 "
      "points[1] x -4 y -5 z -6"};
  EXPECT_EQ(printedAll(toMarkers(message, &report, false, limit)), expected);
}

TEST_F(Report, WordsWithoutAReportHaveTheirPlaceSizeAndColour) {
  ShownLimit limit = limited(0.0, "", "");
  const std::vector<std::string> expected = {
      "header stamp 7.000000000 frame_id world action 3",
      "header frame_id world ns verdict type 9 pose position z 0.730363 orientation w 1 scale z "
      "0.121244 color r 0.75 g 0.2 b 0.95 a 1 text UNKNOWN",
      "header frame_id world ns verdict id 1 type 9 pose position z 0.572746 orientation w 1 scale "
      "z 0.0424352 color r 0.75 g 0.2 b 0.95 a 1 text why",
      "header frame_id world ns speed_limit type 9 pose position z 0.875855 orientation w 1 scale "
      "z 0.0545596 color r 1 a 1 text speed 0 %"};
  EXPECT_EQ(printedAll(toMarkers(unknown("why", "world", ros::Time(7)), nullptr, false, limit)),
            expected);
  limit.nearest = detector_.report().contacts.at(1);
  const auto with_line = toMarkers(unknown("why", "world", ros::Time(7)), nullptr, false, limit);
  EXPECT_NEAR(with_line.markers.back().scale.x, 2.0 * 0.01, 1e-12);
  CollisionPairs free;
  const std::vector<std::string> of_free = {
      "action 3",
      "ns verdict type 9 pose position z 0.730363 orientation w 1 scale z 0.121244 color r 0.1 g "
      "0.75 b 0.2 a 1 text FREE",
      "ns speed_limit type 9 pose position z 0.596995 orientation w 1 scale z 0.0545596 color r "
      "0.1 g 0.75 b 0.2 a 1 text speed 100 %"};
  EXPECT_EQ(printedAll(toMarkers(free, nullptr, true, limited(1.0, "", ""))), of_free);
}

TEST_F(Report, OfBoxesThatAreNoneHasMarkersOfAUsualSize) {
  CollisionPairs message;
  message.header.frame_id = "world";
  CollisionReport report = detector_.report();
  report.boxes = {noBox(), noBox(), noBox(), noBox()};
  EXPECT_EQ(countByNamespace(toMarkers(message, &report, false)).count("investigated_boxes"), 0u);
  const auto sizeOf = [&](const std::string& ns) {
    for (const Marker& marker : toMarkers(message, &report, false).markers) {
      if (marker.ns == ns) return marker.scale;
    }
    return geometry_msgs::Vector3();
  };
  EXPECT_NEAR(sizeOf("verdict").z, 0.07 * std::sqrt(12.0), 1e-9) << "of a cube of 2 m";
  EXPECT_NEAR(sizeOf("contacts").x, 0.2 * 0.01, 1e-12);
  report.boxes[0] = {{1, 1, 1}, {1 + 1e-4, 1, 1}};
  EXPECT_EQ(sizeOf("verdict").z, 1e-3) << "no smaller";
  EXPECT_NEAR(sizeOf("contacts").x, 0.2 * 1e-4, 1e-12);
  for (int i = 0; i < 4; ++i) {
    report.boxes[i] = {Eigen::Vector3d::Zero(), Eigen::Vector3d::UnitX() * (1 + (i + 2) % 4)};
  }
  EXPECT_NEAR(sizeOf("contacts").x, 0.2 * 0.05 * 3.0, 1e-12) << "of the median, not the third";
  report.boxes.clear();
  EXPECT_NEAR(sizeOf("contacts").x, 0.2 * 0.01, 1e-12) << "no boxes were listed";
}

TEST_F(Report, OfPairsEquallyDeepTheFirstIsNamedAndOfAFreeReportNone) {
  CollisionPairs message = toMessage(detector_.report(), *scene_, settings_, "world", ros::Time(7));
  message.pairs[1].distance = message.pairs[0].distance;
  EXPECT_EQ(toMarkers(message, nullptr, false).markers.at(2).text, "a | b");
  message.pairs[0].state = CollisionPair::UNRESOLVED;  // a bound
  message.pairs[0].distance -= 9.0;
  message.pairs[1].state = CollisionPair::CONTACT;
  EXPECT_EQ(toMarkers(message, nullptr, false).markers.at(2).text,
            message.pairs[1].first_link + " | " + message.pairs[1].second_link);
  message.verdict = CollisionPairs::FREE;
  EXPECT_EQ(toMarkers(message, nullptr, false).markers.size(), 2u);
}

TEST_F(Report, AReasonIsBrokenBetweenWords) {
  const auto drawn = [](const std::string& why) {
    return toMarkers(unknown(why, "world", ros::Time(7)), nullptr, false).markers.at(2).text;
  };
  const std::string x20(20, 'x'), x27(27, 'x'), x28(28, 'x'), x48(48, 'x');
  EXPECT_EQ(drawn(x20 + ' ' + x27), x20 + ' ' + x27) << "48 fit";
  EXPECT_EQ(drawn(x20 + ' ' + x28), x20 + '\n' + x28);
  EXPECT_EQ(drawn(x48 + " xx"), x48 + "\nxx");
  EXPECT_EQ(drawn(x48 + "x x"), x48 + "\nx x");
  EXPECT_EQ(drawn(x20 + ' ' + x20 + ' ' + x20), x20 + ' ' + x20 + '\n' + x20);
  EXPECT_EQ(drawn(x20 + ' ' + x48 + x20), x20 + '\n' + x48 + '\n' + x20);
  EXPECT_EQ(drawn('y' + std::string(130, 'x')).front(), 'y');
  EXPECT_EQ(drawn(' ' + x48), x48.substr(1).insert(0, " ") + "\nx") << "no empty line";
  const std::string a_o = "\xC3\xB6", odd = std::string(47, 'x') + a_o;
  EXPECT_EQ(drawn(odd), x48.substr(1) + '\n' + a_o) << "between characters";
  EXPECT_EQ(drawn(std::string(119, 'x') + a_o + a_o).substr(119 + 2), "...");
  EXPECT_EQ(drawn(std::string(120, 'x')), x48 + '\n' + x48 + '\n' + std::string(24, 'x'));
  EXPECT_EQ(drawn(std::string(121, 'x')), x48 + '\n' + x48 + '\n' + std::string(24, 'x') + "...");
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

TEST_F(Report, ABoxWithoutThicknessIsDrawnAMicrometreThick) {
  const CollisionPairs message =
      toMessage(detector_.report(), *scene_, settings_, "world", ros::Time(7));
  CollisionReport report = detector_.report();
  report.boxes.at(0).max.y() = report.boxes.at(0).min.y();
  for (const Marker& marker : toMarkers(message, &report, false, std::nullopt).markers) {
    if (marker.type != Marker::CUBE || marker.action != Marker::ADD || marker.id != 0) continue;
    EXPECT_NEAR(marker.scale.x, 1.0, 1e-9);
    EXPECT_EQ(marker.scale.y, 1e-6);
    return;
  }
  FAIL() << "no box";
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

TEST_F(Report, ALimitHasItsLineUpToOneMetreByWhatIsCompared) {
  const auto nb_markers = [&](const std::string& first, const std::string& second) {
    return limitOf(markers(false, limited(0.5, first, second))).size();
  };
  EXPECT_EQ(nb_markers("a", "b"), 3u);
  EXPECT_EQ(nb_markers("b", "a"), 3u);
  auto& X_WC = poses_.X_WB[scene_->models()[2].body];
  X_WC.translation().x() = 0.9 + 1.0 + 0.999;
  EXPECT_EQ(nb_markers("b", "c"), 3u);
  X_WC.translation().x() = 0.9 + 1.0 + 1.001;
  EXPECT_EQ(nb_markers("b", "c"), 1u);
  X_WC.linear() = Eigen::AngleAxisd(EIGEN_PI / 4, Eigen::Vector3d::UnitZ()).matrix();
  X_WC.translation() =
      Eigen::Vector3d(0.9 + 1.19, 1.19, 0.0);  // a corner of its box meets one of b's
  SpeedLimit limit;
  limit.first_link = "b";
  limit.second_link = "c";
  for (const Fidelity fidelity : {Fidelity::AABB, Fidelity::MESH}) {
    CollisionDetector detector(scene_);
    EXPECT_EQ(shownLimit(limit, detector, poses_, fidelity).nearest->depth > 0.0,
              fidelity == Fidelity::AABB);
  }
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

/// Of a report about the scene with all links at their root.
std::vector<Marker> boxesOf(const std::shared_ptr<const CollisionScene>& scene) {
  CollisionDetector detector(scene);
  BodyPoses poses;
  poses.resize(scene->bodies().size());
  CheckSettings settings;
  settings.list_boxes = true;
  const auto& report = detector.detect(poses, settings);
  const auto message = toMessage(report, *scene, settings, "world", ros::Time(7));
  std::vector<Marker> boxes;
  for (const Marker& marker : toMarkers(message, &report, false).markers) {
    if (marker.type == Marker::CUBE && marker.action == Marker::ADD) boxes.push_back(marker);
  }
  return boxes;
}

TEST(BoxMarkers, OfAFloorAreFinite) {
  SceneDescription description;
  description.robots.push_back({robotFrom(slidingBoxes(2)), std::nullopt, ""});
  description.objects = {floorAt(-1.0, {})};
  const auto boxes = boxesOf(CollisionScene::build(description));
  EXPECT_EQ(boxes.size(), 3u);
  for (const Marker& marker : boxes) {
    for (const double size : {marker.scale.x, marker.scale.y, marker.scale.z}) {
      EXPECT_GT(size, 0.0);
      EXPECT_LT(size, 100.0);
    }
  }
}

TEST(BoxMarkers, OfWhatIsFlatAreDrawable) {
  const auto boxes = boxesOf(
      CollisionScene::build(robotFrom(linkWith("root", "<box size='1 1 0'/>") + boxLink("a", 1.0) +
                                      joint("j", "floating", "root", "a", "0 0 0", "")),
                            Srdf{}, nullptr));
  EXPECT_EQ(boxes.size(), 2u);
  for (const Marker& marker : boxes) {
    EXPECT_GE(marker.scale.z, 1e-6);  // rviz shows nothing where an edge has no length
  }
}

}  // namespace collision_pairs::test_markers
