// Limiters for the simulation.
#pragma once

#include <memory>

#include "limiter_simulation.h"

namespace collision_pairs {

/// Our law, for one run.
Limiter lawLimiter(std::shared_ptr<LimiterLaw> law,
                   std::shared_ptr<CertifiedSurroundings> surroundings);

/// The law with the node's rules: a decision is made for 20 ms from now, is published when it is
/// there, and recorded then; in place of one that takes longer, zeros. For one run.
Limiter nodeLimiter(std::shared_ptr<LimiterLaw> law,
                    std::shared_ptr<CertifiedSurroundings> surroundings, RandomInputs& random);

/// MoveIt Servo's (moveit_servo/src/collision_check.cpp): from the nearest distance at the joint
/// state of the cycle, with its default thresholds.
Limiter servoLimiter(std::shared_ptr<CertifiedSurroundings> surroundings);

}  // namespace collision_pairs
