// How far apart two solids are, or how deep in each other, and what that answer is worth.
#pragma once

#include <algorithm>
#include <limits>

#include <Eigen/Core>

namespace collision_pairs {

/// What a PairDistance's number is worth.
enum class Certainty {
  EXACT,       ///< the distance itself, to the accuracy that the table of pairs states
  TOLERATED,   ///< apart for certain; the distance is no less, and more by no more than the
               ///< tolerance
  BEYOND,      ///< further apart than was asked; `distance` is a lower bound of the distance
  BOUND,       ///< in contact for certain; |distance| is an upper bound of the depth
  DEGRADED,    ///< the first method failed; `distance` is a lower bound of the signed distance
  UNFINISHED,  ///< never from here: a check's time was spent; `distance` is a lower bound as well
};

/// How near the distance of two shapes that are apart has to be known.
struct Accuracy {
  /// Metres, >= 0: a search may end as soon as what is certain of the distance is an interval no
  /// wider. 0: the distance itself.
  double tolerance = 0.0;
  /// Metres, >= 0: on which side of it the distance lies is always certain (a padding that is
  /// kept).
  double contact_distance = 0.0;

  bool isExact() const { return !(tolerance > 0.0); }
  /// Where the two are known to be no further apart than `upper`: the distance from which on
  /// nothing nearer is looked for.
  double farEnough(double upper) const {
    return std::min(upper, std::max(upper - tolerance, contact_distance));
  }
};

/// The answer for shapes A and B, measured and expressed in A's frame.
struct PairDistance {
  double distance = std::numeric_limits<double>::infinity();  ///< metres; <= 0 touches, -depth
  Eigen::Vector3d p_ACa = Eigen::Vector3d::Zero();            ///< witness point on A
  Eigen::Vector3d p_ACb = Eigen::Vector3d::Zero();            ///< witness point on B
  Eigen::Vector3d nhat_AB_A = Eigen::Vector3d::UnitZ();       ///< unit normal, from A to B
  Certainty certainty = Certainty::EXACT;
  bool by_hulls = false;  ///< of a mesh that is not convex: its triangles were not needed
  /// Witness points and normal are meaningless when BEYOND.
  bool touches() const { return distance <= 0.0; }
};

}  // namespace collision_pairs
