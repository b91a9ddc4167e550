// The pairs of elements of a scene that joints can move relative to each other.
#pragma once

#include <cstdint>
#include <vector>

#include "collision_pairs/collision_scene.h"

namespace collision_pairs {

/// The data of a scene that motions need, built once and then read only.
struct MotionPairs {
  explicit MotionPairs(const CollisionScene& scene);

  /// Two elements of links or attached objects, or one of these and a cloud's; the first has the
  /// smaller model.
  struct Pair {
    std::uint32_t first;
    std::uint32_t second;
    int frame;  ///< the last body of the robot that carries both; -1: only W does
  };
  std::vector<Pair> pairs;
  int frameOf(const RobotModel& robot, const BoxPair& pair) const;

  /// Moving elements that are checked against something static; the filter has only these pairs.
  std::vector<std::uint32_t> beside_static;
  PairFilter static_pairs;

  std::vector<int> body_of;   ///< by element: body of the robot; -1 if static
  std::vector<int> depth_of;  ///< by body of the robot: joints that move between it and its root
  int max_depth = 0;
};

}  // namespace collision_pairs
