// Queries to FCL about a pair, and the interpretation of its results. Independent of FCL itself.
#pragma once

#include <optional>

#include <Eigen/Geometry>

#include "collision_pairs/pair_distance.h"

namespace collision_pairs {

/// FCL's tolerances are absolute. Given lengths in units of about a micrometre, it makes far fewer
/// wrong answers and hardly any error of a distance. A power of two, so that nothing is rounded.
constexpr double FCL_UNITS = 0x1p20;  // to the metre

/// Two shapes A and B; lengths in FCL's units.
struct FclQuestion {
  Eigen::Isometry3d X_AB;
  double size;                         ///< of both, and how far apart: what rounding is relative to
  std::optional<double> max_distance;  ///< metres; none: only whether they touch

  /// What trees need not look beyond: a little more than asked, and more than nothing.
  double bound() const;
};

/// The distance of two shapes in FCL's units and where it was found, or -1 where they touch.
struct FclGap {
  double distance = -1.0;
  Eigen::Vector3d p_a, p_b;
  bool settled = true;  ///< false: unknown
  bool touches() const { return distance <= 0.0; }
};

/// What FCL says of a pair.
struct FclAnswer {
  enum class Outcome {
    NONE,      ///< it threw, did not converge or contradicts itself
    APART,     ///< `found` is filled in if a distance was requested, possibly BEYOND
    TOUCHING,  ///< and it has no depth of such a pair
    DEPTH      ///< touching, and `found` says how deep
  };
  FclAnswer(Outcome the_outcome = Outcome::NONE) : outcome(the_outcome) {}
  Outcome outcome;
  PairDistance found;
};

/// How far a distance may be off, of the size of a pair.
constexpr double FCL_CONFIRMED = 1e-7;

/// Of two that are further apart than was asked.
FclAnswer fclBeyond(const FclQuestion& question);
/// Of two that do not touch: NONE where the points are not as far apart as FCL says, or so near
/// that they give no normal.
FclAnswer fclApart(const FclGap& gap, const FclQuestion& question);
/// Of two that touch: the deepest point of A in its frame, the normal from A to B, and how deep.
/// NONE if the normal is invalid.
FclAnswer fclDeep(const Eigen::Vector3d& p_a, const Eigen::Vector3d& nhat_AB_A, double depth);

}  // namespace collision_pairs
