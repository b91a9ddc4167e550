// Prepares an element's rungs of the fidelity ladder.
#pragma once

#include <functional>
#include <map>
#include <utility>
#include <vector>

#include "collision_pairs/collision_scene.h"

namespace collision_pairs {

/// The element with its rungs up to `needed`, each of which encloses the next when grown by its
/// margin; model, body, pose and `dearest` are left to the caller. `max_hull_vertices` as in
/// SceneSettings. Throws std::invalid_argument that names the defect of a shape that is none.
/// Cost: a convex hull for a mesh; a tree of its triangles too where MESH is needed.
SceneElement makeElement(const Shape& shape, Fidelity needed, int max_hull_vertices);

/// Makes the elements of a scene. A mesh is prepared once, however many links have it, and meshes
/// are prepared on all cores.
class ElementMaker {
 public:
  explicit ElementMaker(int max_hull_vertices) : max_hull_vertices_(max_hull_vertices) {}

  /// What make() is going to be asked for. `progress` as in SceneSettings.
  void prepare(const std::vector<std::pair<const Shape*, Fidelity>>& wanted,
               const std::function<void(std::size_t, std::size_t)>& progress);

  SceneElement make(const Shape& shape, Fidelity needed);

 private:
  using Key = std::pair<const TriangleMesh*, Fidelity>;

  int max_hull_vertices_;
  std::map<Key, SceneElement> of_meshes_;
};

}  // namespace collision_pairs
