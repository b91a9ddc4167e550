// Which parts of a mesh are near a box, and how near?
#pragma once

#include <array>
#include <utility>
#include <vector>

#include <Eigen/Geometry>

#include "box_gap.h"
#include "collision_pairs/aabb.h"
#include "collision_pairs/narrow_phase.h"
#include "prepared_mesh.h"

namespace collision_pairs {

/// For a caller that queries one mesh with many boxes that lie in larger ones. The surface near the
/// larger one is kept as a range of nodes of the triangles' tree, with which the search for the
/// smaller ones begins. All boxes are aligned with W; metres.
///
/// All bounds are off by no more than PairLadder::errorOfSurface().
class SurfaceQuery {
 public:
  /// Of the nodes kept so far.
  struct Nodes {
    std::uint32_t begin, end;
  };

  /// The shape is a mesh that is not convex, and must live until the last query. Returns the node
  /// that holds all of it.
  Nodes begin(const PreparedShape& mesh, const Eigen::Isometry3d& X_WM);

  /// Of the surface below `larger`, keeps the nodes that are not further from the box than `reach`,
  /// none of them much larger. Returns a lower bound of the distance of the surface below `larger`;
  /// more than `reach` if nothing is kept. Cost: some 20 ns a node.
  double keepNear(const Aabb& box, double reach, const Nodes& larger, Nodes& near);

  /// The same for each of up to BOX_LANES boxes of one size, the nearest nodes first and none
  /// smaller than they were. Costs little more than for one.
  FourGaps keepNear(const std::array<Aabb, BOX_LANES>& boxes, std::size_t count, double reach,
                    const Nodes& larger, std::array<Nodes, BOX_LANES>& near);

  /// The distance of the surface below `nodes` from the box, to within `tolerance` where the two
  /// are apart; `lower` is more than `reach`, and no more is known, if the distance is.
  DistanceBounds distance(const Aabb& box, double reach, double tolerance, const Nodes& nodes);

  /// True if the mesh encloses the point.
  bool holds(const Eigen::Vector3d& p_W) const;

 private:
  struct Query {
    OrientedBox box;       ///< in M
    Eigen::Vector3d p_BM;  ///< from its centre to M, in W
    double reach;
    double tolerance = 0.0;
  };
  Query queryFor(const Aabb& box, double reach) const;
  double keepNear(const Query& query, std::uint32_t node);
  /// `best` has the least of all lower bounds, and the least upper one.
  void improve(const Query& query, std::uint32_t node, DistanceBounds& best);
  DistanceBounds distanceOfTriangle(const Query& query, std::uint32_t triangle, double limit) const;

  const PreparedShape* shape_ = nullptr;
  const PreparedMesh* mesh_ = nullptr;
  Eigen::Isometry3d X_WM_;
  struct NearNode {
    std::uint32_t node;
    double gap;  ///< metres: a lower bound of its distance from the box it was kept for
  };
  std::vector<NearNode> nodes_;
  std::vector<std::pair<std::uint32_t, FourGaps>> tried_;  ///< nodes, and squared gaps of boxes
  static constexpr std::uint32_t NONE = 0xffffffff;
  std::uint32_t nearest_ = NONE;      ///< the triangle that was, to the last box: tried first
  std::uint32_t tried_first_ = NONE;  ///< which one was
};

}  // namespace collision_pairs
