// Changes of the scene's objects by update_scene: pure functions over messages.
#pragma once

#include <cstddef>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <collision_pairs/SceneChange.h>
#include <collision_pairs/SceneObject.h>
#include <ros/time.h>

#include "collision_pairs/collision_scene.h"
#include "collision_pairs/scene_description.h"

namespace collision_pairs {

/// By name: the message and the core's object.
struct StoredObject {
  std::shared_ptr<const SceneObject> message;  ///< large, if it has meshes
  RigidObject object;
  Eigen::Isometry3d X_PO = Eigen::Isometry3d::Identity();  ///< before it was rounded to `pose`
  /// What object.X_PO is made of: who reads it in a list has the same to the last bit.
  geometry_msgs::Pose pose;
};
using SceneObjects = std::map<std::string, StoredObject>;

/// Context of a change.
struct UpdateContext {
  std::string world_frame;  ///< of the reports
  /// Pose of `source` in `target` at the stamp (0: the latest). Throws InputError if it is unknown.
  std::function<Eigen::Isometry3d(const std::string& target, const std::string& source,
                                  const ros::Time& stamp)>
      look_up;
  /// Throws InputError unless the robot has the link.
  std::function<void(const std::string& link)> require_link = [](const std::string&) {};
};

/// What changes make of objects, by name: the object, or nothing where it is removed.
using ObjectEdits = std::map<std::string, std::optional<StoredObject>>;

/// The objects that changes add, by the number of the change, but for their poses: reading meshes
/// takes long. Throws as editsBy().
using AddedObjects = std::map<std::size_t, RigidObject>;
AddedObjects readAdded(const std::vector<SceneChange>& changes, const MeshLoader& load_mesh);

/// All changes, in their order. Throws InputError that names the change and the problem; whether
/// touch links exist is checked by the scene.
ObjectEdits editsBy(const std::vector<SceneChange>& changes, const AddedObjects& added,
                    const SceneObjects& objects, const UpdateContext& context);

void apply(const ObjectEdits& edits, SceneObjects& objects);

/// The same for a scene with these objects.
SceneChanges sceneChanges(const ObjectEdits& edits, const SceneObjects& objects);

/// The list for the reply.
std::vector<SceneObject> listed(const SceneObjects& objects, const std::string& world_frame);

/// What was listed. Throws InputError that names the object and the problem; also if its pose is in
/// another frame, or two have the same name. Whether links exist is checked by the scene.
SceneObjects readListed(const std::vector<SceneObject>& list, const std::string& world_frame,
                        const MeshLoader& load_mesh);

}  // namespace collision_pairs
