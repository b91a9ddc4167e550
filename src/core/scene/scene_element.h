// Prepares an element's rungs of the fidelity ladder.
#pragma once

#include <cstdint>
#include <map>
#include <tuple>
#include <utility>
#include <vector>

#include "collision_pairs/collision_scene.h"

namespace collision_pairs {

/// The element with its rungs up to `needed`, each of which encloses the next when grown by its
/// margin; model, body, pose and `finest` are left to the caller. `max_hull_vertices` and `method`
/// as in SceneSettings. Throws std::invalid_argument that names the defect of a shape that is none.
/// Cost: a convex hull for a mesh; a tree of its triangles too where MESH is needed.
SceneElement makeElement(const Shape& shape, Fidelity needed, int max_hull_vertices,
                         NarrowPhaseMethod method);

/// Makes the elements of scenes. A mesh is prepared once, however many links and scenes have it,
/// and meshes are prepared on all cores.
class ElementMaker {
 public:
  /// What make() is going to be asked for until the next call.
  void prepare(const std::vector<std::pair<const Shape*, Fidelity>>& wanted,
               const SceneSettings& settings);

  SceneElement make(const Shape& shape, Fidelity needed) const;

 private:
  /// Those of the mesh with any settings, or new ones.
  std::shared_ptr<const FineSpheres> spheresOf(const Shape& mesh) const;

  // Mesh, needed, max_hull_vertices, method.
  using Key = std::tuple<const TriangleMesh*, Fidelity, int, NarrowPhaseMethod>;

  /// Holds its mesh, so that no other can come to lie at the same address.
  struct Prepared {
    SceneElement element;
    std::uint64_t last_round = 0;
  };

  int max_hull_vertices_ = 0;
  NarrowPhaseMethod method_ = NarrowPhaseMethod::NATIVE;
  std::uint64_t round_ = 0;
  std::map<Key, Prepared> of_meshes_;
};

}  // namespace collision_pairs
