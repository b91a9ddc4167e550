// What must hold of a URDF before it is handed to urdfdom.
#pragma once

#include <string>
#include <vector>

namespace collision_pairs {

/// Checks everything that a collision check will rely on: names, the tree of links, numbers and
/// geometry. Returns the URDF reduced to links, their <collision>s and joints, so that what
/// this package does not read (visuals, inertias, plugins, …) cannot fail in urdfdom either.
/// urdfdom alone accepts a loop of links beside the root, and reports numbers without their line.
/// Throws InputError with the line. Adds to `warnings` what is passed over although somebody meant
/// something by it.
std::string checkedUrdf(const std::string& xml, std::vector<std::string>& warnings);

}  // namespace collision_pairs
