// A scene as a message, and back.
#pragma once

#include <collision_pairs/Scene.h>

#include "scene_store.h"

namespace collision_pairs {

/// Of a scene that there is. O(its texts and objects): takes milliseconds for thousands of objects.
Scene toMessage(const StoredScene& scene);

/// The parameters of the scene; its frame is their fixed_frame. Meshes are read by `load_mesh` when
/// a job needs them. `warn` is told of ineffective content. Throws InputError that names the
/// scene's revision, the part of the message and the problem.
SceneParameters parametersOf(const Scene& message, const MeshLoader& load_mesh, const Warn& warn);

/// Its objects, meshes included. Throws InputError as parametersOf(); also if a pose is neither in
/// the scene's frame nor in that of the link that the object is attached to.
SceneObjects objectsOf(const Scene& message, const MeshLoader& load_mesh);

}  // namespace collision_pairs
