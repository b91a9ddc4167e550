// Whether assimp reads all of a glTF file.
#pragma once

#include <cstddef>
#include <string>

/// How many triangles the file, text or binary, places: assimp leaves out what it cannot use.
/// Throws std::runtime_error if it is not of glTF 2, has a name that the schema does not have where
/// surfaces are placed and described (assimp skips it), transforms or accessors of another size or
/// type, or requires an extension that may change surfaces: assimp reads it without, so that
/// quantized vertices fall into one point.
std::size_t nbTrianglesOfGltf(const std::string& path);
