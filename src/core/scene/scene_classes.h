// Members of a scene that its rules treat alike.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <unordered_map>
#include <vector>

#include "scene_members.h"

namespace collision_pairs {

/// The models that a restriction means. Both arguments must outlive it.
class RestrictedNames {
 public:
  /// Throws InputError if the group is unknown, or moves nothing.
  RestrictedNames(const std::vector<SceneRobot>& robots, const Restriction& restriction);

  /// `attached_link`: of an object that is attached to a link, else empty. That link need not be a
  /// model: it may have no geometry.
  bool have(const std::string& name, const std::string& attached_link) const {
    return isMeant(name) || (!attached_link.empty() && isMeant(attached_link));
  }

 private:
  bool isMeant(const std::string& name) const;
  void addGroup(const std::vector<SceneRobot>& robots, const std::string& name);

  const std::vector<NamePattern>& patterns_;
  std::set<std::string> of_group_;
};

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

/// By link of the merged robot: those that SRDFs, or adjacency, switch off with it, sorted.
using SwitchedOff = std::vector<std::vector<std::uint32_t>>;
SwitchedOff switchedOffLinks(const std::vector<SceneRobot>& robots);

/// What does not change while objects come and go by difference.
struct SceneRules {
  StaticSignature signature;
  std::set<std::string> named;  ///< by settings, restriction or touch links of the objects
  std::shared_ptr<const SwitchedOff> switched_off;
};

/// All names by which the description refers to a member; patterns are none.
std::set<std::string> namesIn(const SceneDescription& description, const Objects& objects);

/// Members of a scene that its rules treat alike: each moving member is a class of its own, while
/// all objects of a large world may share one, which keeps the tables of pairs small.
struct SceneClasses {
  struct Class {
    SceneMember example;                        ///< one of its members
    bool is_needed = false;                     ///< in some allowed pair
    Fidelity needed_fidelity = Fidelity::AABB;  ///< the finest in its allowed pairs
    double half_padding = 0.0;                  ///< half of the largest set for a single pair
    bool hasNeedsOf(const Class& other) const {
      return is_needed == other.is_needed && needed_fidelity == other.needed_fidelity &&
             half_padding == other.half_padding;
    }
  };
  std::shared_ptr<const SceneRules> rules;
  std::vector<Class> all;                                    ///< by id in the scene's filter
  std::unordered_map<std::string, std::uint32_t> of_static;  ///< by signature
};

}  // namespace collision_pairs
