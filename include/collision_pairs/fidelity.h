// The ladder of geometries that can decide.
#pragma once

#include <string>

namespace collision_pairs {

/// Which geometry decides. All enclose the elements, and AABB all others, so that what is in
/// contact is reported to be, and distances are lower bounds. AABB, OBB, CONVEX and MESH are a
/// ladder on which each rung encloses the next; the balls of SPHERES enclose MESH only, and need
/// not be enclosed by a rung between.
enum class Fidelity {
  AABB,     ///< the axis-aligned boxes of the broad phase
  SPHERES,  ///< up to 1024 balls about each mesh; what is no mesh as it is
  OBB,      ///< a box along the axes of each element, and the axis-aligned box as well
  CONVEX,   ///< the convex hull of each element
  MESH      ///< the elements as they are
};

const char* fidelityName(Fidelity fidelity);
/// Throws InputError that lists the known names.
Fidelity parseFidelity(const std::string& name);

}  // namespace collision_pairs
