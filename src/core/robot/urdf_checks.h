// Validation of a URDF before it is passed to urdfdom.
#pragma once

#include <set>
#include <string>
#include <vector>

namespace collision_pairs {

struct CheckedUrdf {
  std::string xml;  ///< reduced to links, their <collision>s and joints
  /// Joints without their <mimic>: its leader does not exist, has no position, or mimics them.
  std::set<std::string> leader_missing;
};

/// Checks everything that a collision check relies on: names, the tree of links, numbers and
/// geometry. Returns a reduced URDF, so that what this package does not read (visuals, inertias,
/// plugins, …) cannot fail in urdfdom either.
/// urdfdom alone accepts a loop of links that is not connected to the root, and reports invalid
/// numbers without their line. Throws InputError with the line. Adds a warning for each element
/// that is ignored although it appears to be intended, and for each mimic joint without a leader.
CheckedUrdf checkedUrdf(const std::string& xml, std::vector<std::string>& warnings);

}  // namespace collision_pairs
