#include "restricted_names.h"

#include <algorithm>

#include "collision_pairs/input_error.h"
#include "link_group.h"

namespace collision_pairs {

RestrictedNames::RestrictedNames(const std::vector<SceneRobot>& robots,
                                 const Restriction& restriction)
    : patterns_(restriction.names) {
  if (!restriction.group.empty()) addGroup(robots, restriction.group);
}

bool RestrictedNames::isMeant(const std::string& name) const {
  return of_group_.count(name) > 0 ||
         std::any_of(patterns_.begin(), patterns_.end(),
                     [&](const NamePattern& pattern) { return matches(pattern, name); });
}

void RestrictedNames::addGroup(const std::vector<SceneRobot>& robots, const std::string& name) {
  const SceneRobot* owner = nullptr;
  for (const SceneRobot& robot : robots) {
    const bool is_meant = name.rfind(withPrefix(robot.prefix, ""), 0) == 0;
    if (!is_meant || (owner && robot.prefix.size() < owner->prefix.size())) continue;
    owner = &robot;
  }
  if (!owner) {
    throw InputError("group '" + name +
                     "' belongs to no robot; it must begin with a robot's prefix");
  }
  if (!owner->srdf) {
    throw InputError("group '" + name + "' is requested, but robot '" + owner->model->name() +
                     "' has no SRDF");
  }
  const std::string prefix = withPrefix(owner->prefix, "");
  for (const int link : linksMovedBy(*owner->srdf, *owner->model, name.substr(prefix.size()))) {
    of_group_.insert(prefix + owner->model->links()[link].name);
  }
}

}  // namespace collision_pairs
