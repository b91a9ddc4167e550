// Bodies whose faces coincide in decimals, which doubles hold but for rounding.
#pragma once

#include "mixed_robot.h"

namespace collision_pairs {

/// What number of millimetres the user writes, in metres.
inline double metres(int millimetres) { return millimetres / 1000.0; }

/// A cube of [-a, a]^3, and a bar beside it, at y of 4 a times `side`, that reaches to 3 a along x:
/// the hull of both holds what abuts the cube.
inline TriangleMesh barredCube(double a, double side) {
  return joined(boxMesh(Eigen::Vector3d::Constant(a)),
                movedBy(boxMesh({3.0 * a, a, a}), {0.0, 4.0 * a * side, 0.0}));
}

inline const std::vector<std::string> ABUTTING_KINDS = {"box",    "sphere", "cylinder", "capsule",
                                                        "convex", "slab",   "barred"};

/// Reaches to exactly `a` along x and -x, at y = z = 0. `side`: of a bar.
inline Shape reachingTo(const std::string& kind, double a, double side) {
  if (kind == "box") return Box{Eigen::Vector3d(2.0 * a, a, 1.5 * a)};
  if (kind == "sphere") return Sphere{a};
  if (kind == "cylinder") return Cylinder{a, 1.2 * a};
  if (kind == "capsule") return Capsule{a, 1.2 * a};
  if (kind == "slab") return meshShape(boxMesh({a, 0.7 * a, 0.2 * a}));
  if (kind == "barred") return meshShape(barredCube(a, side));
  auto points = std::make_shared<TriangleMesh>();
  points->vertices = boxMesh({a, 0.9 * a, 0.4 * a}).vertices;
  return Convex{points};
}

/// The same as a link of a URDF; meshes by abuttingMesh(). There are no capsules and no points.
inline std::string linkReachingTo(const std::string& kind, int a) {
  const std::string r = std::to_string(metres(a)), d = std::to_string(metres(2 * a));
  if (kind == "box") return "<box size='" + d + " " + r + " " + r + "'/>";
  if (kind == "sphere") return "<sphere radius='" + r + "'/>";
  if (kind == "cylinder") return "<cylinder radius='" + r + "' length='" + r + "'/>";
  return "<mesh filename='" + kind + std::to_string(a) + "'/>";
}

inline std::shared_ptr<const TriangleMesh> abuttingMesh(const std::string& uri,
                                                        const Eigen::Vector3d&) {
  const std::size_t digits = uri.find_first_of("0123456789");
  const double a = metres(std::stoi(uri.substr(digits)));
  const Shape shape = reachingTo(uri.substr(0, digits), a, -1.0);
  return std::get<Mesh>(shape).mesh;
}

/// Where two bodies abut: A from below along x, B from above; millimetres.
struct Abutting {
  Abutting(RandomInputs& random, int voxel, int reach)
      : a(random.integer(50, 100)),
        b(random.integer(50, 100)),
        face(random.integer(0, 1) ? voxel * random.integer(-reach / voxel, reach / voxel) : 0),
        y(voxel * random.integer(-reach / voxel, reach / voxel) + voxel / 2),
        z(voxel * random.integer(-reach / voxel, reach / voxel) + voxel / 2) {}
  Eigen::Vector3d p_WA() const { return {metres(face - a), metres(y), metres(z)}; }
  Eigen::Vector3d p_WB() const { return {metres(face + b), metres(y), metres(z)}; }
  /// Metres: of the band of contact, which grows with all coordinates.
  double halfABand() const { return 5e-16 * (p_WA().norm() + p_WB().norm()); }
  /// Metres: far above the rounding of any coordinate, and far below what users mean.
  double severalBands() const {
    return 2e-14 * (std::max({std::abs(face), std::abs(y), std::abs(z)}) / 1000.0 + 1.0);
  }

  int a, b, face, y, z;
};

}  // namespace collision_pairs
