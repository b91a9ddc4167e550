// The shapes of collision elements. All lengths in metres; every shape is a closed solid in its own
// frame E (for "element"). Plain data.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <variant>
#include <vector>

#include <Eigen/Core>

namespace collision_pairs {

/// Centred at the origin. `size` holds the full edge lengths, each >= 0. With one that is 0 it is a
/// thin sheet, which is in contact with what crosses it: a plane, if it is large enough (HalfSpace
/// is solid below).
struct Box {
  Eigen::Vector3d size;
};

/// Centred at the origin. radius >= 0.
struct Sphere {
  double radius;
};

/// Axis along z, from -length/2 to +length/2, flat ends. radius >= 0, length >= 0.
struct Cylinder {
  double radius;
  double length;
};

/// All points within `radius` of the segment from -length/2 to +length/2 along z. Its total height
/// is length + 2 radius. radius >= 0, length >= 0.
struct Capsule {
  double radius;
  double length;
};

/// All points with z <= 0: a floor whose top is the xy plane. Unbounded.
struct HalfSpace {};

/// Triangles over shared vertices. Orientation, closedness and order are not guaranteed: files
/// contain inverted and open meshes, and triangles without area.
struct TriangleMesh {
  std::vector<Eigen::Vector3d> vertices;
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::string name;  ///< its source, for messages only
};

/// The convex hull of the mesh's vertices. The triangles are not used.
struct Convex {
  std::shared_ptr<const TriangleMesh> mesh;
};

/// The solid bounded by the mesh: its triangles and all points that they enclose. A closed inner
/// surface that faces the other way bounds a cavity, which is not part of the solid; one that faces
/// the same way is a further body. Nearly closed counts as closed: up to 3 % of the area may be
/// missing. A mesh with larger holes is a surface only, and a body inside it is not detected.
struct Mesh {
  std::shared_ptr<const TriangleMesh> mesh;
};

using Shape = std::variant<Box, Sphere, Cylinder, Capsule, HalfSpace, Convex, Mesh>;

/// Throws std::invalid_argument that names the defect if a size is negative or not finite, a
/// vertex is not finite, a triangle refers to a missing vertex, or a mesh has no triangle (a
/// convex: no vertex).
void validateShape(const Shape& shape);

}  // namespace collision_pairs
