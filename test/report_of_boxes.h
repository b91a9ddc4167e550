// A report of four boxes, its message and markers, for tests.
#pragma once

#include <algorithm>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "conversions.h"
#include "markers.h"
#include "mixed_robot.h"

namespace collision_pairs {

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

  /// The scene, of whose robot some links are incomplete.
  std::shared_ptr<const CollisionScene> without(const std::vector<std::string>& links) const {
    const auto elementsOf = [](const Link& link) { return link.elements; };
    const auto robot = robotFrom(slidingBoxes(4))->withElements(elementsOf, [&](const Link& link) {
      const bool is_missing = std::count(links.begin(), links.end(), link.name) > 0;
      return std::vector<std::string>(is_missing ? 1 : 0, "no such file");
    });
    return CollisionScene::build(robot, std::nullopt, nullptr);
  }

  visualization_msgs::MarkerArray markers(
      bool only_investigated, const std::optional<ShownLimit>& limit = std::nullopt) const {
    const CollisionPairs message =
        toMessage(detector_.report(), *scene_, settings_, "world", ros::Time(7));
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

  static std::vector<visualization_msgs::Marker> limitOf(
      const visualization_msgs::MarkerArray& array) {
    std::vector<visualization_msgs::Marker> found;
    for (const visualization_msgs::Marker& marker : array.markers) {
      if (marker.ns == "speed_limit") found.push_back(marker);
    }
    return found;
  }

  static std::map<std::string, int> countByNamespace(const visualization_msgs::MarkerArray& array) {
    std::map<std::string, int> count;
    for (const visualization_msgs::Marker& marker : array.markers) {
      if (marker.action == visualization_msgs::Marker::ADD) ++count[marker.ns];
    }
    return count;
  }

  std::shared_ptr<const CollisionScene> scene_;
  CollisionDetector detector_;
  CheckSettings settings_;
  BodyPoses poses_;
};

}  // namespace collision_pairs
