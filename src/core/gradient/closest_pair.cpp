#include "closest_pair.h"

#include <algorithm>
#include <limits>

namespace collision_pairs {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;

constexpr int MAX_ROUNDS = 12;
constexpr double ROUNDING = 4.0 * std::numeric_limits<double>::epsilon();
constexpr double SAME_DIRECTION = 1e-3;  // relative: steps that differ less are not independent

Vector3d nearestOn(const PreparedShape& shape, const Vector3d& p, NarrowPhase& narrow_phase) {
  static const std::shared_ptr<const PreparedShape> POINT = prepareShape(Sphere{0.0});
  const Isometry3d X(Eigen::Translation3d{p});
  return narrow_phase.distance(shape, *POINT, X, std::numeric_limits<double>::infinity()).p_ACa;
}

/// Extrapolates the limit from the last two rounds.
class Extrapolation {
 public:
  /// A round led from `from` to `to`. Returns the extrapolated point.
  Vector3d next(const Vector3d& from, const Vector3d& to) {
    const Vector3d step = to - from;
    Vector3d limit = to;
    if (known_ > 0) {
      Eigen::Matrix<double, 3, Eigen::Dynamic, 0, 3, 2> steps(3, known_), ends(3, known_);
      for (int i = 0; i < known_; ++i) {
        steps.col(i) = step - steps_[i];
        ends.col(i) = to - ends_[i];
      }
      auto solver = steps.colPivHouseholderQr();
      solver.setThreshold(SAME_DIRECTION);
      limit -= ends * solver.solve(step);
    }
    steps_[1] = steps_[0], ends_[1] = ends_[0];
    steps_[0] = step, ends_[0] = to;
    known_ = std::min(known_ + 1, 2);
    return limit.allFinite() ? limit : to;
  }

 private:
  Vector3d steps_[2], ends_[2];
  int known_ = 0;
};

}  // namespace

ClosestPair closestPairNear(const PreparedShape& A, const PreparedShape& B, const Isometry3d& X_AB,
                            const Vector3d& p_ACb, NarrowPhase& narrow_phase) {
  const Isometry3d X_BA = X_AB.inverse();
  Extrapolation extrapolation;
  ClosestPair found{Vector3d::Zero(), p_ACb};
  Vector3d from = p_ACb;
  for (int round = 0; round < MAX_ROUNDS; ++round) {
    found.p_ACa = nearestOn(A, from, narrow_phase);
    found.p_ACb = X_AB * nearestOn(B, X_BA * found.p_ACa, narrow_phase);
    if ((found.p_ACb - from).norm() <= ROUNDING * (from.norm() + X_AB.translation().norm())) break;
    from = extrapolation.next(from, found.p_ACb);
  }
  return found;
}

}  // namespace collision_pairs
