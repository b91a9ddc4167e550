// What must hold of a description before a scene is made of it.
#pragma once

#include "collision_pairs/scene_description.h"

namespace collision_pairs {

/// Throws InputError if two links or objects have one name (but for links of the world without
/// geometry), or if an object or a setting names a
/// link that is nowhere; the error says which one is meant, perhaps. Patterns may match nothing:
/// what they mean may come later.
void checkNames(const SceneDescription& description, const RobotModel& merged);

/// Throws InputError for a padding that is negative or not finite, and for too few hull vertices.
void checkSizes(const SceneDescription& description);

}  // namespace collision_pairs
