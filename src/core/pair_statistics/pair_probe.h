// One state of the robot, asked pair by pair.
#pragma once

#include <memory>
#include <vector>

#include "collision_pairs/collision_scene.h"
#include "pair_ladder.h"

namespace collision_pairs {

/// Says of single pairs of models whether they touch and how far apart they are. Against a check
/// of all pairs: no depth is measured, which is what costs where links are deep in each other by
/// design. Holds scratch memory: one per thread.
class PairProbe {
 public:
  explicit PairProbe(std::shared_ptr<const CollisionScene> scene);

  /// Moves the robot there; one entry a joint, mimics applied. Throws InputError if a link gets no
  /// finite box. O(elements).
  void place(const std::vector<double>& positions);

  bool touches(std::uint32_t first, std::uint32_t second);

  /// Metres; 0 if they touch, and `limit` if they are at least that far apart. More than touches()
  /// for a pair that does.
  double distance(std::uint32_t first, std::uint32_t second, double limit);

 private:
  std::shared_ptr<const CollisionScene> scene_;
  PairLadder ladder_;
  std::vector<Eigen::Isometry3d> X_RB_;  // one a body of the robot
  std::vector<Eigen::Isometry3d> X_WE_;  // one an element
  std::vector<Aabb> boxes_;              // beside X_WE_
};

}  // namespace collision_pairs
