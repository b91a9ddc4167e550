// Queries single pairs at one state of the robot.
#pragma once

#include <memory>
#include <utility>
#include <vector>

#include "collision_pairs/collision_scene.h"
#include "pair_ladder.h"

namespace collision_pairs {

/// Contact and distance of single pairs of models. Unlike a check of all pairs it computes no
/// depth, which is expensive for links that penetrate deeply by design. Holds scratch memory: one
/// per thread.
class PairProbe {
 public:
  explicit PairProbe(std::shared_ptr<const CollisionScene> scene);

  /// Sets the state; one entry per joint, mimic joints applied. Throws InputError if a link has no
  /// finite box. O(elements).
  void place(const std::vector<double>& positions);

  /// The same for queries of this pair alone; all others are undefined until place(). O(bodies
  /// between the two and the root, and their elements): a search spends nothing on other links.
  void placePair(std::uint32_t first, std::uint32_t second, const std::vector<double>& positions);

  bool touches(std::uint32_t first, std::uint32_t second);

  /// Metres; 0 if they touch, and `limit` if they are at least that far apart. For touching pairs
  /// more expensive than touches().
  double distance(std::uint32_t first, std::uint32_t second, double limit);

 private:
  void placeElement(std::size_t element);
  std::vector<int> movingBodiesAbove(std::uint32_t first, std::uint32_t second) const;

  std::shared_ptr<const CollisionScene> scene_;
  PairLadder ladder_;
  std::vector<Eigen::Isometry3d> X_RB_;                 // one per body of the robot
  std::vector<Eigen::Isometry3d> X_WE_;                 // one per element
  std::vector<Aabb> boxes_;                             // parallel to X_WE_
  std::pair<std::uint32_t, std::uint32_t> pair_{0, 0};  // whose bodies are in chain_
  std::vector<int> chain_;                              // of the robot, parents first
};

}  // namespace collision_pairs
