#include "closed_forms.h"

#include <algorithm>
#include <cmath>

#include "convex_distance.h"
#include "double_double.h"

namespace collision_pairs {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;
using Kind = ConvexCore::Kind;

// Nearer to contact than this, relative to the coordinates, rounding could decide: that of a closed
// form, and what a rotation in double leaves of right angles.
constexpr double ROUNDING = 5e-14;

// The point of a core's surface closest to a point Q, all in the core's frame.
struct Foot {
  double distance;  // signed: negative inside
  Vector3d normal;  // unit, outwards, towards (outside) or away from (inside) Q
};

Foot footOnPoint(const Vector3d& q) {
  // Of what is neither so large nor so small the squares can be summed as they are.
  constexpr double SMALLEST = 1e-200, LARGEST = 1e200;
  const double squared = q.squaredNorm();
  if (squared > SMALLEST && squared < LARGEST) {
    const double root = std::sqrt(squared);
    return {root, q / root};
  }
  const double distance = q.stableNorm();
  return {distance, distance > 0.0 ? Vector3d(q.stableNormalized()) : Vector3d::UnitZ()};
}

Foot footOnSegment(const ConvexCore& segment, const Vector3d& q) {
  const double h = segment.half[2];
  const Vector3d apart(q[0], q[1], q[2] - std::clamp(q[2], -h, h));
  if (apart.isZero(0.0)) return {0.0, Vector3d::UnitX()};
  return footOnPoint(apart);
}

Foot footOnBox(const ConvexCore& box, const Vector3d& q) {
  const Vector3d beyond = q.cwiseAbs() - box.half;
  const auto signs = [&](int i) { return q[i] < 0.0 ? -1.0 : 1.0; };
  if ((beyond.array() > 0.0).any()) {
    Vector3d apart = beyond.cwiseMax(0.0);
    for (int i = 0; i < 3; ++i) apart[i] *= signs(i);
    return footOnPoint(apart);
  }
  int axis;
  const double distance = beyond.maxCoeff(&axis);
  return {distance, signs(axis) * Vector3d::Unit(axis)};
}

Foot footOnCylinder(const ConvexCore& cylinder, const Vector3d& q) {
  const double rho = std::hypot(q[0], q[1]);
  const Vector3d radial = rho > 0.0 ? Vector3d(q[0] / rho, q[1] / rho, 0.0) : Vector3d::UnitX();
  const Vector3d axial(0.0, 0.0, q[2] < 0.0 ? -1.0 : 1.0);
  const double r = rho - cylinder.half[0], z = std::abs(q[2]) - cylinder.half[2];
  if (r > 0.0 && z > 0.0) {
    const double distance = std::hypot(r, z);
    return {distance, (r / distance) * radial + (z / distance) * axial};
  }
  return r > z ? Foot{r, radial} : Foot{z, axial};
}

Foot footOn(const ConvexCore& core, const Vector3d& q) {
  switch (core.kind) {
    case Kind::SEGMENT:
      return footOnSegment(core, q);
    case Kind::BOX:
      return footOnBox(core, q);
    case Kind::CYLINDER:
      return footOnCylinder(core, q);
    default:
      return footOnPoint(q);
  }
}

// B is a point with a radius.
PairDistance pointDistance(const ConvexCore& A, const ConvexCore& B, const Vector3d& p_AB) {
  const Foot foot = footOn(A, p_AB);
  PairDistance result;
  result.distance = foot.distance - A.radius - B.radius;
  result.nhat_AB_A = foot.normal;
  result.p_ACa = p_AB + (A.radius - foot.distance) * foot.normal;
  result.p_ACb = p_AB - B.radius * foot.normal;
  return result;
}

struct SegmentPair {
  Vector3d on_a, on_b;
  double squared;
};

// Closest points of which at least one is an end: the ends of one segment against the whole other
// one.
SegmentPair closestWithEnds(double h, const Vector3d& center, const Vector3d& half_b) {
  SegmentPair best{Vector3d::Zero(), Vector3d::Zero(), std::numeric_limits<double>::infinity()};
  const auto offer = [&](const Vector3d& a, const Vector3d& b) {
    const double squared = (b - a).squaredNorm();
    if (squared < best.squared) best = {a, b, squared};
  };
  const double length_squared = half_b.squaredNorm();
  for (const double sign : {-1.0, 1.0}) {
    const Vector3d b = center + sign * half_b;
    offer({0.0, 0.0, std::clamp(b[2], -h, h)}, b);
    const Vector3d a(0.0, 0.0, sign * h);
    const double t = length_squared > 0.0 ? half_b.dot(a - center) / length_squared : 0.0;
    offer(a, center + std::clamp(t, -1.0, 1.0) * half_b);
  }
  return best;
}

PairDistance segmentDistance(const ConvexCore& A, const ConvexCore& B, const Isometry3d& X_AB) {
  const Vector3d half_a(0.0, 0.0, A.half[2]), half_b = X_AB.linear().col(2) * B.half[2];
  const Vector3d center = X_AB.translation();
  const Vector3d across = half_a.cross(half_b);
  const double nn = across.squaredNorm();
  SegmentPair found = closestWithEnds(A.half[2], center, half_b);
  Vector3d normal = Vector3d::UnitX();  // of two that meet, but for rounding: across both
  if (nn > 0.0) {
    normal = across.stableNormalized();
  } else if (B.half[2] > A.half[2]) {
    normal = X_AB.linear().col(2).unitOrthogonal();
  }
  double distance = std::sqrt(found.squared);
  const double s = center.cross(half_b).dot(across), t = center.cross(half_a).dot(across);
  if (nn > 0.0 && std::abs(s) <= nn && std::abs(t) <= nn) {
    found.on_a = (s / nn) * half_a;
    found.on_b = center + (t / nn) * half_b;
    distance = center.dot(normal);
    if (distance < 0.0) normal = -normal, distance = -distance;
  } else if (distance > ROUNDING * magnitudeOf(A, B, center)) {
    normal = (found.on_b - found.on_a).stableNormalized();
  }
  PairDistance result;
  result.distance = distance - A.radius - B.radius;
  result.nhat_AB_A = normal;
  result.p_ACa = found.on_a + A.radius * normal;
  result.p_ACb = found.on_b - B.radius * normal;
  return result;
}

template <class T>
Vec3<T> lowestPoint(const ConvexCore& B, const Isometry3d& X_AB) {
  const Mat3<T> R_AB = X_AB.linear().cast<T>();
  const Vec3<T> down_B = -R_AB.row(2).transpose();
  return R_AB * support<T>(B, down_B) + X_AB.translation().cast<T>();
}

}  // namespace

