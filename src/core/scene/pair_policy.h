// Which members of a scene are looked at together, and how far they must stay apart.
#pragma once

#include <cstdint>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "scene_members.h"

namespace collision_pairs {

/// Everything that anybody says about pairs, in this order: SRDF (or adjacent links) of each robot;
/// the user's rules, of which the last counts; touch links; the restriction. Asked while a scene is
/// built, and never again.
class PairPolicy {
 public:
  /// Both must outlive it. Throws InputError if the restriction names a group that is nowhere.
  PairPolicy(const SceneDescription& description, const std::vector<SceneMember>& members);

  /// By index of the member. O(rules + log pairs of the SRDF).
  bool allowed(std::size_t a, std::size_t b) const;

  /// The distance that the user wants of just this pair.
  std::optional<double> padding(std::size_t a, std::size_t b) const;

  /// Members that never move are treated alike where this is the same.
  std::string signature(std::size_t member) const;

 private:
  /// Which members each of the two patterns means.
  struct Meant {
    std::vector<char> first, second;
    bool both(std::size_t a, std::size_t b) const {
      return (first[a] && second[b]) || (first[b] && second[a]);
    }
  };

  Meant meant(const NamePattern& first, const NamePattern& second) const;
  void readSwitchedOff();
  void readRestriction();
  void addGroup(const std::string& name, std::set<std::string>& names) const;
  bool neverMeet(const SceneMember& a, const SceneMember& b) const;
  bool allowedBySrdf(std::size_t a, std::size_t b) const;

  const SceneDescription& description_;
  const std::vector<SceneMember>& members_;
  std::vector<std::vector<std::uint32_t>> switched_off_;  // by member: the others, sorted
  std::vector<Meant> rules_;                              // one a rule of the settings
  std::vector<Meant> paddings_;                           // one a padding of a pair
  std::vector<char> restricted_;   // by member: in the restriction; empty: there is none
  std::set<std::string> moving_;   // names of members
  std::set<std::string> touched_;  // every name in the touch_links of an object that moves
};

}  // namespace collision_pairs
