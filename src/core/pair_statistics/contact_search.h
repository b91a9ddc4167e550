// Looks for contacts where random states are too rare to show them.
#pragma once

#include <vector>

#include "pair_statistics.h"

namespace collision_pairs {

struct SearchSettings {
  unsigned searches = 0;  ///< for each pair, each from a start of its own
  /// The sampler's states from this one on are free, one for each pair.
  std::uint64_t first_free_state = 0;
  unsigned threads = 0;                                    ///< 0: as many as the machine has
  std::function<void(std::uint64_t pairs_done)> progress;  ///< as in SamplingSettings
};

/// Moves the joints between two links that never touched from near states to nearer ones: random
/// steps, the better of two kept, their size by the rule of one success in five (Rechenberg:
/// Evolutionsstrategie, 1973), as long as two hundred of them still win a hundredth. The first
/// search of a pair begins where it was nearest, each other one with the nearest of a hundred new
/// states. Lowers `nearest`, and tells the state where that is 0.
///
/// It proves contacts, not their absence: each search may end where no neighbouring state is
/// nearer. The answer does not depend on the number of threads. Cost for each pair without
/// contact: some hundreds of states a search, of O(elements) and a narrow query each.
void searchContacts(const std::shared_ptr<const CollisionScene>& scene, const JointSampler& sampler,
                    const SearchSettings& settings, std::vector<PairEvidence>& pairs);

}  // namespace collision_pairs
