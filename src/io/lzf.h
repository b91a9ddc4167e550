// LZF, the compression of PCD files.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace collision_pairs {

/// Throws InputError unless `compressed` is the LZF (Marc Lehmann 2000) of exactly `size` bytes. Of
/// a hostile size nothing is allocated: a byte becomes 88 at most. Cost: linear in both.
///
/// The format is a sequence of runs that begin with a byte c. c < 32: the c + 1 bytes that follow
/// are copied. Otherwise c >> 5 is a length, 7: to which the next byte is added; the next byte and,
/// above it, c & 31 are an offset; length + 2 bytes are copied from offset + 1 before the end of
/// what there is, which may grow over what is copied.
std::string decompressLzf(std::string_view compressed, std::size_t size);

}  // namespace collision_pairs
