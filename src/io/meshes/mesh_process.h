// Meshes of all other formats: by geometric_shapes, in a process of its own.
#pragma once

#include <chrono>
#include <string>

#include "collision_pairs/shape.h"

namespace collision_pairs {

/// Of 4,253 damaged files assimp, which geometric_shapes reads by, crashed on 50 and hung or grew
/// without end on 34. So it runs in the program read_mesh_file beside this library, for at most
/// `time_limit` and with at most 4 GiB: whatever the file, this returns or throws InputError that
/// says what happened, without the file's name. About 20 ms are spent on starting it.
TriangleMesh readMeshInProcess(const std::string& path,
                               std::chrono::milliseconds time_limit = std::chrono::seconds(30));

/// What the two say to each other: a byte, and behind MESH the numbers of vertices and triangles
/// (std::uint64_t), coordinates (float) and indices (std::uint32_t), behind REFUSED a sentence.
namespace mesh_pipe {
constexpr char MESH = 'M', REFUSED = 'R';
}

}  // namespace collision_pairs
