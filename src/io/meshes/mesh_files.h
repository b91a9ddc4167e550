// The two formats of most robots' meshes, read here. What else there is: mesh_process.h.
#pragma once

#include <optional>
#include <string>

#include "collision_pairs/shape.h"

namespace collision_pairs {

/// Both take a file's bytes, whatever they are: time and memory grow with their number, not with
/// what they claim. Coordinates are rounded to single precision, as all readers of ROS do (rviz,
/// MoveIt); equal vertices are one; vertices without a triangle are left out, for they are no part
/// of the surface. Throw InputError that says what is wrong and where, without the file's name.

/// Binary or ASCII. Binary is what has the length that its count of triangles asks for, whatever it
/// begins with. A file that ends early is refused: what is missing would be passed through.
TriangleMesh readStl(const std::string& bytes);

/// The lines `v` and `f`; polygons are cut into fans. Groups, normals, colours, lines and points
/// are passed over. Nothing where that is not enough: a polygon that is not convex, weights of
/// vertices, lines that are continued.
std::optional<TriangleMesh> readObj(const std::string& bytes);

}  // namespace collision_pairs
