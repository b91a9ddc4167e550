// The models that a restriction means.
#pragma once

#include <set>
#include <string>
#include <vector>

#include "collision_pairs/scene_description.h"

namespace collision_pairs {

/// Both arguments must outlive it.
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

}  // namespace collision_pairs
