// Random bodies of every kind of shape and any size, and poses at which two of them are so far
// apart.
#pragma once

#include <string>
#include <vector>

#include "collision_pairs/narrow_phase.h"
#include "random_inputs.h"
#include "test_shapes.h"

namespace collision_pairs {

/// "convex" has a few vertices, "hull" so many that FCL walks along its edges; "l" is a mesh of two
/// boxes, "ball" one of 264 small triangles. Also known, but without a volume: "sheet".
inline const std::vector<std::string> EVERY_KIND = {"box",    "sphere", "cylinder", "capsule",
                                                    "convex", "hull",   "l",        "ball"};

inline Shape meshOf(TriangleMesh mesh, double scale) {
  for (Eigen::Vector3d& v : mesh.vertices) v *= scale;
  return meshShape(std::move(mesh));
}

/// About `size` metres across.
inline Shape shapeOfKind(RandomInputs& random, const std::string& kind, double size) {
  if (kind == "box") return Box{size * random.vector(0.25, 1.25)};
  if (kind == "sheet") return Box{size * Eigen::Vector3d(1.0, random.uniform(0.25, 1.25), 0.0)};
  if (kind == "sphere") return Sphere{size * random.uniform(0.25, 0.75)};
  if (kind == "cylinder") {
    return Cylinder{size * random.uniform(0.15, 0.75), size * random.uniform(0.25, 1.5)};
  }
  if (kind == "capsule") {
    return Capsule{size * random.uniform(0.15, 0.5), size * random.uniform(0.25, 1.5)};
  }
  if (kind == "l") return meshOf(LShape().mesh(), size / 0.3);
  if (kind == "ball") return meshOf(bumpyBall(12, 0.5), size);
  auto points = std::make_shared<TriangleMesh>();
  for (int i = 0; i < (kind == "hull" ? 80 : 14); ++i) {
    points->vertices.push_back(0.6 * size * (random.rotation() * Eigen::Vector3d::UnitX()));
  }
  return Convex{points};
}

/// B `gap` metres from A, or as deep in it; -infinity: anywhere that is deep. The native narrow
/// phase chooses the place and nothing else.
inline Eigen::Isometry3d poseWithGap(RandomInputs& random, NarrowPhase& native,
                                     const PreparedShape& A, const PreparedShape& B, double size,
                                     double gap) {
  Eigen::Isometry3d X_AB = random.pose(0.0);
  const Eigen::Vector3d direction = random.rotation() * Eigen::Vector3d::UnitX();
  if (std::isinf(gap)) {
    X_AB.translation() = random.uniform(0.0, 0.5) * size * direction;
    return X_AB;
  }
  X_AB.translation() = 10.0 * size * direction;
  const PairDistance apart = native.distance(A, B, X_AB, std::numeric_limits<double>::infinity());
  X_AB.translation() += (gap - apart.distance) * apart.nhat_AB_A;
  return X_AB;
}

}  // namespace collision_pairs
