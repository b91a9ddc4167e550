// The point of a mesh's surface that is nearest to a point.
#pragma once

#include <Eigen/Core>

#include "prepared_shape.h"

namespace collision_pairs {

/// In the mesh's frame. At least one triangle. Cost: O(log n) near the surface, up to O(n) far
/// from a round one; allocates nothing.
Eigen::Vector3d closestOnMesh(const PreparedMesh& mesh, const Eigen::Vector3d& point);

}  // namespace collision_pairs
