// Distance and contact between meshes, and between a mesh and a convex shape: surfaces by their
// trees of oriented boxes, insides by winding numbers.
#pragma once

#include <array>
#include <limits>
#include <vector>

#include "prepared_shape.h"
#include "slab_bounds.h"
#include "triangle_distance.h"

namespace collision_pairs {

/// The closest points of two surfaces, in the first one's frame.
struct SurfaceGap {
  double distance = std::numeric_limits<double>::infinity();  ///< 0 if they meet
  bool beyond = true;  ///< nothing within the limit; `distance` is a lower bound
  Eigen::Vector3d p_ACa = Eigen::Vector3d::Zero();
  Eigen::Vector3d p_ACb = Eigen::Vector3d::Zero();
  bool by_hulls = false;  ///< of two patches: then there is a normal instead of two triangles
  Eigen::Vector3d nhat_AB_A = Eigen::Vector3d::Zero();
  std::uint32_t triangle_a = 0;
  std::uint32_t triangle_b = 0;
};

/// Walks pairs of boxes nearest first. Holds the memory for that walk only.
class MeshQuery {
 public:
  /// Distance of the surfaces of two meshes. What is further apart than max_distance (metres) is
  /// cut off. nhat_AB_A, if given, is the normal between the hulls: it makes the search shorter and
  /// does not change the answer. Cost: O(log n) far apart, up to O(n) for large parallel surfaces.
  SurfaceGap meshMesh(const PreparedMesh& A, const PreparedMesh& B, const Eigen::Isometry3d& X_AB,
                      double max_distance, const Eigen::Vector3d* nhat_AB_A = nullptr);

  /// Do the surfaces of two meshes meet? Cost: O(log n) where their boxes miss each other or the
  /// first triangles tried meet, up to O(n) for surfaces that nest.
  bool surfacesMeet(const PreparedMesh& A, const PreparedMesh& B, const Eigen::Isometry3d& X_AB);

  /// Distance of the surface of mesh A and the solid B. Stops at the first triangle that meets B.
  SurfaceGap meshConvex(const PreparedMesh& A, const Prepared& B, const Eigen::Isometry3d& X_AB,
                        double max_distance);

  /// Is a part of B, or all of it, inside A? For surfaces that do not meet.
  static bool meshHoldsMesh(const PreparedMesh& A, const PreparedMesh& B,
                            const Eigen::Isometry3d& X_AB);

 private:
  struct Entry {
    std::uint32_t a, b;
    double squared_gap;
  };
  // Children of the node that was split, A's if `of_a`, each with the parent's other node; none
  // whose gap is above the limit.
  void pushNearestLast(const Entry& parent, bool of_a, const TriangleTree::Node& split,
                       const FourGaps& gaps, double limit);

  SlabBounds slabs_;
  std::vector<Entry> stack_;

  struct NodePair {
    std::uint32_t a, b;
  };
  void pushOverlaps(const NodePair& parent, bool of_a, const TriangleTree::Node& split,
                    const FourGaps& gaps, double limit);

  std::vector<NodePair> overlaps_;
  std::size_t nb_overlaps_ = 0;
};

/// The triangle with that index, and a triangle as a convex shape that refers to its corners.
Triangle triangleOf(const TriangleMesh& mesh, std::uint32_t index);
using Corners = std::array<Eigen::Vector3d, 3>;
ConvexCore cornersCore(const Corners& corners);

}  // namespace collision_pairs