bool hasClosedForm(const ConvexCore& A, const ConvexCore& B) {
  const auto simple = [](const ConvexCore& core) { return core.kind != Kind::POINTS; };
  if (A.kind == Kind::POINT) return simple(B);
  if (B.kind == Kind::POINT) return simple(A);
  return A.kind == Kind::SEGMENT && B.kind == Kind::SEGMENT;
}

PairDistance closedForm(const ConvexCore& A, const ConvexCore& B, const Isometry3d& X_AB,
                        double band) {
  PairDistance result;
  if (B.kind == Kind::POINT) {
    result = pointDistance(A, B, X_AB.translation());
  } else if (A.kind == Kind::SEGMENT) {
    result = segmentDistance(A, B, X_AB);
  } else {
    const Isometry3d X_BA = X_AB.inverse(Eigen::Isometry);
    result = exchanged(pointDistance(B, A, X_BA.translation()), X_AB);
  }
  const double magnitude = magnitudeOf(A, B, X_AB.translation());
  if (std::abs(result.distance) > ROUNDING * magnitude + band) return result;
  return convexDistance(A, B, X_AB, std::numeric_limits<double>::infinity(), band);
}

PairDistance halfSpaceDistance(const ConvexCore& B, const Isometry3d& X_AB, double band) {
  const Vector3d lowest = lowestPoint<double>(B, X_AB);
  PairDistance result;
  result.distance = lowest[2] - B.radius;
  if (std::abs(result.distance) <= ROUNDING * magnitudeOf({}, B, X_AB.translation()) + band) {
    const DoubleDouble height = lowestPoint<DoubleDouble>(B, X_AB)[2] - DoubleDouble(B.radius);
    result.distance = static_cast<double>(height);
    if (height <= DoubleDouble(band)) result.distance = std::min(result.distance, 0.0);
  }
  result.nhat_AB_A = Vector3d::UnitZ();
  result.p_ACb = lowest - B.radius * Vector3d::UnitZ();
  result.p_ACa = {lowest[0], lowest[1], 0.0};
  return result;
}

