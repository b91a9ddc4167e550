// Static objects that the rules of a scene treat alike.
#pragma once

#include <cstdint>
#include <optional>
#include <set>
#include <string>
#include <unordered_map>
#include <vector>

#include "restricted_names.h"
#include "scene_members.h"

namespace collision_pairs {

/// Tells how the rules treat a static member, by its name, fidelity and touch links.
class StaticSignature {
 public:
  /// The description must outlive it. Throws InputError if the restriction names an unknown group.
  StaticSignature(const SceneDescription& description, const std::vector<SceneMember>& members);

  /// Members with equal texts are in the same pairs, with the same paddings.
  std::string of(const SceneMember& member) const;
  /// Null: there is no restriction.
  const RestrictedNames* restricted() const { return restricted_ ? &*restricted_ : nullptr; }

 private:
  const SceneSettings& settings_;
  std::optional<RestrictedNames> restricted_;
  std::set<std::string> moving_;   // names of members
  std::set<std::string> touched_;  // all names in the touch_links of moving objects
};

/// What of a scene stays as it is while static objects come and go, each class having a member.
struct StaticClasses {
  struct Class {
    std::uint32_t id;  ///< in the scene's filter
    bool is_needed;    ///< in some allowed pair
    Fidelity needed_fidelity;
    double half_padding;
  };
  StaticSignature signature;
  std::unordered_map<std::string, Class> by_signature;
  std::set<std::string> named;  ///< by settings, restriction or touch links: must not be removed
};

/// All names by which the description refers to a member; patterns are none.
std::set<std::string> namesIn(const SceneDescription& description);

}  // namespace collision_pairs
