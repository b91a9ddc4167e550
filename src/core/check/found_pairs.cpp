#include "found_pairs.h"

#include <algorithm>
#include <numeric>
#include <tuple>

#include "unknown_because.h"

namespace collision_pairs {
namespace {

PairState stateOf(const PairDistance& found) {
  if (found.certainty == Certainty::UNFINISHED) return PairState::UNRESOLVED;
  if (!found.touches()) return PairState::NEAR;
  return found.certainty == Certainty::DEGRADED ? PairState::UNRESOLVED : PairState::CONTACT;
}

/// Merges another pair of elements of the same two models.
void mergeInto(PairReport& pair, const PairReport& other) {
  const auto weight = [](PairState state) {
    return state == PairState::CONTACT ? 2 : state == PairState::UNRESOLVED ? 1 : 0;
  };
  if (weight(other.state) > weight(pair.state)) pair.state = other.state;
  ++pair.nb_contacts;
  if (other.distance >= pair.distance) return;
  pair.distance = other.distance;
  pair.certainty = other.certainty;
  pair.fidelity = other.fidelity;
}

/// Why the report cannot be FREE, given that no pair is in contact.
std::vector<std::string> whyUnknown(const CollisionScene& scene, const CollisionReport& report,
                                    const std::vector<std::string>& reasons) {
  const auto& models = scene.models();
  std::vector<std::string> bodies, clouds, pairs;
  for (const std::uint32_t id : report.left_out) {
    (scene.cloudOf(models[id].first_element) >= 0 ? clouds : bodies).push_back(models[id].name);
  }
  for (const PairReport& pair : report.pairs) {
    // A positive lower bound proves that the two are apart.
    if (!pair.mayTouch()) continue;
    pairs.push_back(pairName(scene, pair.first, pair.second));
  }
  return unknownBecause(scene, report.unchecked,
                        {{"no usable pose", bodies},
                         {"clouds that are unknown or incomplete", clouds},
                         {"unresolved pairs that may be in contact", pairs}},
                        reasons);
}

}  // namespace

void FoundPairs::clear() {
  pairs_.clear();
  contacts_.clear();
}

PairState FoundPairs::add(const CollisionScene& scene, const BoxPair& pair,
                          const PairDistance& found, Fidelity rung, const Eigen::Vector3i& voxel) {
  PairReport entry;
  entry.first = scene.elements()[pair.first].model;
  entry.second = scene.elements()[pair.second].model;
  entry.state = stateOf(found);
  entry.distance = found.distance;
  entry.fidelity = rung;
  entry.certainty = found.certainty;
  entry.first_contact = 0;
  entry.nb_contacts = 1;
  pairs_.push_back(entry);
  contacts_.push_back(contactOf(pair, found, voxel));
  return entry.state;
}

SmallestDistance FoundPairs::smallestDistance() const {
  SmallestDistance smallest;
  for (const PairReport& pair : pairs_) smallest.offer(pair.distance, pair.certainty);
  return smallest;
}

void FoundPairs::sortByModels() {
  order_.resize(pairs_.size());
  std::iota(order_.begin(), order_.end(), 0u);
  const auto key = [&](std::uint32_t i) {
    return std::make_tuple(pairs_[i].first, pairs_[i].second, contacts_[i].elements.first,
                           contacts_[i].elements.second);
  };
  std::sort(order_.begin(), order_.end(),
            [&](std::uint32_t i, std::uint32_t j) { return key(i) < key(j); });
}

void FoundPairs::assemble(const CollisionScene& scene, bool has_pairs, bool with_contacts,
                          const std::vector<std::string>& reasons, CollisionReport& report) {
  sortByModels();
  auto& pairs = report.pairs;
  pairs.clear();
  report.contacts.clear();
  for (const std::uint32_t i : order_) {
    const PairReport& found = pairs_[i];
    if (pairs.empty() || pairs.back().first != found.first || pairs.back().second != found.second) {
      pairs.push_back(found);
      pairs.back().first_contact = static_cast<std::uint32_t>(report.contacts.size());
    } else {
      mergeInto(pairs.back(), found);
    }
    if (with_contacts) report.contacts.push_back(contacts_[i]);
  }
  const bool is_in_contact = std::any_of(pairs.begin(), pairs.end(), [](const PairReport& pair) {
    return pair.state == PairState::CONTACT;
  });
  report.unknown_because.clear();
  if (!is_in_contact) report.unknown_because = whyUnknown(scene, report, reasons);
  report.verdict = verdictOf(is_in_contact, !report.unknown_because.empty());
  report.in_collision = report.verdict != Verdict::FREE;
  SmallestDistance smallest{report.min_distance, report.min_distance_is_bound};
  for (PairReport& pair : pairs) {
    if (!with_contacts) pair.nb_contacts = 0;
    smallest.offer(pair.distance, pair.certainty);
  }
  // Infinity, or the alarm distance, would say that something is known to be that far away.
  if (!has_pairs && !scene.mayBeFree(report.unchecked)) smallest = {0.0, true};
  if (report.ended_early && with_contacts) smallest.is_bound = true;
  report.min_distance = smallest.metres;
  report.min_distance_is_bound = smallest.is_bound;
  if (smallest.is_bound || !with_contacts) {
    report.nearest.reset();
  } else if (!report.nearest) {
    const auto pair = std::find_if(pairs.begin(), pairs.end(), [&](const PairReport& found) {
      return found.distance == smallest.metres;
    });
    report.nearest = *report.nearestContact(*pair);
  }
}

}  // namespace collision_pairs
