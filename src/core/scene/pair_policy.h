// The pair rules of a scene: which pairs are checked, and with which padding.
#pragma once

#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "collision_pairs/pair_filter.h"
#include "scene_members.h"

namespace collision_pairs {

using ClassPaddings = std::map<std::pair<std::uint32_t, std::uint32_t>, double>;

/// All rules about pairs, in this order: SRDF (or adjacent links) of each robot;
/// the user's rules, of which the last match applies; touch links; the restriction. Evaluated only
/// while a scene is built.
class PairPolicy {
 public:
  /// Both must outlive it. Throws InputError if the restriction names an unknown group.
  PairPolicy(const SceneDescription& description, const std::vector<SceneMember>& members);

  /// Static members with equal keys belong to one class.
  std::string signature(std::size_t member) const;

  /// The classes of the members, and one member of each class; each moving member is a class of its
  /// own. The table is written 64 pairs at a time: O(classes^2 / 64 * (1 + rules) + pairs of the
  /// SRDF).
  PairFilter filter(const std::vector<std::uint32_t>& class_of,
                    const std::vector<std::size_t>& examples) const;

  /// The paddings set for single pairs, by classes, the smaller first; only pairs that `filter`
  /// allows.
  ClassPaddings paddings(const PairFilter& filter, const std::vector<std::size_t>& examples) const;

 private:
  /// The members that match each of the two patterns.
  struct Meant {
    std::vector<char> first, second;
  };

  Meant meant(const NamePattern& first, const NamePattern& second) const;
  void readSwitchedOff();
  void readRestriction();
  void switchOffTouching(const std::vector<std::size_t>& examples, PairFilter& filter) const;

  const SceneDescription& description_;
  const std::vector<SceneMember>& members_;
  std::vector<std::vector<std::uint32_t>> switched_off_;  // by member: the others, sorted
  std::vector<Meant> rules_;                              // one per rule of the settings
  std::vector<Meant> paddings_;                           // one per padding of a pair
  std::vector<char> restricted_;   // by member: in the restriction; empty if there is none
  std::set<std::string> moving_;   // names of members
  std::set<std::string> touched_;  // all names in the touch_links of moving objects
};

}  // namespace collision_pairs
