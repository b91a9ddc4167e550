// The inputs of one narrow-phase query as text, to the last bit.
#pragma once

#include <istream>
#include <string>

#include <Eigen/Geometry>

#include "collision_pairs/shape.h"

namespace collision_pairs {

/// A query that can be asked again: NarrowPhase::distance(A, B, X_AB, max_distance).
struct Replay {
  Shape A, B;
  Eigen::Isometry3d X_AB;
  double max_distance;
};

/// Lines of words and hexadecimal floating point numbers: "collision_pairs_replay 1", the two
/// shapes (meshes with all vertices and triangles), the pose row by row, max_distance, "end".
std::string writeReplay(const Replay& replay);

/// Reads one record back, bit for bit. Throws std::runtime_error that says what was expected and
/// what was found.
Replay readReplay(std::istream& in);

}  // namespace collision_pairs
