// Signed distance of two solids, and its certainty.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>

#include <Eigen/Core>

namespace collision_pairs {

/// How PairDistance::distance relates to the true signed distance.
enum class Certainty {
  EXACT,       ///< the distance itself, with the accuracy listed in docs/accuracy.md
  TOLERATED,   ///< certainly apart; the true distance is larger by at most the tolerance
  BEYOND,      ///< further apart than max_distance; `distance` is a lower bound
  BOUND,       ///< certainly in contact; |distance| is an upper bound of the depth
  DEGRADED,    ///< the first method failed; `distance` is a lower bound of the signed distance
  UNFINISHED,  ///< only in reports of checks whose time was spent; `distance` is a lower bound
};

/// The accuracy to which the distance of two disjoint shapes has to be known.
struct Accuracy {
  /// Metres, >= 0: a search may end as soon as the certified interval of the distance is no wider.
  /// 0: exact.
  double tolerance = 0.0;
  /// Metres, >= 0: whether the distance is below or above this value is always certain. (The
  /// padding of the pair.)
  double contact_distance = 0.0;

  bool isExact() const { return !(tolerance > 0.0); }
  /// If the two are known to be no further apart than `upper`: the distance from which on the
  /// search may ignore candidates.
  double farEnough(double upper) const {
    return std::min(upper, std::max(upper - tolerance, contact_distance));
  }
};

/// The result for shapes A and B, measured and expressed in A's frame.
struct PairDistance {
  double distance = std::numeric_limits<double>::infinity();  ///< metres; <= 0: in contact, -depth
  Eigen::Vector3d p_ACa = Eigen::Vector3d::Zero();            ///< witness point on A
  Eigen::Vector3d p_ACb = Eigen::Vector3d::Zero();            ///< witness point on B
  Eigen::Vector3d nhat_AB_A = Eigen::Vector3d::UnitZ();       ///< unit normal, from A to B
  Certainty certainty = Certainty::EXACT;
  bool by_hulls = false;  ///< with a non-convex mesh: settled without its triangles
  /// Witness points and normal are meaningless when BEYOND.
  bool touches() const { return distance <= 0.0; }
};

/// Vertices of two hulls A and B between which their closest points lie: one to three of each, by
/// increasing index, then negative numbers.
struct ClosestVertices {
  std::array<std::int32_t, 3> a{-1, -1, -1}, b{-1, -1, -1};

  bool operator==(const ClosestVertices& other) const { return a == other.a && b == other.b; }
};

}  // namespace collision_pairs
