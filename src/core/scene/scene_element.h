// Prepares an element's rungs of the fidelity ladder.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <tuple>
#include <unordered_map>
#include <utility>
#include <vector>

#include "collision_pairs/collision_scene.h"
#include "prepared_shape.h"

namespace collision_pairs {

/// The element with its rungs up to `needed`, each of which, enlarged by its margin, encloses the
/// next; model, body, pose and `finest` are set by the caller. `max_hull_vertices` and `method` as
/// in SceneSettings. Throws std::invalid_argument that describes the defect of an invalid shape.
/// `spheres`: those of the shape if another element has them already; null: new ones.
/// Cost: a convex hull for a mesh; and a tree of its triangles if MESH is needed.
SceneElement makeElement(const Shape& shape, Fidelity needed, int max_hull_vertices,
                         NarrowPhaseMethod method,
                         std::shared_ptr<const FineSpheres> spheres = nullptr);

inline const Prepared& preparedOf(const Rung& rung) {
  return static_cast<const Prepared&>(*rung.shape);
}
/// The shape at its finest.
inline const Prepared& preparedOf(const SceneElement& element) {
  return preparedOf(element.rung(Fidelity::MESH));
}

/// Makes the spheres of all meshes, on all cores; nothing for those that have been made.
void makeSpheres(const std::vector<SceneElement>& elements);

/// Makes the elements of one scene.
class PreparedElements {
 public:
  SceneElement make(const Shape& shape, Fidelity needed) const;

 private:
  friend class ElementMaker;
  int max_hull_vertices_ = 0;
  NarrowPhaseMethod method_ = NarrowPhaseMethod::NATIVE;
  std::map<std::pair<const TriangleMesh*, Fidelity>, std::shared_ptr<const SceneElement>> meshes_;
};

/// Prepares the meshes of scenes, on all cores: each content once, however many links, scenes and
/// threads use it. Thread safe.
class ElementMaker {
 public:
  PreparedElements prepare(const std::vector<std::pair<const Shape*, Fidelity>>& wanted,
                           const SceneSettings& settings);

 private:
  using MeshPtr = std::shared_ptr<const TriangleMesh>;
  /// One for meshes of the same content.
  struct Content {
    MeshPtr mesh;
    std::shared_ptr<const FineSpheres> spheres;
  };
  /// Of a mesh, by address: it holds the mesh, so that the address is not reused.
  struct Known {
    MeshPtr mesh;
    std::shared_ptr<const Content> content;
    std::uint64_t last_round = 0;
  };
  struct Prepared {
    std::shared_ptr<const Content> content;  // keeps the address in the key
    std::mutex making;
    bool is_made = false;  ///< guarded by `making`
    SceneElement element;
    std::uint64_t last_round = 0;
  };
  /// Content, needed, max_hull_vertices, method.
  using Key = std::tuple<const Content*, Fidelity, int, NarrowPhaseMethod>;
  struct Job {
    const Shape* shape;
    Fidelity needed;
    std::shared_ptr<const Content> content;
    std::shared_ptr<Prepared> prepared;
  };

  std::shared_ptr<const Content> contentOf(const MeshPtr& mesh);
  void make(std::vector<Job> jobs, const SceneSettings& settings);
  void drop();

  std::mutex mutex_;  // guards all but what is being made
  std::uint64_t round_ = 0;
  std::unordered_map<const TriangleMesh*, Known> by_address_;
  std::unordered_multimap<std::uint64_t, std::shared_ptr<const Content>> by_hash_;
  std::map<Key, std::shared_ptr<Prepared>> prepared_;
};

}  // namespace collision_pairs
