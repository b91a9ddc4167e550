// From boxes to the small records that are sorted and swept.
#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "collision_pairs/aabb.h"
#include "sweep_kernel.h"

namespace collision_pairs {

/// The map that narrows boxes relative to `origin`, grown by `growth` metres to each side.
NarrowMap makeNarrowMap(const Eigen::Vector3d& origin, double growth);

/// Narrows boxes; box i gets the tag i. `out` has room for all of them.
void narrowBoxes(const SweepKernel& kernel, const NarrowMap& map, const std::vector<Aabb>& boxes,
                 const std::uint32_t* models, Record* out);

/// The median, axis by axis, of the centres of the first, the middle and the last box: in the
/// midst of the scene even if one of them is a half-space or far off.
Eigen::Vector3d sceneOrigin(const std::vector<Aabb>& boxes);

/// How far apart on one axis two boxes may be, metres, if squaredReach() may still accept them:
/// alarm_distance and a margin that covers every rounding of that test.
inline double axisReach(double alarm_distance) { return alarm_distance * (1.0 + 0x1p-40) + 1e-160; }

}  // namespace collision_pairs
