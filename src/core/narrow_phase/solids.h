// Queries of two solids that need no triangles: by their hulls, and containment.
#pragma once

#include <functional>

#include <Eigen/Geometry>

#include "convex_distance.h"
#include "prepared_shape.h"

namespace collision_pairs {

/// The hull contains the solid, so the distance of the hulls is a lower bound of that of the
/// solids. If both closest points of the hulls are points of the solids, it is the exact distance.
/// Most links are nearly convex on the outside, so few pairs need their triangles.
struct HullBounds {
  enum class Outcome {
    BEYOND,   ///< further apart than requested; `hulls` holds the lower bound
    SETTLED,  ///< `hulls` is the result
    APART,    ///< the solids are disjoint, and no further apart than `upper`
    OPEN      ///< the hulls overlap, or nearly: undecided
  };
  Outcome outcome = Outcome::OPEN;
  PairDistance hulls;
  double lower = 0.0;  ///< metres; for APART a lower bound of the distance
  double upper = 0.0;  ///< metres; the distance of two points of the solids …
  Eigen::Vector3d p_ACa = Eigen::Vector3d::Zero();  ///< … which are these, in A's frame
  Eigen::Vector3d p_ACb = Eigen::Vector3d::Zero();
  CoreOverlap overlap;  ///< of the hulls, if they overlap
};

/// At least one of the two is a mesh that is not convex; neither is a half-space. What is no more
/// than `band` metres apart is OPEN.
/// Cost: one GJK query, and for each mesh the point of its surface nearest to the closest point:
/// one to three microseconds.
HullBounds boundsFromHulls(const Prepared& A, const Prepared& B, const Eigen::Isometry3d& X_AB,
                           double max_distance, double band, ClosestVertices* between = nullptr);

/// True if the convex hulls are more than `band` metres apart; `nhat_AB_A` is then the normal of a
/// plane between them, or 0.
bool hullsMiss(const Prepared& A, const Prepared& B, const Eigen::Isometry3d& X_AB, double band,
               Eigen::Vector3d* nhat_AB_A = nullptr);

/// True if the point is certainly outside the hull.
bool hullMisses(const Prepared& A, const Eigen::Vector3d& p_AQ);

/// True if the point is in one of the solid parts of the mesh A. Cost: 0.2 us outside of the
/// hull, else as WindingNumber::holds().
bool meshHoldsPoint(const Prepared& A, const Eigen::Vector3d& p_AQ);

/// True if a part of the mesh B, or all of it, is inside the mesh A.
bool meshHoldsMesh(const Prepared& A, const Prepared& B, const Eigen::Isometry3d& X_AB);

/// True if a vertex p_A of the mesh B was found in one of the solid parts of the mesh A, with more
/// than moves(p_A) metres to its surface: then the two stay in contact if it moves no further than
/// that. Looks at up to 4,000 vertices and tries the 24 that the box of A holds deepest.
bool meshHoldsVertexDeep(const Prepared& A, const Prepared& B, const Eigen::Isometry3d& X_AB,
                         const std::function<double(const Eigen::Vector3d&)>& moves);

/// True if the convex B is inside the mesh A.
bool meshHoldsConvex(const Prepared& A, const Prepared& B, const Eigen::Isometry3d& X_AB);

}  // namespace collision_pairs
