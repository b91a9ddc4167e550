// The exact check of the few pairs that the batch stage left open.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "collision_pairs/collision_scene.h"
#include "collision_pairs/sweep_and_prune.h"
#include "pair_ladder.h"

namespace collision_pairs {

/// Holds scratch memory only; one per thread. For verdicts.
class OpenPairs {
 public:
  OpenPairs(std::shared_ptr<const CollisionScene> scene, Fidelity fidelity);

  enum class Outcome { FREE, CONTACT, NOT_SETTLED };
  /// X_RB: as RobotModel::forwardKinematics() gives them. `pairs`: of elements that move;
  /// `beside_static`: elements that are asked against all that is static. NOT_SETTLED: one has no
  /// finite box, or no pair is in contact for certain but one cannot be told: ask the detector.
  Outcome check(const std::vector<Eigen::Isometry3d>& X_RB, const std::vector<BoxPair>& pairs,
                const std::vector<std::uint32_t>& beside_static);
  /// CONTACT: of these elements, by model.
  const BoxPair& contact() const { return contact_; }

 private:
  bool place(std::uint32_t element, const std::vector<Eigen::Isometry3d>& X_RB);
  bool touches(const BoxPair& pair);

  std::shared_ptr<const CollisionScene> scene_;
  const Fidelity fidelity_;
  PairLadder ladder_;
  SweepAndPrune sweep_;
  std::vector<Eigen::Isometry3d> X_WE_;  // one an element
  std::vector<Aabb> boxes_;
  std::vector<std::uint64_t> placed_;  // an element: the state that it is placed for
  std::uint64_t state_ = 0;
  BoxPair contact_{};
  bool is_doubtful_ = false;
};

}  // namespace collision_pairs
