// Which links touch in random states, how often, and the smallest distances of the others.
#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "collision_pairs/collision_scene.h"
#include "joint_sampler.h"

namespace collision_pairs {

/// Statistics of two models of a scene, first < second.
struct PairEvidence {
  std::uint32_t first = 0;
  std::uint32_t second = 0;
  bool adjacent = false;         ///< adjacent links (RobotModel::adjacentLinks)
  bool rigid = false;            ///< of one body: all states are equal
  bool touches_at_zero = false;  ///< at RobotModel::zeroPositions()
  bool is_near_at_zero = false;  ///< there within SamplingSettings::clearance
  /// JointSampler::drawnInPartBetween() the two: what is seen says nothing of their other
  /// positions.
  std::set<std::string> not_moved;
  std::uint64_t trials = 0;    ///< random states in which it was queried; 1 if rigid
  std::uint64_t contacts = 0;  ///< those of them in which the two touch
  /// Metres: the smallest measured distance, at most 1 % above the true minimum of the measured
  /// states, and within SamplingSettings::clearance if that of any random state is; 0 after a
  /// contact. Infinite for adjacent pairs without contact.
  double nearest = std::numeric_limits<double>::infinity();
  std::uint64_t nearest_state = 0;
  /// Positions of all joints in a contact found by a search but not by random states; empty if
  /// there is none.
  std::vector<double> found_state;
};

struct SamplingSettings {
  std::uint64_t samples = 0;  ///< the states 0 … samples - 1 of the sampler
  unsigned threads = 0;       ///< 0: one per core
  /// Called occasionally, by one thread at a time; may be empty.
  std::function<void(std::uint64_t done)> progress;
  /// Metres: whether a pair comes this near is looked at in all states.
  double clearance = 0.0;
};

/// Distances are measured, and adjacent pairs queried, only in this many states at the beginning: a
/// few states suffice for a pair that one joint moves, and a search needs only a near start.
constexpr std::uint64_t MEASURED_STATES = 1024;

/// Queries every pair that the scene's filter allows; sorted. The result does not depend on the
/// number of threads. Cost per state: O(elements + pairs) for the boxes, and a narrow query for
/// each pair whose boxes overlap. Throws InputError.
std::vector<PairEvidence> countContacts(const std::shared_ptr<const CollisionScene>& scene,
                                        const JointSampler& sampler,
                                        const SamplingSettings& settings);

struct SearchSettings {
  unsigned searches = 0;  ///< per pair, each with a different start
  /// The sampler's states from this one on are free, one for each pair.
  std::uint64_t first_free_state = 0;
  unsigned threads = 0;                                    ///< 0: one per core
  std::function<void(std::uint64_t pairs_done)> progress;  ///< as in SamplingSettings
};

/// Moves the joints between two links that never touched from near states to nearer ones: random
/// steps, keeping the better state, with the one-fifth success rule for their size (Rechenberg:
/// Evolutionsstrategie, 1973), as long as two hundred of them reduce the distance by a hundredth.
/// The first search of a pair starts where it was nearest, each other one at the nearest of a
/// hundred new states. Lowers `nearest`, and stores the state if that becomes 0.
///
/// It proves contacts, not their absence: a search may end in a local minimum. The result does not
/// depend on the number of threads. Cost for each pair without contact: some hundreds of states per
/// search, of O(joints) and a narrow query each.
void searchContacts(const std::shared_ptr<const CollisionScene>& scene, const JointSampler& sampler,
                    const SearchSettings& settings, std::vector<PairEvidence>& pairs);

}  // namespace collision_pairs
