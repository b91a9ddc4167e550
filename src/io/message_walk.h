// Validates the lengths in a serialized message.
#pragma once

#include <cstdint>
#include <cstring>

namespace collision_pairs {

/// Walks over a serialized message. Each step is false if the message is not that long.
///
/// roscpp allocates as many array entries as a message claims before it checks that they exist:
/// four wrong bytes can request gigabytes. All arrays are therefore checked first.
class Walk {
 public:
  Walk(const std::uint8_t* data, std::uint32_t size) : data_(data), left_(size) {}
  bool skip(std::uint64_t bytes) {
    if (bytes > left_) return false;
    data_ += bytes;
    left_ -= bytes;
    return true;
  }
  /// Reads the number of entries of an array, each of at least that many bytes.
  bool count(std::uint32_t& number, std::uint64_t smallest) {
    if (left_ < sizeof number) return false;
    std::memcpy(&number, data_, sizeof number);
    return skip(sizeof number) && number * smallest <= left_;
  }
  /// Skips an array of entries of that many bytes.
  bool skipArray(std::uint64_t entry) {
    std::uint32_t number;
    return count(number, entry) && skip(number * entry);
  }

  /// Skips a std_msgs/Header: number, stamp, frame.
  bool skipHeader() { return skip(STAMP_AND_NUMBER) && skipArray(1); }

 private:
  static constexpr std::uint64_t STAMP_AND_NUMBER = 12;  // bytes

  const std::uint8_t* data_;
  std::uint64_t left_;
};

}  // namespace collision_pairs
