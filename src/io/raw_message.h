// A recorded message before it is understood: what both ways of reading a bag hand on.
#pragma once

#include <cstdint>
#include <functional>
#include <string>

namespace collision_pairs {

/// Valid during the call that hands it over.
struct RawMessage {
  const std::string& topic;
  const std::string& md5sum;
  std::int64_t received;  ///< nanoseconds since the epoch
  std::uint8_t* data;
  std::uint32_t size;
};

using RawMessageVisitor = std::function<void(const RawMessage&)>;

}  // namespace collision_pairs
