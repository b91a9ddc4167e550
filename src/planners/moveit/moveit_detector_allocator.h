// Makes collision environments for MoveIt's planning scenes.
#pragma once

#include <string>

#include <moveit/collision_detection/collision_detector_allocator.h>

#include "moveit_collision_env.h"

namespace collision_pairs {

class MoveitDetectorAllocator
    : public collision_detection::CollisionDetectorAllocatorTemplate<MoveitCollisionEnv,
                                                                     MoveitDetectorAllocator> {
 public:
  const std::string& getName() const override {
    static const std::string name = "CollisionPairs";
    return name;
  }
};

}  // namespace collision_pairs
