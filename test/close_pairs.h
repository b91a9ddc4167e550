// Random pairs of convex shapes a hair from contact, of any sizes, and what is wrong with the
// answers about them.
#pragma once

#include "benchmark/accuracy_rows.h"
#include "exact_distance.h"

namespace collision_pairs {

inline const std::vector<std::string>& convexKinds() {
  static const std::vector<std::string> KINDS{"box", "sphere", "cylinder", "capsule", "convex"};
  return KINDS;
}

/// Radius of the ball around the shape's middle; metres.
inline double sizeOf(const Shape& shape) {
  if (const auto* box = std::get_if<Box>(&shape)) return 0.5 * box->size.norm();
  if (const auto* sphere = std::get_if<Sphere>(&shape)) return sphere->radius;
  if (const auto* c = std::get_if<Cylinder>(&shape)) return std::hypot(c->radius, 0.5 * c->length);
  if (const auto* c = std::get_if<Capsule>(&shape)) return c->radius + 0.5 * c->length;
  double size = 0.0;
  for (const auto& v : std::get<Convex>(shape).mesh->vertices) size = std::max(size, v.norm());
  return size;
}

struct ClosePair {
  Shape a, b;
  Eigen::Isometry3d X_AB;
  double smaller() const { return std::min(sizeOf(a), sizeOf(b)); }
  double larger() const { return std::max(sizeOf(a), sizeOf(b)); }
  /// A gap up to the first is contact, one above the second is none (docs/accuracy.md); metres.
  double leastBand() const { return 1e-15 * larger(); }
  double mostBand() const {
    return 1e-15 * (2.0 * (sizeOf(a) + sizeOf(b)) + X_AB.translation().lpNorm<1>());
  }
  /// What docs/accuracy.md promises of an EXACT distance.
  double goal() const {
    return std::max(64.0 * std::numeric_limits<double>::epsilon() * larger(), 1e-12 * smaller());
  }
};

/// Places B at about the signed distance `wanted` from A, or as near to it as the pose can be
/// given; half of them turned by right angles only. `offset`: of both from the origin of the poses
/// from which X_AB is made; metres.
inline void placeClose(RandomInputs& random, double wanted, double offset, ClosePair& pair) {
  pair.X_AB = random.pose(0.0);
  if (random.integer(0, 1) == 0) {
    Eigen::Matrix3d turn = Eigen::Matrix3d::Zero();
    const int first = random.integer(0, 2), second = (first + random.integer(1, 2)) % 3;
    turn(first, 0) = random.integer(0, 1) ? 1.0 : -1.0;
    turn(second, 1) = random.integer(0, 1) ? 1.0 : -1.0;
    turn.col(2) = turn.col(0).cross(turn.col(1));
    pair.X_AB.linear() = turn;
  }
  const Eigen::Vector3d direction = random.rotation() * Eigen::Vector3d::UnitX();
  pair.X_AB.translation() = 3.0 * (pair.smaller() + pair.larger()) * direction;
  NarrowPhase narrow_phase;
  const auto A = prepareShape(pair.a), B = prepareShape(pair.b);
  for (int i = 0; i < 2; ++i) {
    const PairDistance found =
        narrow_phase.distance(*A, *B, pair.X_AB, std::numeric_limits<double>::infinity());
    pair.X_AB.translation() += (wanted - found.distance) * found.nhat_AB_A;
  }
  if (offset == 0.0) return;
  Eigen::Isometry3d X_WA = random.pose(0.0);
  X_WA.translation() = offset * Eigen::Vector3d(1.0, -0.7, 0.4);
  const Eigen::Isometry3d X_WB = X_WA * pair.X_AB;
  pair.X_AB = X_WA.inverse() * X_WB;
}

/// Bodies whose sizes are in this ratio, from 1e-6 to 1e6 m. A half each: at a gap or depth of
/// 1e-19 to 1e-2 of the smaller one; of some roundings of the larger one.
inline ClosePair closePair(RandomInputs& random, const std::string& kind_a,
                           const std::string& kind_b, double ratio, double offset = 0.0) {
  const double small = std::pow(10.0, random.uniform(-6.0, 6.0 - std::log10(ratio))) / 0.2;
  const bool a_is_small = random.integer(0, 1) == 0;
  ClosePair pair{scaled(randomShape(random, kind_a), a_is_small ? small : small * ratio),
                 scaled(randomShape(random, kind_b), a_is_small ? small * ratio : small),
                 {}};
  double wanted = pair.smaller() * std::pow(10.0, random.uniform(-19.0, -2.0));
  if (random.integer(0, 1) == 0) wanted = pair.larger() * random.uniform(0.0, 4e-16);
  if (random.integer(0, 1) == 0) wanted = -wanted;
  placeClose(random, wanted, offset, pair);
  return pair;
}

struct CloseAnswer {
  DistanceInterval truth;
  PairDistance found;
  bool wrong_verdict = false;  ///< of yes or no, or of the distance's sign
  bool contradiction = false;  ///< of the two
  double error = 0.0;  ///< of an EXACT distance or depth, metres; at least the certified part
};

inline CloseAnswer ask(const ClosePair& pair) {
  NarrowPhase narrow_phase;
  const auto A = prepareShape(pair.a), B = prepareShape(pair.b);
  CloseAnswer answer;
  answer.found = narrow_phase.distance(*A, *B, pair.X_AB, std::numeric_limits<double>::infinity());
  const bool touches = narrow_phase.touches(*A, *B, pair.X_AB);
  answer.contradiction = touches != answer.found.touches();
  const OracleBody body_a = oracleBody(pair.a), body_b = oracleBody(pair.b);
  const Digits size = pair.larger();
  answer.truth = ExactDistance::of(body_a, body_b, pair.X_AB, size * Digits(1e-34));
  const bool apart = answer.truth.lower > Digits(pair.mostBand());
  const bool in_contact = answer.truth.upper <= Digits(pair.leastBand());
  for (const bool said : {touches, answer.found.touches()}) {
    answer.wrong_verdict |= (apart && said) || (in_contact && !said);
  }
  if (answer.found.certainty != Certainty::EXACT) return answer;
  if (answer.found.distance > 0.0) {
    const Digits found = answer.found.distance;
    answer.error = static_cast<double>(
        std::max(Digits(found - answer.truth.lower), Digits(answer.truth.upper - found)));
  } else if (answer.truth.upper <= 0 && !body_a.round && !body_b.round) {
    answer.error =
        static_cast<double>(abs(exactDepth(body_a, body_b, pair.X_AB) + answer.found.distance));
  }
  return answer;
}

}  // namespace collision_pairs
