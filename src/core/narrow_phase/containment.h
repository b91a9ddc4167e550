// Is a solid, whose surface does not meet that of a mesh, inside it?
#pragma once

#include "prepared_shape.h"

namespace collision_pairs {

/// A is a mesh; is the point in one of its parts that enclose space? Cost: 0.2 us outside of the
/// hull, else as WindingNumber::holds().
bool meshHoldsPoint(const Prepared& A, const Eigen::Vector3d& p_AQ);

/// Is a part of the mesh B, or all of it, inside the mesh A?
bool meshHoldsMesh(const Prepared& A, const Prepared& B, const Eigen::Isometry3d& X_AB);

/// Is the convex B inside the mesh A?
bool meshHoldsConvex(const Prepared& A, const Prepared& B, const Eigen::Isometry3d& X_AB);

}  // namespace collision_pairs
