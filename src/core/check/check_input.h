// Validates the input of a check.
#pragma once

#include "collision_pairs/collision_detector.h"

namespace collision_pairs {

constexpr double MAX_REACH = 1e150;  // metres: squares of coordinates must be finite

/// Throws InputError for settings that are out of range or not a number.
void checkSettings(const CheckSettings& settings);

/// Throws InputError for voxels that do not match the scene's clouds.
void checkVoxels(const CollisionScene& scene, const CloudVoxels& voxels);

/// Both, and for poses that do not match the scene.
void checkInput(const CollisionScene& scene, const BodyPoses& poses, const CheckSettings& settings);

}  // namespace collision_pairs
