// Whether assimp reads all of a glTF file.
#pragma once

#include <string>

/// Throws std::runtime_error if the file, text or binary, is not of glTF 2, has a name that the
/// schema does not have where surfaces are placed and described (assimp skips it), or requires an
/// extension that may change surfaces: assimp reads it without, so that quantized vertices fall
/// into one point.
void requireKnownGltf(const std::string& path);
