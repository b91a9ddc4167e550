// A tree of oriented boxes over the triangles of a mesh, and the gap between two such boxes.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "collision_pairs/shape.h"
#include "convex_core.h"

namespace collision_pairs {

/// A box with its own axes: centre and axes (the columns of R) in the frame of its owner.
struct OrientedBox {
  Eigen::Matrix3d R = Eigen::Matrix3d::Identity();
  Eigen::Vector3d center = Eigen::Vector3d::Zero();
  Eigen::Vector3d half = Eigen::Vector3d::Zero();

  double size() const { return half.maxCoeff(); }
};

/// Square of a lower bound of the distance of two boxes: the larger of the distances between each
/// box and the other's enclosing box along its axes. 0 does not mean that they meet.
/// b is first moved by R and p into a's frame. Cost: about 30 ns.
double squaredBoxGap(const OrientedBox& a, const OrientedBox& b, const Eigen::Matrix3d& R,
                     const Eigen::Vector3d& p);

/// Gottschalk, Lin, Manocha, "OBBTree" (1996): boxes along the principal axes of the triangles'
/// area, split at the mean of the centroids along the longest axis. One triangle per leaf.
///
/// Some nodes are the roots of patches: the largest ones of at most PATCH_TRIANGLES triangles. The
/// convex hull of a patch is close to its surface where the mesh is smooth, so it bounds a
/// distance far better than a box, and often is it.
class TriangleTree {
 public:
  static constexpr std::uint32_t PATCH_TRIANGLES = 32;
  static constexpr std::uint32_t NO_PATCH = 0xffffffff;

  struct Node {
    OrientedBox box;      // grown by a few units in the last place
    std::uint32_t child;  // the first of two that stand side by side; of a leaf: the triangle
    bool leaf;
    std::uint32_t patch = NO_PATCH;
    bool above_patches = false;
    bool isPatch() const { return patch != NO_PATCH; }
  };

  TriangleTree() = default;
  /// Cost: O(n log n); a few microseconds per triangle.
  explicit TriangleTree(const TriangleMesh& mesh);

  const Node& node(std::uint32_t i) const { return nodes_[i]; }
  bool empty() const { return nodes_.empty(); }

  /// The corners of a patch, as a convex shape that refers to them.
  ConvexCore patchCore(std::uint32_t patch) const;

 private:
  struct Builder;
  struct Patch {
    std::uint32_t first_point;
    std::uint32_t nb_points;
    Eigen::Vector3d center;
    double extent;
  };
  std::vector<Node> nodes_;  // the root is node 0
  std::vector<Patch> patches_;
  std::vector<Eigen::Vector3d> patch_points_;
};

}  // namespace collision_pairs
