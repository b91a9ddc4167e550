// Prepares an element's rungs of the fidelity ladder.
#pragma once

#include "collision_pairs/collision_scene.h"

namespace collision_pairs {

/// The element with its rungs up to `needed`, each of which encloses the next when grown by its
/// margin; model, body, pose and `dearest` are left to the caller. `max_hull_vertices` as in
/// SceneSettings. Throws std::invalid_argument that names the defect of a shape that is none.
/// Cost: a convex hull for a mesh; a tree of its triangles too where MESH is needed.
SceneElement makeElement(const Shape& shape, Fidelity needed, int max_hull_vertices);

}  // namespace collision_pairs
