#include <cmath>
#include <map>
#include <set>
#include <sstream>
#include <tuple>

#include "report_of_boxes.h"

namespace collision_pairs {
namespace {

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
      toMessage(detector_.report(), *scene_, settings_, "world", ros::Time(7), {});
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
