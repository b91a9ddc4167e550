#include "moveit_limits.h"

namespace collision_pairs {
namespace {

namespace AllowedCollision = collision_detection::AllowedCollision;

bool isActive(const MoveitLimits& limits, const MoveitBody* body) {
  if (limits.active_links.empty()) return true;
  return body && limits.active_links[static_cast<std::size_t>(body->link)];
}

}  // namespace

std::vector<char> activeLinks(const moveit::core::RobotModel& robot,
                              const std::set<const moveit::core::LinkModel*>* links) {
  std::vector<char> active;
  if (!links) return active;
  active.assign(robot.getLinkModelCount(), 0);
  for (const moveit::core::LinkModel* link : *links) {
    active[static_cast<std::size_t>(link->getLinkIndex())] = 1;
  }
  return active;
}

AllowedContact allowedBy(const MoveitLimits& limits, const MoveitBody* a, const std::string& name_a,
                         const MoveitBody* b, const std::string& name_b) {
  if (!isActive(limits, a) && !isActive(limits, b)) return AllowedContact::ALWAYS;
  return allowedContact(a, b, [&] {
    AllowedCollision::Type type;
    const bool has_entry =
        limits.matrix && limits.matrix->getAllowedCollision(name_a, name_b, type);
    if (!has_entry || type == AllowedCollision::NEVER) return AllowedContact::NEVER;
    return type == AllowedCollision::ALWAYS ? AllowedContact::ALWAYS : AllowedContact::CONDITIONAL;
  });
}

}  // namespace collision_pairs
