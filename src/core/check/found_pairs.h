// Merges results for pairs of elements into one entry per pair of models.
//
// This folder checks one state (CollisionDetector). In the order of a check:
// - check_input: are settings and poses valid?
// - collision_detector.cpp: places the elements, sweeps their boxes, settles the pairs.
// - ignored_pairs: which pairs does the caller leave out?
// - element_boxes: where are the elements in this cycle, and what are their boxes?
// - minimum_search.cpp: which pairs can have the smallest distance, and what is it?
// - cloud_pairs.cpp: which elements are near which clouds, and how near?
// - found_pairs: what is reported of two models whose elements were found?
// - unknown_because.h: what speaks against FREE, in words?
#pragma once

#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "collision_pairs/collision_report.h"
#include "collision_pairs/collision_scene.h"

namespace collision_pairs {

/// The smallest of the offered distances.
struct SmallestDistance {
  double metres = std::numeric_limits<double>::infinity();
  bool is_bound = true;  ///< a lower bound; no known pair has this distance

  /// True if it is smaller than all before, or as small, and the first that is not a bound.
  bool offer(double distance, Certainty certainty) {
    const bool bound = certainty == Certainty::UNFINISHED || certainty == Certainty::DEGRADED;
    if (distance > metres || (distance == metres && (bound || !is_bound))) return false;
    metres = distance;
    is_bound = bound;
    return true;
  }
};

/// `pair`: elements, by model. Points and normal of `found` in W.
inline Contact contactOf(const BoxPair& pair, const PairDistance& found,
                         const Eigen::Vector3i& voxel = Eigen::Vector3i::Zero()) {
  return {found.p_ACa, found.p_ACb, found.nhat_AB_A, -found.distance, pair, voxel};
}

/// Collects the results of a check, in any order, and writes them to the report, sorted.
class FoundPairs {
 public:
  void clear();

  /// `pair`: elements, by model. Points and normal of `found` in W.
  PairState add(const CollisionScene& scene, const BoxPair& pair, const PairDistance& found,
                Fidelity rung, const Eigen::Vector3i& voxel);

  SmallestDistance smallestDistance() const;

  /// Fills in pairs, contacts (if wanted) and the verdict with its reasons, and lowers min_distance
  /// to the smallest found; sets `nearest`, if it is not set, to what has that distance. left_out,
  /// unchecked and ended_early must be set before. `has_pairs`: there was a pair to check.
  /// O(n log n).
  void assemble(const CollisionScene& scene, bool has_pairs, bool with_contacts,
                const std::vector<std::string>& reasons, CollisionReport& report);

 private:
  void sortByModels();

  std::vector<PairReport> pairs_;  // one per element pair
  std::vector<Contact> contacts_;  // parallel to pairs_
  std::vector<std::uint32_t> order_;
};

}  // namespace collision_pairs
