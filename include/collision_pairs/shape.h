// The shapes a collision element can have. All lengths in metres; every shape is a closed solid,
// described in its own frame E (for "element"). Plain values: nothing here computes.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <variant>
#include <vector>

#include <Eigen/Core>

namespace collision_pairs {

/// Centred at the origin. `size` holds the full edge lengths, each >= 0.
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

/// All points within `radius` of the segment from -length/2 to +length/2 along z: its whole height
/// is length + 2 radius. radius >= 0, length >= 0.
struct Capsule {
  double radius;
  double length;
};

/// All points with z <= 0: a floor whose top is the xy plane. Unbounded.
struct HalfSpace {};

/// Triangles over shared vertices. No order, orientation or closedness is promised: files hold
/// meshes inside out, open, and with triangles of no area.
struct TriangleMesh {
  std::vector<Eigen::Vector3d> vertices;
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::string name;  ///< where it came from, for messages only
};

/// The convex hull of the mesh's vertices. Its triangles are not looked at.
struct Convex {
  std::shared_ptr<const TriangleMesh> mesh;
};

/// The solid that the mesh bounds: its triangles, and all points that they enclose. A closed
/// surface within that faces the other way bounds a hollow, which is no part of the solid; one that
/// faces the same way is one more body. Nearly closed counts as closed: up to 3 % of the area may
/// be missing. What is more open is its triangles only, and a body within it is not found.
struct Mesh {
  std::shared_ptr<const TriangleMesh> mesh;
};

using Shape = std::variant<Box, Sphere, Cylinder, Capsule, HalfSpace, Convex, Mesh>;

/// "box", "sphere", …: the word used in messages and tables.
const char* shapeName(const Shape& shape);

/// Throws std::invalid_argument that names the defect if a size is negative or not finite, a
/// vertex is not finite, a triangle refers to a missing vertex, or a mesh has no triangle (a
/// convex: no vertex).
void validateShape(const Shape& shape);

}  // namespace collision_pairs
