// Numbers in texts that users write.
#pragma once

#include <string>

#include <Eigen/Core>

namespace collision_pairs {

/// The whole text, blanks at its ends apart, as finite numbers; false if it is anything else.
/// Independent of the locale.
bool parseNumber(const std::string& text, double& value);
bool parseVector3(const std::string& text, Eigen::Vector3d& value);

}  // namespace collision_pairs