PairDistance halfSpacePair(const Isometry3d& X_AB) {
  PairDistance result;
  const Vector3d up_B = X_AB.linear().col(2);
  const bool face_each_other = up_B[0] == 0.0 && up_B[1] == 0.0 && up_B[2] < 0.0;
  result.p_ACb = X_AB.translation();
  result.p_ACa = {result.p_ACb[0], result.p_ACb[1], 0.0};
  result.distance = face_each_other ? result.p_ACb[2] : -std::numeric_limits<double>::infinity();
  return result;
}

// Along an axis of length at most 1, computed gaps are off by less than `rounding`, which includes
// what a rotation in double leaves of right angles. If edges are parallel to within PARALLEL, their
// common normal is mostly rounding. Turned to be parallel, the boxes need no such axis, and move by
// less than PARALLEL of their size: what overlaps by more than `deep` along all other axes
// overlaps.
std::optional<bool> boxesTouch(const Vector3d& half_a, const Vector3d& half_b,
                               const Isometry3d& X_AB, double band) {
  constexpr double PARALLEL = 1e-12, DEEP = 1e-11;
  const Eigen::Matrix3d R = X_AB.linear(), reach = R.cwiseAbs();
  const Vector3d p = X_AB.translation();
  const double size = half_a.sum() + half_b.sum() + p.lpNorm<1>();
  const double rounding = ROUNDING * size + band, deep = DEEP * size;
  const double along_a = (p.cwiseAbs() - half_a - reach * half_b).maxCoeff();
  if (along_a > rounding) return false;
  const Vector3d across = (R.transpose() * p).cwiseAbs();
  const double along_b = (across - half_b - reach.transpose() * half_a).maxCoeff();
  if (along_b > rounding) return false;
  bool is_sure = along_a < -deep && along_b < -deep;
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3, k = (i + 2) % 3;
    for (int m = 0; m < 3; ++m) {
      if (reach(j, m) + reach(k, m) < PARALLEL) continue;
      const int n = (m + 1) % 3, o = (m + 2) % 3;
      const double along = std::abs(p[k] * R(j, m) - p[j] * R(k, m));
      const double reach_a = half_a[j] * reach(k, m) + half_a[k] * reach(j, m);
      const double reach_b = half_b[n] * reach(i, o) + half_b[o] * reach(i, n);
      const double gap = along - reach_a - reach_b;
      if (gap > rounding) return false;
      is_sure = is_sure && gap < -rounding;
    }
  }
  return is_sure ? std::optional<bool>(true) : std::nullopt;
}

PairDistance exchanged(const PairDistance& result, const Isometry3d& X_BA) {
  PairDistance other = result;
  other.p_ACa = X_BA * result.p_ACb;
  other.p_ACb = X_BA * result.p_ACa;
  other.nhat_AB_A = -(X_BA.linear() * result.nhat_AB_A);
  return other;
}

}  // namespace collision_pairs
