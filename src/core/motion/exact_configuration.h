// The exact check of single configurations of a motion.
#pragma once

#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include "collision_pairs/collision_detector.h"
#include "motion_state.h"
#include "pair_clearances.h"

namespace collision_pairs {

class ExactConfiguration {
 public:
  /// State and clearances must outlive this.
  ExactConfiguration(const std::shared_ptr<const CollisionScene>& scene, MotionState& state,
                     PairClearances& clearances)
      : scene_(*scene), state_(state), clearances_(clearances), detector_(scene) {}

  /// The settings must outlive the checks.
  void begin(const MotionSettings& settings, const CloudVoxels& voxels);
  /// Whether anything that the motion may not touch is touched, at the state's configuration.
  /// Throws InputError as refuseBox() does.
  bool meets(bool verdict_only);
  /// The same along the motion: its end, which may be a random state, then the middle, the
  /// quarters, …, until one is in contact. Its fraction is written to `at`; the checks are added to
  /// `nb_checks`.
  bool meetsAtSteps(double& at, std::uint32_t& nb_checks);
  /// Of models, in contact there; with verdict_only one of them.
  std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs() const;

 private:
  const CollisionScene& scene_;
  MotionState& state_;
  PairClearances& clearances_;
  const MotionSettings* settings_ = nullptr;
  CollisionDetector detector_;
  BodyPoses poses_;
};

/// Throws InputError: a link is too far away for a finite box.
[[noreturn]] void refuseBox(const CollisionScene& scene, std::uint32_t model);

}  // namespace collision_pairs
