// The point of a mesh's surface that is nearest to a point.
#pragma once

#include <Eigen/Core>

#include "prepared_mesh.h"

namespace collision_pairs {

/// In the mesh's frame. At least one triangle. Cost: O(log n) near the surface, up to O(n) far
/// from a round one; allocates nothing.
Eigen::Vector3d closestOnMesh(const PreparedMesh& mesh, const Eigen::Vector3d& point);

/// Is the point within `tolerance` of the part of the surface that is below node `root` of the
/// tree?
bool isOnMesh(const PreparedMesh& mesh, std::uint32_t root, const Eigen::Vector3d& point,
              double tolerance);

}  // namespace collision_pairs
