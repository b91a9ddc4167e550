// Sorts pairs of ids by (first, second).
#pragma once

#include <cstdint>
#include <vector>

#include "collision_pairs/sweep_and_prune.h"

namespace collision_pairs {

/// Radix sort, least significant digit first: by the second ids and then by the first. All ids
/// are below `nb_ids`. O(pairs), without a branch that depends on them; `scratch` lends memory
/// and its contents are lost.
void sortPairs(std::vector<BoxPair>* pairs, std::size_t nb_ids, std::vector<BoxPair>* scratch);

}  // namespace collision_pairs
