// Validates the input of a check.
#pragma once

#include "collision_pairs/collision_detector.h"

namespace collision_pairs {

constexpr double MAX_REACH = 1e150;  // metres: the square of what is swept must be finite

/// Throws InputError for settings that are out of range or no number.
void checkSettings(const CheckSettings& settings);

/// The same, and for poses and voxels that are not those of the scene.
void checkInput(const CollisionScene& scene, const BodyPoses& poses, const CheckSettings& settings);

}  // namespace collision_pairs
