// Random pairs of convex shapes over all separations, and how wrong the answers are.
#pragma once

#include <string>

#include "random_inputs.h"
#include "signed_distance_oracle.h"

namespace collision_pairs {

/// What the poses of one row are like.
enum class Separation { APART, NEAR, SLIGHT, DEEP, TWO_MILLIMETRES };

/// Bodies of about 20 cm, as in Drake's table; a Convex is the hull of a few points on a sphere.
inline Shape randomShape(RandomInputs& random, const std::string& kind) {
  if (kind == "box") return Box{random.vector(0.05, 0.25)};
  if (kind == "sphere") return Sphere{random.uniform(0.05, 0.15)};
  if (kind == "cylinder") return Cylinder{random.uniform(0.03, 0.15), random.uniform(0.05, 0.3)};
  if (kind == "capsule") return Capsule{random.uniform(0.03, 0.1), random.uniform(0.05, 0.3)};
  auto mesh = std::make_shared<TriangleMesh>();
  for (int i = 0; i < 14; ++i)
    mesh->vertices.push_back(0.12 * (random.rotation() * Eigen::Vector3d::UnitX()));
  return Convex{mesh};
}

inline Shape scaled(Shape shape, double factor) {
  if (auto* box = std::get_if<Box>(&shape)) box->size *= factor;
  if (auto* sphere = std::get_if<Sphere>(&shape)) sphere->radius *= factor;
  if (auto* c = std::get_if<Cylinder>(&shape)) c->radius *= factor, c->length *= factor;
  if (auto* c = std::get_if<Capsule>(&shape)) c->radius *= factor, c->length *= factor;
  if (auto* convex = std::get_if<Convex>(&shape)) {
    auto mesh = std::make_shared<TriangleMesh>(*convex->mesh);
    for (Eigen::Vector3d& v : mesh->vertices) v *= factor;
    convex->mesh = mesh;
  }
  return shape;
}

/// A pose of B with about the separation asked for. The separation only chooses where to look; the
/// truth is the oracle's.
inline Eigen::Isometry3d randomPose(RandomInputs& random, NarrowPhase& narrow_phase,
                                    const PreparedShape& A, const PreparedShape& B,
                                    Separation separation) {
  Eigen::Isometry3d X_AB = random.pose(0.0);
  const Eigen::Vector3d direction = random.rotation() * Eigen::Vector3d::UnitX();
  if (separation == Separation::DEEP) {
    X_AB.translation() = random.uniform(0.0, 0.15) * direction;
    return X_AB;
  }
  X_AB.translation() = 2.0 * direction;
  const PairDistance apart =
      narrow_phase.distance(A, B, X_AB, std::numeric_limits<double>::infinity());
  double wanted = 0.0;
  if (separation == Separation::APART) wanted = random.uniform(0.0, 1.0);
  if (separation == Separation::NEAR) wanted = std::pow(10.0, random.uniform(-16.0, -2.0));
  if (separation == Separation::SLIGHT) wanted = -std::pow(10.0, random.uniform(-16.0, -2.0));
  if (separation == Separation::TWO_MILLIMETRES) wanted = -0.002;
  X_AB.translation() += (wanted - apart.distance) * apart.nhat_AB_A;
  return X_AB;
}

inline const char* name(Separation separation) {
  switch (separation) {
    case Separation::APART:
      return "0 to 1 m apart";
    case Separation::NEAR:
      return "1e-16 to 1e-2 m apart";
    case Separation::SLIGHT:
      return "1e-16 to 1e-2 m deep";
    case Separation::DEEP:
      return "deep";
    case Separation::TWO_MILLIMETRES:
      return "2 mm deep";
  }
  return "";
}

}  // namespace collision_pairs
