// The ladder of geometries that can decide.
#pragma once

#include <string>

namespace collision_pairs {

/// The geometry that decides: a ladder in which each rung encloses the next finer one. A coarser
/// rung therefore reports every contact of a finer one, and its distance is a lower bound.
enum class Fidelity {
  AABB,    ///< the axis-aligned boxes of the broad phase
  OBB,     ///< an oriented bounding box of each element, together with its axis-aligned box
  CONVEX,  ///< the convex hull of each element
  MESH     ///< the original elements
};

const char* fidelityName(Fidelity fidelity);
/// Throws InputError that lists the known names.
Fidelity parseFidelity(const std::string& name);

}  // namespace collision_pairs
