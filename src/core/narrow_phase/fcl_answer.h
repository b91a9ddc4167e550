// Queries to FCL about a pair, and the interpretation of its results. Independent of FCL itself.
#pragma once

#include <optional>

#include <Eigen/Geometry>

#include "collision_pairs/pair_distance.h"

namespace collision_pairs {

/// FCL's tolerances are absolute. With lengths in units of about a micrometre it gives far fewer
/// wrong answers and distances with hardly any error. A power of two, so that the conversion does
/// not round.
constexpr double FCL_UNITS = 0x1p20;  // per metre

/// Two shapes A and B; lengths in FCL's units.
struct FclQuestion {
  Eigen::Isometry3d X_AB;
  double size;                         ///< of both plus their separation; scales rounding
  std::optional<double> max_distance;  ///< metres; without it, only whether they touch

  /// Search limit for trees: more than the given distance by the rounding of their boxes.
  double bound() const;
};

/// The distance of two shapes in FCL's units and its witness points, or -1 if they touch.
struct FclGap {
  double distance = -1.0;
  Eigen::Vector3d p_a, p_b;
  bool settled = true;  ///< false: no result
  bool touches() const { return distance <= 0.0; }
};

/// FCL's result for a pair.
struct FclAnswer {
  enum class Outcome {
    NONE,      ///< it threw, did not converge or contradicts itself
    APART,     ///< `found` is filled in if a distance was requested, possibly BEYOND
    TOUCHING,  ///< FCL gives no depth for such a pair
    DEPTH      ///< touching; `found` has the depth
  };
  FclAnswer(Outcome the_outcome = Outcome::NONE) : outcome(the_outcome) {}
  Outcome outcome;
  PairDistance found;
};

/// Largest error of a distance, relative to the size of a pair.
constexpr double FCL_CONFIRMED = 1e-7;

/// For two that are further apart than requested.
FclAnswer fclBeyond(const FclQuestion& question);
/// For two that do not touch: NONE if the distance of the points differs from FCL's, or they are
/// too near to give a normal.
FclAnswer fclApart(const FclGap& gap, const FclQuestion& question);
/// For two that touch: the deepest point of A in its frame, the normal from A to B, and the depth.
/// NONE if the normal is invalid.
FclAnswer fclDeep(const Eigen::Vector3d& p_a, const Eigen::Vector3d& nhat_AB_A, double depth);

}  // namespace collision_pairs
