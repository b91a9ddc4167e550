#include "closed_forms.h"

#include <algorithm>
#include <cmath>

namespace collision_pairs {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;
using Kind = ConvexCore::Kind;

// The point of a core's surface closest to a point Q, all in the core's frame.
struct Foot {
  double distance;  // signed: negative inside
  Vector3d normal;  // unit, outwards, towards (outside) or away from (inside) Q
};

Foot footOnPoint(const Vector3d& q) {
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
  Vector3d normal = nn > 0.0 ? Vector3d(across.stableNormalized()) : Vector3d::UnitX();
  double distance = std::sqrt(found.squared);
  const double s = center.cross(half_b).dot(across), t = center.cross(half_a).dot(across);
  if (nn > 0.0 && std::abs(s) <= nn && std::abs(t) <= nn) {
    found.on_a = (s / nn) * half_a;
    found.on_b = center + (t / nn) * half_b;
    distance = center.dot(normal);
    if (distance < 0.0) normal = -normal, distance = -distance;
  } else if (distance > 0.0) {
    normal = (found.on_b - found.on_a).stableNormalized();
  }
  PairDistance result;
  result.distance = distance - A.radius - B.radius;
  result.nhat_AB_A = normal;
  result.p_ACa = found.on_a + A.radius * normal;
  result.p_ACb = found.on_b - B.radius * normal;
  return result;
}

}  // namespace

bool hasClosedForm(const ConvexCore& A, const ConvexCore& B) {
  const auto simple = [](const ConvexCore& core) { return core.kind != Kind::POINTS; };
  if (A.kind == Kind::POINT) return simple(B);
  if (B.kind == Kind::POINT) return simple(A);
  return A.kind == Kind::SEGMENT && B.kind == Kind::SEGMENT;
}

PairDistance closedForm(const ConvexCore& A, const ConvexCore& B, const Isometry3d& X_AB) {
  if (B.kind == Kind::POINT) return pointDistance(A, B, X_AB.translation());
  if (A.kind == Kind::SEGMENT) return segmentDistance(A, B, X_AB);
  const Isometry3d X_BA = X_AB.inverse(Eigen::Isometry);
  return exchanged(pointDistance(B, A, X_BA.translation()), X_AB);
}

PairDistance halfSpaceDistance(const ConvexCore& B, const Isometry3d& X_AB) {
  const Vector3d down_B = -X_AB.linear().row(2).transpose();
  const Vector3d lowest = X_AB * support<double>(B, down_B);
  PairDistance result;
  result.distance = lowest[2] - B.radius;
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

bool boxesTouch(const Vector3d& half_a, const Vector3d& half_b, const Isometry3d& X_AB) {
  const Eigen::Matrix3d R = X_AB.linear(), reach = R.cwiseAbs();
  const Vector3d p = X_AB.translation();
  if ((p.cwiseAbs().array() > (half_a + reach * half_b).array()).any()) return false;
  const Vector3d across = (R.transpose() * p).cwiseAbs();
  if ((across.array() > (half_b + reach.transpose() * half_a).array()).any()) return false;
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3, k = (i + 2) % 3;
    for (int m = 0; m < 3; ++m) {
      const int n = (m + 1) % 3, o = (m + 2) % 3;
      const double along = std::abs(p[k] * R(j, m) - p[j] * R(k, m));
      const double reach_a = half_a[j] * reach(k, m) + half_a[k] * reach(j, m);
      const double reach_b = half_b[n] * reach(i, o) + half_b[o] * reach(i, n);
      // Nearly parallel edges need no axis of their own, and theirs would be mostly rounding.
      const double rounding = 4e-16 * (std::abs(p[k]) + std::abs(p[j]) + reach_a + reach_b);
      if (along > reach_a + reach_b + rounding) return false;
    }
  }
  return true;
}

PairDistance exchanged(const PairDistance& result, const Isometry3d& X_BA) {
  PairDistance other = result;
  other.p_ACa = X_BA * result.p_ACb;
  other.p_ACb = X_BA * result.p_ACa;
  other.nhat_AB_A = -(X_BA.linear() * result.nhat_AB_A);
  return other;
}

}  // namespace collision_pairs
