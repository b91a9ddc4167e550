// Numbers and names in what users write and read.
#pragma once

#include <cstddef>
#include <limits>
#include <string>
#include <vector>

#include <Eigen/Core>

namespace collision_pairs {

/// The whole text, blanks at its ends apart, as finite numbers; false if it is anything else.
/// Independent of the locale.
bool parseNumber(const std::string& text, double& value);
bool parseVector3(const std::string& text, Eigen::Vector3d& value);

/// The one of `names` that takes the fewest letters inserted, removed or replaced to become `given`
/// (Levenshtein 1965); the first of several, empty if there are none within `most_edits`.
std::string nearestName(const std::string& given, const std::vector<std::string>& names,
                        std::size_t most_edits = std::numeric_limits<std::size_t>::max() - 1);

/// "0.25 s"
std::string inWords(double seconds);

}  // namespace collision_pairs
