// Decompression of a bag's chunks that gives what it can.
#pragma once

#include <cstdint>
#include <string>

namespace collision_pairs {

/// `compression` is none, bz2 or lz4. Appends to `content` what can be decompressed, at most `size`
/// bytes; false if that is not all of it.
bool decompressChunk(const std::string& compression, const std::string& data, std::uint32_t size,
                     std::string& content);

}  // namespace collision_pairs
