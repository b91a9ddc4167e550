// A mesh prepared for queries: its triangles, their tree, and the nearest point of its surface.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "triangle_distance.h"
#include "triangle_tree.h"
#include "winding_number.h"

namespace collision_pairs {

/// A mesh that is not convex, ready for queries.
struct PreparedMesh {
  std::shared_ptr<const TriangleMesh> triangles;
  TriangleTree tree;
  WindingNumber solid;                       ///< the parts that enclose space
  std::vector<Eigen::Vector3d> part_points;  ///< a point of each part
};

/// The triangle with that index: its corners, its corners moved by a pose, and the triangle with
/// its normal.
Corners cornersOf(const TriangleMesh& mesh, std::uint32_t index);
Corners moved(const Corners& corners, const Eigen::Isometry3d& X);
Triangle triangleOf(const TriangleMesh& mesh, std::uint32_t index);
/// A triangle as a convex shape that refers to its corners.
ConvexCore cornersCore(const Corners& corners);

/// The point of the surface that is nearest to a point, in the mesh's frame. At least one triangle.
/// Cost: O(log n) near the surface, up to O(n) far from a round one; allocates nothing.
Eigen::Vector3d closestOnMesh(const PreparedMesh& mesh, const Eigen::Vector3d& point);

/// The same for the part of the surface below node `root` of the tree, if it is within `within`
/// metres.
std::optional<Eigen::Vector3d> closestOnPart(const PreparedMesh& mesh, std::uint32_t root,
                                             const Eigen::Vector3d& point, double within);

}  // namespace collision_pairs
