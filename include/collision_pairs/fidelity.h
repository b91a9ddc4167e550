// The ladder of geometries that can decide.
#pragma once

#include <string>

namespace collision_pairs {

/// The geometry that decides. Each encloses the elements, and AABB encloses all others, so that
/// every contact is reported and distances are lower bounds. AABB, OBB, CONVEX and MESH are a
/// ladder in which each rung encloses the next finer one. SPHERES encloses MESH only; its
/// distances, which are called EXACT too, may be a fifth less than those of the coarser spheres of
/// its trees.
enum class Fidelity {
  AABB,     ///< the axis-aligned boxes of the broad phase
  SPHERES,  ///< up to 1024 spheres that enclose each mesh; other shapes are unchanged
  OBB,      ///< an oriented bounding box of each element, together with its axis-aligned box
  CONVEX,   ///< the convex hull of each element
  MESH      ///< the original elements
};

const char* fidelityName(Fidelity fidelity);
/// Throws InputError that lists the known names.
Fidelity parseFidelity(const std::string& name);

}  // namespace collision_pairs
