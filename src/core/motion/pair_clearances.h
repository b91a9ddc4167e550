// What each pair of a motion has to keep.
#pragma once

#include <utility>
#include <vector>

#include "collision_pairs/motion_check.h"

namespace collision_pairs {

class PairClearances {
 public:
  /// Both must outlive this; begin() with the settings of each check: throws InputError for those
  /// out of range.
  explicit PairClearances(const CollisionScene& scene) : scene_(scene) {}
  void begin(const MotionSettings& settings, const PlacedBodies& placed);

  /// Metres, for a pair of elements; `is_beside`: the robot does not carry both. Negative: left
  /// out.
  double of(const BoxPair& elements, bool is_beside) const;
  bool leavesOutSome() const { return !left_out_.empty(); }
  /// Models, first < second.
  bool leavesOut(std::uint32_t first, std::uint32_t second) const;
  bool leavesOutAll() const;

 private:
  const CollisionScene& scene_;
  std::vector<int> carriers_;  // by model, if links keep a distance of their own
  const MotionSettings* settings_ = nullptr;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> left_out_;  // sorted
};

}  // namespace collision_pairs
