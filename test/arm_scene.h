// Scenes of a small arm, and which pairs they look at.
#pragma once

#include <memory>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "collision_pairs/collision_scene.h"
#include "demo_scene.h"
#include "refusal.h"

namespace collision_pairs {

using Names = std::set<std::pair<std::string, std::string>>;

inline Names allowedPairs(const CollisionScene& scene) {
  Names names;
  for (std::uint32_t a = 0; a < scene.models().size(); ++a) {
    for (std::uint32_t b = a + 1; b < scene.models().size(); ++b) {
      if (scene.filter().allowed(a, b)) {
        names.emplace(scene.models()[a].name, scene.models()[b].name);
      }
    }
  }
  return names;
}

inline Names allowedPairs(const SceneDescription& description) {
  return allowedPairs(*CollisionScene::build(description));
}

inline RigidObject ball(const std::string& name, const std::string& attached_link = "",
                        std::vector<std::string> touch_links = {}) {
  RigidObject object;
  object.name = name;
  object.elements.push_back({Sphere{0.1}, Eigen::Isometry3d::Identity()});
  object.attached_link = attached_link;
  object.touch_links = std::move(touch_links);
  return object;
}

/// shoulder - elbow - wrist - {finger_1, finger_2}, and a head beside them, on revolute joints.
inline std::shared_ptr<const RobotModel> arm() {
  const auto hinge = [](const std::string& parent, const std::string& child) {
    return joint("to_" + child, "continuous", parent, child, "0 0 1", "<axis xyz='0 1 0'/>");
  };
  return robotFrom(boxLink("base", 1) + boxLink("shoulder", 1) + boxLink("elbow", 1) +
                   boxLink("wrist", 1) + boxLink("finger_1", 1) + boxLink("finger_2", 1) +
                   boxLink("head", 1) + hinge("base", "shoulder") + hinge("shoulder", "elbow") +
                   hinge("elbow", "wrist") + hinge("wrist", "finger_1") +
                   hinge("wrist", "finger_2") + hinge("base", "head"));
}

inline SceneDescription armScene(const std::string& srdf) {
  SceneDescription description;
  description.robots.push_back({arm(), Srdf::fromXml("<robot name='r'>" + srdf + "</robot>"), ""});
  return description;
}

inline std::string refusal(const SceneDescription& description) {
  return refusal([&] { CollisionScene::build(description); });
}

}  // namespace collision_pairs
