#include "sphere_distance.h"

#include <algorithm>
#include <limits>

#include "closed_forms.h"

namespace collision_pairs {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;

constexpr double NEARLY_LEAST = 0.8;  // of the smallest gap: a bound this large is good enough
constexpr int NB_COARSE = 127;        // spheres of a tree whose leaves give the distance
constexpr double ROUNDING = 64.0 * std::numeric_limits<double>::epsilon();

PairDistance gapOf(const PlacedSphere& a, const PlacedSphere& b, const Isometry3d& X_AB) {
  PairDistance gap;
  const Vector3d p_AB = X_AB * b.center - a.center;
  const double apart = p_AB.norm();
  if (apart > 0.0) gap.nhat_AB_A = p_AB / apart;
  gap.distance = apart - a.radius - b.radius;
  gap.p_ACa = a.center + a.radius * gap.nhat_AB_A;
  gap.p_ACb = gap.p_ACa + gap.distance * gap.nhat_AB_A;
  return gap;
}

PairDistance gapOf(const PlacedSphere& a, const Prepared& B, const Isometry3d& X_AB) {
  ConvexCore sphere;
  sphere.radius = a.radius;
  Isometry3d X_CB = X_AB;  // C: parallel to A, at the sphere's centre
  X_CB.translation() -= a.center;
  PairDistance gap;
  if (B.isHalfSpace()) {
    const Isometry3d X_BC = X_CB.inverse(Eigen::Isometry);
    gap = exchanged(halfSpaceDistance(sphere, X_BC), X_CB);
  } else {
    gap = closedForm(sphere, B.core, X_CB);
  }
  gap.p_ACa += a.center;
  gap.p_ACb += a.center;
  return gap;
}

double reachOf(const SpheresOrShape& solid) {
  if (solid.spheres != nullptr)
    return solid.spheres->front().center.norm() + solid.spheres->front().radius;
  return solid.shape->core.extent + solid.shape->core.radius;
}

/// Searches for the smallest gap of two leaves. The gap of a pair of spheres, and that of each of
/// its ancestors, is a lower bound for the part of the solids below it.
class LeastGap {
 public:
  LeastGap(const SpheresOrShape& A, const SpheresOrShape& B, const Isometry3d& X_AB)
      : A_(A), B_(B), X_AB_(X_AB) {}

  /// Stops at a gap of at most `enough`, or when nothing nearer than `best` is left.
  void search(double enough, double best) {
    least_ = best;
    Step stack[64];  // the two paths to leaves leave at most one step per sphere
    int depth = 0;
    stack[depth++] = {0, 0, gap(0, 0)};
    while (depth > 0 && least_ > enough) {
      const Step step = stack[--depth];
      if (isPruned(step.bound, enough)) continue;
      const int in_a = childOf(A_, step.a), in_b = childOf(B_, step.b);
      const bool is_coarsely_apart = step.bound > enough && isFine(in_a) && isFine(in_b);
      if ((in_a == 0 && in_b == 0) || is_coarsely_apart) {
        take(step);
        continue;
      }
      const bool of_a = in_b == 0 || (in_a != 0 && in_a <= in_b);
      Step first = of_a ? Step{in_a, step.b, 0.0} : Step{step.a, in_b, 0.0};
      Step second = of_a ? Step{in_a + 1, step.b, 0.0} : Step{step.a, in_b + 1, 0.0};
      first.bound = std::max(step.bound, gap(first.a, first.b));
      second.bound = std::max(step.bound, gap(second.a, second.b));
      if (first.bound < second.bound) std::swap(first, second);
      stack[depth++] = first;  // the nearer one is processed first
      stack[depth++] = second;
    }
  }

  /// Lower bound: no leaves are nearer.
  double least() const { return std::min(least_, passed_over_); }
  bool found() const { return a_ >= 0; }
  PairDistance ofLeaves() const { return answer(a_, b_); }
  PairDistance ofRoots() const { return answer(0, 0); }

 private:
  struct Step {
    int a, b;
    double bound;
  };
  // Finding the smallest gap among hundreds of pairs with nearly the same gap is not worth the
  // search.
  bool isPruned(double bound, double enough) {
    if (bound >= least_) return true;
    if (!found() || bound <= enough) return false;
    if (bound < enough + NEARLY_LEAST * (least_ - enough)) return false;
    passed_over_ = std::min(passed_over_, bound);
    return true;
  }
  void take(const Step& step) {
    least_ = step.bound;
    a_ = step.a;
    b_ = step.b;
  }
  static bool isFine(int child) { return child == 0 || child >= NB_COARSE; }
  static int childOf(const SpheresOrShape& solid, int sphere) {
    return solid.spheres == nullptr
               ? 0
               : (*solid.spheres)[static_cast<std::size_t>(sphere)].first_child;
  }
  static const PlacedSphere& sphereOf(const SpheresOrShape& solid, int sphere) {
    return (*solid.spheres)[static_cast<std::size_t>(sphere)];
  }

  double gap(int a, int b) const {
    if (A_.spheres == nullptr || B_.spheres == nullptr) return answer(a, b).distance;
    const PlacedSphere &of_a = sphereOf(A_, a), &of_b = sphereOf(B_, b);
    return (X_AB_ * of_b.center - of_a.center).norm() - of_a.radius - of_b.radius;
  }

  PairDistance answer(int a, int b) const {
    if (B_.spheres == nullptr) return gapOf(sphereOf(A_, a), *B_.shape, X_AB_);
    if (A_.spheres != nullptr) return gapOf(sphereOf(A_, a), sphereOf(B_, b), X_AB_);
    return exchanged(gapOf(sphereOf(B_, b), *A_.shape, X_AB_.inverse(Eigen::Isometry)), X_AB_);
  }

  const SpheresOrShape &A_, &B_;
  const Isometry3d& X_AB_;
  double least_ = std::numeric_limits<double>::infinity();
  double passed_over_ = least_;
  int a_ = -1, b_ = -1;
};

}  // namespace

PairDistance sphereDistance(const SpheresOrShape& A, const SpheresOrShape& B,
                            const Isometry3d& X_AB, double max_distance, double contact_distance) {
  const double error = ROUNDING * (X_AB.translation().norm() + reachOf(A) + reachOf(B));
  LeastGap gaps(A, B, X_AB);
  gaps.search(contact_distance + error, max_distance + 2.0 * error);
  const bool meet = gaps.least() <= contact_distance + error;
  PairDistance answer = meet || !gaps.found() ? gaps.ofRoots() : gaps.ofLeaves();
  answer.distance = (meet ? answer.distance : gaps.least()) - error;
  answer.certainty = answer.distance > max_distance ? Certainty::BEYOND : Certainty::EXACT;
  return answer;
}

}  // namespace collision_pairs
