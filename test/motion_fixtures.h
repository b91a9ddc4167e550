// Small robots and scenes for tests of motions.
#pragma once

#include <limits>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "collision_pairs/motion_check.h"
#include "demo_scene.h"

namespace collision_pairs {

constexpr double NAN_POSITION = std::numeric_limits<double>::quiet_NaN();

inline RigidObject boxAt(const std::string& name, const Eigen::Vector3d& center,
                         const Eigen::Vector3d& size) {
  RigidObject object;
  object.name = name;
  object.elements.push_back({Box{size}, Eigen::Isometry3d::Identity()});
  object.X_PO = Eigen::Translation3d(center) * Eigen::Isometry3d::Identity();
  return object;
}

inline SceneDescription described(std::shared_ptr<const RobotModel> robot,
                                  std::vector<RigidObject> objects) {
  SceneDescription description;
  description.robots.push_back({std::move(robot), std::nullopt, ""});
  description.objects = std::move(objects);
  return description;
}

inline std::shared_ptr<const CollisionScene> sceneOf(std::shared_ptr<const RobotModel> robot,
                                                     std::vector<RigidObject> objects) {
  return CollisionScene::build(described(std::move(robot), std::move(objects)));
}

inline MotionReport checked(const std::shared_ptr<const CollisionScene>& scene,
                            const std::vector<double>& from, const std::vector<double>& to,
                            const MotionSettings& settings = {}, const PlacedBodies& placed = {}) {
  return MotionCheck(scene).check({from, to}, settings, placed);
}

inline std::string hinge(const std::string& name, const std::string& parent,
                         const std::string& child, const std::string& xyz,
                         const std::string& type = "continuous") {
  return joint(name, type, parent, child, xyz, "<axis xyz='0 0 1'/><limit lower='-9' upper='9'/>");
}

/// A thin bar from x = 0 to x = `length`.
inline std::string bar(const std::string& name, double length) {
  const std::string half = std::to_string(0.5 * length);
  return linkWith(name, "<box size='" + std::to_string(length) + " 0.02 0.02'/>",
                  "<origin xyz='" + half + " 0 0'/>");
}

/// Turns about z; 1 m long.
inline std::shared_ptr<const RobotModel> turningBar(const std::string& type = "continuous") {
  return robotFrom(emptyLink("root") + bar("arm", 1.0) +
                   hinge("turn", "root", "arm", "0 0 0", type));
}

/// A cube of 1 m that slides along x.
inline std::shared_ptr<const RobotModel> slidingBox() { return robotFrom(slidingBoxes(1)); }

}  // namespace collision_pairs
