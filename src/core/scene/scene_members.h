// All possible members of pairs, before the pairs are determined.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "collision_pairs/scene_description.h"

namespace collision_pairs {

/// A link with geometry, an object or a cloud.
struct SceneMember {
  std::string name;
  const std::vector<Element>* elements;
  bool cylinder_as_capsule = false;
  int robot = -1;          ///< index of the robot that the link is of; -1: it is no robot's link
  int body = -1;           ///< that it moves with, in the robots' merged model; -1: it never moves
  Eigen::Isometry3d X_BM;  ///< pose in that body's frame; in W if it never moves
  const RigidObject* object = nullptr;  ///< null for a link
  bool is_cloud = false;
  Fidelity finest = Fidelity::MESH;
  double padding = 0.0;

  bool isStatic() const { return body < 0; }
};

/// All robots of the description in one model. A single robot without a prefix is
/// its own.
std::shared_ptr<const RobotModel> mergedRobot(const SceneDescription& description);

/// Throws InputError if two links or objects have one name (but for links of the world without
/// geometry), if an object or a setting names a link that is nowhere (the error says which one is
/// closest; a pattern may match nothing, since matching objects may be added later), for a padding
/// that is negative or not finite, and for too few hull vertices. `merged` is mergedRobot().
void checkDescription(const SceneDescription& description, const RobotModel& merged);

/// Sorted by name; the links that the settings ignore are left out. Both arguments must outlive the
/// members. Throws as checkDescription().
std::vector<SceneMember> sceneMembers(const SceneDescription& description,
                                      const RobotModel& merged);

}  // namespace collision_pairs
