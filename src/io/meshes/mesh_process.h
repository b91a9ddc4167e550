// Reads COLLADA and glTF with geometric_shapes, in a process of its own.
#pragma once

#include <chrono>
#include <cstddef>
#include <string>

#include "collision_pairs/shape.h"

namespace collision_pairs {

/// assimp, which geometric_shapes uses, crashed on 50 of 4,253 damaged files and hung or used
/// unlimited memory on 34. So it runs in the program read_mesh_file beside this library, for at
/// most `time_limit` and with at most 4 GiB. That program can write no file, gain no rights and,
/// unless it is root's, start no other. At most `most_bytes` of its answer are taken. For any file,
/// this returns or throws InputError that describes the failure, without the file's name. Starting
/// the program takes about 20 ms.
TriangleMesh readMeshInProcess(const std::string& path,
                               std::chrono::milliseconds time_limit = std::chrono::seconds(30),
                               std::size_t most_bytes = std::size_t{1} << 30);

/// The protocol between the two: a byte, followed after MESH by the numbers of vertices and
/// triangles (std::uint64_t), coordinates (float) and indices (std::uint32_t), and after REFUSED by
/// a message.
namespace mesh_pipe {
constexpr char MESH = 'M', REFUSED = 'R';
}

}  // namespace collision_pairs
