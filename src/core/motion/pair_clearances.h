// What each pair of a motion has to keep.
#pragma once

#include "collision_pairs/motion_check.h"

namespace collision_pairs {

class PairClearances {
 public:
  /// Both must outlive this; begin() with the settings of each check: throws InputError for those
  /// out of range.
  explicit PairClearances(const CollisionScene& scene) : scene_(scene) {}
  void begin(const MotionSettings& settings);

  /// Metres, for two models; negative: left out. Throws InputError if the settings say more than
  /// their clearance.
  double of(std::uint32_t model_a, std::uint32_t model_b);
  double ofElements(const BoxPair& pair) {
    const auto& elements = scene_.elements();
    return of(elements[pair.first].model, elements[pair.second].model);
  }
  bool mayLeaveOut() const { return settings_->clearance_of != nullptr; }
  /// Of all pairs of the scene, if of() has said so of all that it was asked about.
  bool leavesOutAll();

 private:
  const CollisionScene& scene_;
  const MotionSettings* settings_ = nullptr;
  bool keeps_some_ = false;  // as far as it was asked
};

}  // namespace collision_pairs
