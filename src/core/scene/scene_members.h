// Everything that can be in a pair, before it is known which pairs there are.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "collision_pairs/scene_description.h"

namespace collision_pairs {

/// A link with geometry or an object.
struct SceneMember {
  std::string name;
  const std::vector<Element>* elements;
  bool cylinder_as_capsule = false;
  int robot = -1;          ///< index of the robot that the link is of; -1: it is no robot's link
  int body = -1;           ///< that it moves with, in the robots' merged model; -1: it never moves
  Eigen::Isometry3d X_BM;  ///< pose in that body's frame; in W if it never moves
  const RigidObject* object = nullptr;  ///< null for a link
  Fidelity dearest = Fidelity::MESH;
  double padding = 0.0;

  bool isStatic() const { return body < 0; }
};

/// All robots of the description in one model. A single robot without a prefix is
/// its own.
std::shared_ptr<const RobotModel> mergedRobot(const SceneDescription& description);

/// Sorted by name; the links that the settings ignore are left out. `merged` is mergedRobot(). Both
/// must outlive the members. Throws InputError if two have the same name, if an object hangs on a
/// link that no robot has, or if the settings name a link that is nowhere or a size that is none.
std::vector<SceneMember> sceneMembers(const SceneDescription& description,
                                      const RobotModel& merged);

}  // namespace collision_pairs
