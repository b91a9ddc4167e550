// Readers for three mesh formats, and for what assimp does not tell of COLLADA. That and
// glTF: mesh_process.h.
#pragma once

#include <string>

#include "collision_pairs/shape.h"

namespace collision_pairs {

/// All accept arbitrary bytes: time and memory grow with their number, not with the counts in the
/// file. Coordinates are rounded to single precision, as by all readers of ROS (rviz, MoveIt);
/// equal vertices are merged; vertices without a triangle are dropped, since they are not part of
/// the surface. Throw InputError that names the problem and its place, but not the file.

/// Binary or ASCII. A file is binary if its length matches its count of triangles, even if it
/// begins with "solid". A truncated file is refused: a robot could pass through the missing part.
TriangleMesh readStl(const std::string& bytes);

/// Reads the lines `v` and `f`; polygons are split into triangles. Groups, normals, colours, lines
/// and points are ignored; all else, weights of vertices, and polygons that cross themselves are
/// refused.
TriangleMesh readObj(const std::string& bytes);

/// Text or binary. Reads `vertex` (x, y, z) and `face` (vertex_indices or vertex_index); skips
/// edges, materials, cameras and other properties; refuses other elements, truncated files, and
/// what the header does not count. Polygons as in readObj.
TriangleMesh readPly(const std::string& bytes);

/// Metres per unit of a COLLADA file. Throws InputError for what assimp would read in part only, or
/// otherwise than it is written, without a word: elements that the schema does not have where
/// surfaces are placed and described, references to what is not in the file, and numbers that are
/// not what it says of them.
double readColladaUnit(const std::string& text);

}  // namespace collision_pairs
