// What a scene is made of, before anything is prepared for it.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "collision_pairs/robot_model.h"
#include "collision_pairs/scene_settings.h"
#include "collision_pairs/srdf.h"

namespace collision_pairs {

struct SceneRobot {
  std::shared_ptr<const RobotModel> model;
  /// Switches off pairs of links of this robot, and no others. Without one, adjacent
  /// links are not checked (RobotModel::adjacentLinks).
  std::optional<Srdf> srdf;
  /// "left" makes link "elbow" "left/elbow", as tf_prefix does; joints and groups likewise.
  std::string prefix;
  /// Where its root stands in W when poses come from joint positions alone.
  Eigen::Isometry3d X_WR = Eigen::Isometry3d::Identity();
};

/// A body that is no link: static, or attached to a link of a robot.
struct RigidObject {
  std::string name;
  std::vector<Element> elements;  ///< their X_LE is the pose in the object's frame O
  std::string attached_link;      ///< with its robot's prefix; empty: it is static
  /// Its pose in the world frame W, or in the frame of attached_link.
  Eigen::Isometry3d X_PO = Eigen::Isometry3d::Identity();
  /// Links and objects that it is not checked against. The link that it is attached to, and what
  /// is attached to links rigidly fixed to that, are so anyway.
  std::vector<std::string> touch_links;
  double padding = 0.0;  ///< metres, >= 0; as SceneSettings::padding
};

/// A floor: everything below z = height in W.
RigidObject floorAt(double height, std::vector<std::string> touch_links);

/// A cloud of points as one static object: its one element, a cube, is at each voxel that a check
/// is told to be occupied (BodyPoses::voxels). voxel_size in metres, > 0.
RigidObject cloudOf(std::string name, double voxel_size, std::vector<std::string> touch_links);

struct SceneDescription {
  std::vector<SceneRobot> robots;
  /// Static, with its joints at zero and its root at the origin of W. May be null.
  std::shared_ptr<const RobotModel> world;
  std::vector<RigidObject> objects;
  std::vector<RigidObject> clouds;  ///< made by cloudOf()
  Restriction restriction;
  SceneSettings settings;
  /// Whether links of robots are checked against each other; false: only against what is no link.
  bool check_self = true;
};

}  // namespace collision_pairs
