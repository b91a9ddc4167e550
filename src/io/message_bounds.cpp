#include "message_bounds.h"

#include <cstring>

namespace collision_pairs {
namespace {

constexpr std::uint64_t STAMP_AND_NUMBER = 12;    // bytes of a header before its frame
constexpr std::uint64_t SMALLEST_TRANSFORM = 76;  // bytes: two empty names, seven doubles
constexpr int NB_ARRAYS_OF_DOUBLES = 3;           // position, velocity, effort

/// Walks over a serialized message. Each step is false if the message is not that long.
class Walk {
 public:
  Walk(const std::uint8_t* data, std::uint32_t size) : data_(data), left_(size) {}
  bool skip(std::uint64_t bytes) {
    if (bytes > left_) return false;
    data_ += bytes;
    left_ -= bytes;
    return true;
  }
  bool count(std::uint32_t& number, std::uint64_t smallest) {
    if (left_ < sizeof number) return false;
    std::memcpy(&number, data_, sizeof number);
    return skip(sizeof number) && number * smallest <= left_;
  }
  bool skipArray(std::uint64_t entry) {
    std::uint32_t number;
    return count(number, entry) && skip(number * entry);
  }

 private:
  const std::uint8_t* data_;
  std::uint64_t left_;
};

}  // namespace

bool jointStateFits(const std::uint8_t* data, std::uint32_t size) {
  Walk walk(data, size);
  std::uint32_t nb_names;
  if (!walk.skip(STAMP_AND_NUMBER) || !walk.skipArray(1) || !walk.count(nb_names, 4)) return false;
  for (std::uint32_t i = 0; i < nb_names; ++i) {
    if (!walk.skipArray(1)) return false;
  }
  for (int i = 0; i < NB_ARRAYS_OF_DOUBLES; ++i) {
    if (!walk.skipArray(sizeof(double))) return false;
  }
  return true;
}

bool tfMessageFits(const std::uint8_t* data, std::uint32_t size) {
  std::uint32_t nb_transforms;
  return Walk(data, size).count(nb_transforms, SMALLEST_TRANSFORM);
}

}  // namespace collision_pairs
