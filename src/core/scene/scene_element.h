// Prepares an element's rungs of the fidelity ladder.
#pragma once

#include <cstdint>
#include <map>
#include <tuple>
#include <utility>
#include <vector>

#include "collision_pairs/collision_scene.h"

namespace collision_pairs {

/// The element with its rungs up to `needed`, each of which, enlarged by its margin, encloses the
/// next; model, body, pose and `finest` are set by the caller. `max_hull_vertices` and `method` as
/// in SceneSettings. Throws std::invalid_argument that describes the defect of an invalid shape.
/// `spheres`: those of the shape if another element has them already; null: new ones.
/// Cost: a convex hull for a mesh; and a tree of its triangles if MESH is needed.
SceneElement makeElement(const Shape& shape, Fidelity needed, int max_hull_vertices,
                         NarrowPhaseMethod method,
                         std::shared_ptr<const FineSpheres> spheres = nullptr);

/// Makes the spheres of all meshes, on all cores; nothing for those that have been made.
void makeSpheres(const std::vector<SceneElement>& elements);

/// Makes the elements of scenes. A mesh is prepared once, however many links and scenes use it, and
/// meshes are prepared on all cores.
class ElementMaker {
 public:
  /// Prepares what make() will need until the next call.
  void prepare(const std::vector<std::pair<const Shape*, Fidelity>>& wanted,
               const SceneSettings& settings);

  SceneElement make(const Shape& shape, Fidelity needed) const;

 private:
  /// Those of the mesh with any settings, or new ones.
  std::shared_ptr<const FineSpheres> spheresOf(const Shape& mesh) const;

  // Mesh, needed, max_hull_vertices, method.
  using Key = std::tuple<const TriangleMesh*, Fidelity, int, NarrowPhaseMethod>;

  /// Holds the mesh, so that its address is not reused.
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
