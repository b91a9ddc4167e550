// Whether a damaged message claims more than it has.
#pragma once

#include <cstdint>

namespace collision_pairs {

/// roscpp makes room for as many entries as a message says it has, before it looks whether they are
/// there: four wrong bytes ask for gigabytes. These look first, at all arrays of the message.
bool jointStateFits(const std::uint8_t* data, std::uint32_t size);
bool tfMessageFits(const std::uint8_t* data, std::uint32_t size);

}  // namespace collision_pairs
