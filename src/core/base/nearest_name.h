// Which name was meant, perhaps.
#pragma once

#include <string>
#include <vector>

namespace collision_pairs {

/// The one of `names` that takes the fewest letters inserted, removed or replaced to become `given`
/// (Levenshtein 1965); the first of several, empty if there are none.
std::string nearestName(const std::string& given, const std::vector<std::string>& names);

}  // namespace collision_pairs
