// The pairs of elements of a scene that joints can move relative to each other.
#pragma once

#include <cstdint>
#include <vector>

#include "collision_pairs/collision_scene.h"

namespace collision_pairs {

/// What a scene says of motions, made once and then only read.
struct MotionPairs {
  explicit MotionPairs(const CollisionScene& scene);

  /// Two elements of links, or of what is attached to links, or one of these and that of a cloud;
  /// the first has the smaller model.
  struct Pair {
    std::uint32_t first;
    std::uint32_t second;
    int frame;  ///< the last body of the robot that carries both; -1: they have W in common
  };
  std::vector<Pair> pairs;

  /// Elements that move and are checked against something static, with these pairs only.
  std::vector<std::uint32_t> beside_static;
  PairFilter static_pairs;

  std::vector<int> body_of;   ///< by element: of the robot; -1 if it never moves
  std::vector<int> depth_of;  ///< by body of the robot: joints that move between it and its root
  int max_depth = 0;
};

}  // namespace collision_pairs
