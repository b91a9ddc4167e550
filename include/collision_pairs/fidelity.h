// The ladder of geometries that can decide.
#pragma once

#include <string>

namespace collision_pairs {

/// Which geometry decides: a ladder on which each rung encloses the next, so that a coarser one
/// reports every contact that a finer one reports, and its distance is a lower bound.
enum class Fidelity {
  AABB,    ///< the axis-aligned boxes of the broad phase
  OBB,     ///< a box along the axes of each element, and the axis-aligned box as well
  CONVEX,  ///< the convex hull of each element
  MESH     ///< the elements as they are
};

const char* fidelityName(Fidelity fidelity);
/// Throws InputError that lists the known names.
Fidelity parseFidelity(const std::string& name);

}  // namespace collision_pairs
