// Limiters for the simulation.
#pragma once

#include <memory>

#include "limiter_simulation.h"

namespace collision_pairs {

/// Our law, for one run.
Limiter lawLimiter(std::shared_ptr<LimiterLaw> law,
                   std::shared_ptr<CertifiedSurroundings> surroundings);

/// MoveIt Servo's (moveit_servo/src/collision_check.cpp): from the nearest distance at the joint
/// state of the cycle, with its default thresholds.
Limiter servoLimiter(std::shared_ptr<CertifiedSurroundings> surroundings);

}  // namespace collision_pairs
