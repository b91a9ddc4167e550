// Scene objects of messages as the core has them. Pure functions.
#pragma once

#include <collision_pairs/SceneObject.h>

#include "collision_pairs/scene_description.h"

namespace collision_pairs {

/// Everything but its pose, which needs frames: X_PO is left alone. `load_mesh` fetches
/// mesh_resources. Throws InputError that says which shape is wrong, and how.
RigidObject toObject(const SceneObject& message, const MeshLoader& load_mesh);

}  // namespace collision_pairs
