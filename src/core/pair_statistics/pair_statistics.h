// Which links meet in random states, how often, and how near the others come.
#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <vector>

#include "collision_pairs/collision_scene.h"
#include "joint_sampler.h"

namespace collision_pairs {

/// What is known of two models of a scene, first < second.
struct PairEvidence {
  std::uint32_t first = 0;
  std::uint32_t second = 0;
  bool adjacent = false;         ///< adjacent links (RobotModel::adjacentLinks)
  bool rigid = false;            ///< of one body: what holds in one state holds in all
  bool touches_at_zero = false;  ///< at RobotModel::zeroPositions()
  std::uint64_t trials = 0;      ///< random states in which it was asked; 1 if rigid
  std::uint64_t contacts = 0;    ///< those of them in which the two touch
  /// Metres: the smallest distance that was found where it was measured, at most 1 % above the
  /// smallest there; 0 after a contact. Infinite for adjacent pairs without one.
  double nearest = std::numeric_limits<double>::infinity();
  std::uint64_t nearest_state = 0;
  /// The positions of all joints in a contact that a search found and random states did not show;
  /// empty: there is none.
  std::vector<double> found_state;
};

struct SamplingSettings {
  std::uint64_t samples = 0;  ///< the states 0 … samples - 1 of the sampler
  unsigned threads = 0;       ///< 0: as many as the machine has
  /// Called now and then, by one thread at a time; may be empty.
  std::function<void(std::uint64_t done)> progress;
};

/// In the first so many states distances are measured, and adjacent pairs are asked at all: a few
/// states show what there is to know of a pair that one joint moves, and a close start is all that
/// a search wants.
constexpr std::uint64_t MEASURED_STATES = 1024;

/// Asks every pair that the scene's filter allows; sorted. The answer does not depend on the
/// number of threads. Cost a state: O(elements + pairs) for the boxes, and a narrow query for each
/// pair whose boxes meet. Throws InputError.
std::vector<PairEvidence> countContacts(const std::shared_ptr<const CollisionScene>& scene,
                                        const JointSampler& sampler,
                                        const SamplingSettings& settings);

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
