// All possible members of pairs, collected before the pairs are determined.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "collision_pairs/collision_scene.h"
#include "collision_pairs/scene_description.h"

namespace collision_pairs {

using ObjectPtr = std::shared_ptr<const RigidObject>;
using Objects = std::vector<ObjectPtr>;

/// A link with geometry, which may have been left out, an object or a cloud.
struct SceneMember {
  std::string name;
  const std::vector<Element>* elements;
  const std::vector<std::string>* missing = nullptr;  ///< of a link; null: nothing is
  bool cylinder_as_capsule = false;
  int robot = -1;          ///< index of the link's robot; -1: not a robot's link
  int link = -1;           ///< in the robots' merged model; -1: not a robot's link
  int body = -1;           ///< in the same model; -1: static
  Eigen::Isometry3d X_BM;  ///< pose in that body's frame; in W if static
  ObjectPtr object;        ///< null for a link
  bool is_cloud = false;
  Fidelity finest = Fidelity::MESH;
  double padding = 0.0;

  bool isStatic() const { return body < 0; }
};

/// All robots of the description in one model. A single robot without a prefix is used as it is.
std::shared_ptr<const RobotModel> mergedRobot(const SceneDescription& description);

/// Those of the description, which must outlive them.
Objects objectsOf(const SceneDescription& description);

/// Throws InputError if two links or objects have the same name (except links of the world without
/// geometry), if an object or a setting names an unknown link (the error suggests the closest name;
/// a pattern may match nothing, since matching objects may be added later), for a padding that is
/// negative or not finite, and for too few hull vertices. `objects`: instead of those of the
/// description; `merged` is mergedRobot().
void checkDescription(const SceneDescription& description, const Objects& objects,
                      const RobotModel& merged);

constexpr double LARGEST_MESH = 1e100;  // metres: volumes tell what it encloses

/// Sets the element's pose, fidelity and paddings. `half_padding`: half of the largest padding set
/// for a single pair of the member. Throws std::invalid_argument for a mesh that is too large.
void setPlace(const SceneMember& member, const Element& element, double half_padding,
              SceneElement& made);

/// Whether the rotations of its pose and of those of its shapes are such, but for a client's
/// rounding. Numbers that are not finite pass: the object has no box then, which is refused.
bool areRotations(const RigidObject& object);

/// False for a mesh, or vertices of a convex shape, that is null.
bool hasItsMeshes(const RigidObject& object);

/// The object is not checked, but that the link it is attached to must exist.
SceneMember objectMember(const ObjectPtr& object, const SceneSettings& settings,
                         const RobotModel& merged);

/// Sorted by name; links ignored by the settings are left out. The description and the robot must
/// outlive the members. Arguments and errors as of checkDescription().
std::vector<SceneMember> sceneMembers(const SceneDescription& description, const Objects& objects,
                                      const RobotModel& merged);

}  // namespace collision_pairs
