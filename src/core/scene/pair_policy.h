// The pair rules of a scene: which pairs are checked, and with which padding.
#pragma once

#include <cstdint>
#include <map>
#include <utility>
#include <vector>

#include "collision_pairs/pair_filter.h"
#include "restricted_names.h"
#include "scene_members.h"

namespace collision_pairs {

using ClassPaddings = std::map<std::pair<std::uint32_t, std::uint32_t>, double>;

/// All rules about pairs, in this order: SRDF (or adjacent links) of each robot;
/// the user's rules, of which the last match applies; touch links; the restriction. Evaluated only
/// while a scene is built.
class PairPolicy {
 public:
  /// All must outlive it; `restricted` is null if there is no restriction.
  PairPolicy(const SceneDescription& description, const std::vector<SceneMember>& members,
             const RestrictedNames* restricted);

  /// The classes of the members, and one member of each class; each moving member is a class of its
  /// own. The table is written 64 pairs at a time: O(classes^2 / 64 * (1 + rules) + pairs of the
  /// SRDF).
  PairFilter filter(const std::vector<std::uint32_t>& class_of,
                    const std::vector<std::size_t>& examples) const;

  /// The paddings set for single pairs, by classes, the smaller first; only pairs that `filter`
  /// allows.
  ClassPaddings paddings(const PairFilter& filter, const std::vector<std::size_t>& examples) const;

 private:
  void readSwitchedOff();
  bool isRestricted(std::size_t member) const;
  void switchOffTouching(const std::vector<std::size_t>& examples, PairFilter& filter) const;

  const SceneDescription& description_;
  const std::vector<SceneMember>& members_;
  const RestrictedNames* restricted_;
  std::vector<std::vector<std::uint32_t>> switched_off_;  // by member: the others, sorted
};

}  // namespace collision_pairs
