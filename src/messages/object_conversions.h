// Converts scene objects of messages into the core's. Pure functions.
#pragma once

#include <collision_pairs/SceneObject.h>

#include "collision_pairs/scene_description.h"

namespace collision_pairs {

/// Everything except its pose, which needs frames: X_PO is not set. `load_mesh` fetches
/// mesh_resources. Throws InputError that names the shape and the problem.
RigidObject toObject(const SceneObject& message, const MeshLoader& load_mesh);

}  // namespace collision_pairs
