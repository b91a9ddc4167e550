// What each pair of a motion has to keep.
#pragma once

#include "collision_pairs/motion_check.h"
#include "motion_state.h"

namespace collision_pairs {

class PairClearances {
 public:
  /// Both must outlive this; begin() with the settings of each check: throws InputError for those
  /// out of range.
  PairClearances(const CollisionScene& scene, MotionState& state) : scene_(scene), state_(state) {}
  void begin(const MotionSettings& settings);

  /// Metres, for two models that the motion moves; negative: left out. Throws InputError if the
  /// settings say more than their clearance.
  double of(std::uint32_t model_a, std::uint32_t model_b);
  double ofElements(const BoxPair& pair) {
    const auto& elements = scene_.elements();
    return of(elements[pair.first].model, elements[pair.second].model);
  }
  bool mayLeaveOut() const { return settings_->clearance_of || settings_->only_moved; }
  /// Whether the settings leave out two models. O(pairs of elements) with only_moved.
  bool leaveOut(std::uint32_t model_a, std::uint32_t model_b);
  /// All pairs of the scene.
  bool leaveOutAll();
  /// Metres that every pair keeps, but those left out.
  double least() const { return settings_->clearance_of ? 0.0 : settings_->clearance; }

 private:
  const CollisionScene& scene_;
  MotionState& state_;
  const MotionSettings* settings_ = nullptr;
  bool keeps_some_ = false;  // as far as of() was asked
};

}  // namespace collision_pairs
