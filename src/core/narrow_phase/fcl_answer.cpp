#include "fcl_answer.h"

#include <cmath>
#include <limits>

namespace collision_pairs {
namespace {

using Eigen::Vector3d;
using Outcome = FclAnswer::Outcome;

constexpr double ROUNDING = 1e-12;  // of FCL's boxes, relative to the size of a pair
constexpr double NO_NORMAL = 1e-8;  // of the size of a pair: nearer points give no direction

}  // namespace

double FclQuestion::bound() const {
  return FCL_UNITS * max_distance.value_or(0.0) + ROUNDING * size;
}

FclAnswer fclBeyond(const FclQuestion& question) {
  FclAnswer answer = Outcome::APART;
  answer.found.distance =
      std::nextafter(question.max_distance.value_or(0.0), std::numeric_limits<double>::infinity());
  answer.found.certainty = Certainty::BEYOND;
  return answer;
}

FclAnswer fclApart(const FclGap& gap, const FclQuestion& question) {
  if (!question.max_distance) return gap.settled ? Outcome::APART : Outcome::NONE;
  const Vector3d a_to_b = gap.p_b - gap.p_a;
  const double between = a_to_b.norm();
  const bool consistent = gap.settled && between > NO_NORMAL * question.size &&
                          std::abs(between - gap.distance) <= FCL_CONFIRMED * question.size;
  if (!consistent) return Outcome::NONE;
  if (gap.distance > FCL_UNITS * *question.max_distance) return fclBeyond(question);
  FclAnswer answer = Outcome::APART;
  answer.found.distance = gap.distance / FCL_UNITS;
  answer.found.p_ACa = gap.p_a / FCL_UNITS;
  answer.found.p_ACb = gap.p_b / FCL_UNITS;
  answer.found.nhat_AB_A = a_to_b / between;
  return answer;
}

FclAnswer fclDeep(const Vector3d& p_a, const Vector3d& nhat_AB_A, double depth) {
  // If they touch, FCL may return no normal (#375).
  if (!(std::abs(nhat_AB_A.norm() - 1.0) <= FCL_CONFIRMED && depth >= 0.0)) return Outcome::NONE;
  FclAnswer answer = Outcome::DEPTH;
  answer.found.distance = -depth / FCL_UNITS;
  answer.found.nhat_AB_A = nhat_AB_A.normalized();
  answer.found.p_ACa = p_a / FCL_UNITS;
  answer.found.p_ACb = (p_a - depth * answer.found.nhat_AB_A) / FCL_UNITS;
  return answer;
}

}  // namespace collision_pairs
