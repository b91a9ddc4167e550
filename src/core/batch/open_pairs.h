// The exact check of the few pairs that the batch stage left open.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "collision_pairs/collision_scene.h"
#include "collision_pairs/sweep_and_prune.h"
#include "pair_ladder.h"
#include "solid_pairs.h"

namespace collision_pairs {

/// For verdicts. SolidPairs is asked about all pairs that move first: it tells a contact at a tenth
/// of the cost; only what it leaves open needs the exact check. Holds scratch memory only; one per
/// thread.
class OpenPairs {
 public:
  /// `solids` must outlive it.
  OpenPairs(std::shared_ptr<const CollisionScene> scene, Fidelity fidelity,
            const SolidPairs& solids);

  enum class Outcome { FREE, CONTACT, NOT_SETTLED };
  /// `positions`: as for RobotModel::forwardKinematics(). `pairs`: of moving elements;
  /// `beside_static`: moving elements to be checked against all static ones. Only the bodies of
  /// these and their ancestors are placed. NOT_SETTLED: an element has no finite box, or no pair is
  /// certainly in contact but one is undecided: use the detector.
  Outcome check(const std::vector<double>& positions, const std::vector<BoxPair>& pairs,
                const std::vector<std::uint32_t>& beside_static);
  /// For CONTACT: the elements, by model.
  const BoxPair& contact() const { return contact_; }

 private:
  bool place(std::uint32_t element, const std::vector<double>& positions);
  const Eigen::Isometry3d& placeBody(int body, const std::vector<double>& positions);
  bool touches(const BoxPair& pair);

  std::shared_ptr<const CollisionScene> scene_;
  const Fidelity fidelity_;
  const SolidPairs& solids_;
  PairLadder ladder_;
  SweepAndPrune sweep_;
  std::vector<Eigen::Isometry3d> X_WB_;       // one per body of the robot
  std::vector<std::uint64_t> placed_bodies_;  // by body: the state for which it was placed
  std::vector<Eigen::Isometry3d> X_WE_;       // one per element
  std::vector<Aabb> boxes_;
  std::vector<std::uint64_t> placed_;  // by element: the state for which it was placed
  std::uint64_t state_ = 0;
  std::vector<BoxPair> open_;
  BoxPair contact_{};
  bool is_uncertain_ = false;
};

}  // namespace collision_pairs
