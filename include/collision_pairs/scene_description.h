// The description of a scene: robots, objects, clouds and rules. Input of CollisionScene::build().
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
  /// Disables pairs of links of this robot only. Without an SRDF, adjacent links are not checked
  /// (RobotModel::adjacentLinks).
  std::optional<Srdf> srdf;
  /// Prefix of its links, joints and groups: with "left", link "elbow" is "left/elbow", as with
  /// tf_prefix.
  std::string prefix;
  /// Pose of its root in W, used if poses come from joint positions alone.
  Eigen::Isometry3d X_WR = Eigen::Isometry3d::Identity();
};

/// A body that is not a link: static, or attached to a link of a robot.
struct RigidObject {
  std::string name;
  std::vector<Element> elements;  ///< with X_LE the pose in the object's frame O
  std::string attached_link;      ///< with its robot's prefix; empty: static
  /// Its pose in the world frame W, or in the frame of attached_link.
  Eigen::Isometry3d X_PO = Eigen::Isometry3d::Identity();
  /// Links and objects that it is not checked against, in addition to the link that it is attached
  /// to and to objects attached to the same rigid body.
  std::vector<std::string> touch_links;
  double padding = 0.0;  ///< metres, >= 0; as SceneSettings::padding
};

/// A floor: everything below z = height (metres) in W is solid.
RigidObject floorAt(double height, std::vector<std::string> touch_links);

/// A point cloud as one static object: its only element, a cube, is placed at each voxel that a
/// check is given (BodyPoses::voxels). voxel_size in metres, > 0.
RigidObject cloudOf(std::string name, double voxel_size, std::vector<std::string> touch_links);

struct SceneDescription {
  std::vector<SceneRobot> robots;
  /// Static, with its joints at zero and its root at the origin of W. May be null.
  std::shared_ptr<const RobotModel> world;
  std::vector<RigidObject> objects;
  std::vector<RigidObject> clouds;  ///< made by cloudOf()
  Restriction restriction;
  SceneSettings settings;
  /// Whether links of robots are checked against each other; false: only against world, objects and
  /// clouds.
  bool check_self = true;
};

}  // namespace collision_pairs
