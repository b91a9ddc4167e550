#include "scene_classes.h"

#include <algorithm>

#include "collision_pairs/input_error.h"
#include "link_group.h"
#include "user_text.h"

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

StaticSignature::StaticSignature(const SceneDescription& description,
                                 const std::vector<SceneMember>& members)
    : settings_(description.settings) {
  if (!description.restriction.empty()) {
    restricted_.emplace(description.robots, description.restriction);
  }
  for (const SceneMember& member : members) {
    if (member.isStatic()) continue;
    moving_.insert(member.name);
    if (!member.object) continue;
    touched_.insert(member.object->touch_links.begin(), member.object->touch_links.end());
  }
}

std::string StaticSignature::of(const SceneMember& m) const {
  std::string text(1, static_cast<char>(m.finest));
  const auto addMatches = [&](const auto& rules) {
    for (const auto& rule : rules) {
      text += matches(rule.first, m.name) ? '1' : '0';
      text += matches(rule.second, m.name) ? '1' : '0';
    }
  };
  addMatches(settings_.pair_rules);
  addMatches(settings_.pair_padding);
  if (restricted_) text += restricted_->have(m.name, "") ? 'r' : '-';
  const auto add = [&](char kind, const std::string& name) {  // names may contain any character
    text += kind + std::to_string(name.size()) + ":" + name;
  };
  if (touched_.count(m.name) > 0) add('t', m.name);
  if (!m.object) return text;
  for (const std::string& link : m.object->touch_links) {
    if (moving_.count(link) > 0) add('m', link);  // the other names never match a pair with it
  }
  return text;
}

SwitchedOff switchedOffLinks(const std::vector<SceneRobot>& robots) {
  SwitchedOff others;
  for (const SceneRobot& robot : robots) {
    const auto& links = robot.model->links();
    const std::size_t first = others.size();
    others.resize(first + links.size());
    const auto add = [&](std::size_t a, std::size_t b) {
      others[first + a].push_back(static_cast<std::uint32_t>(first + b));
      others[first + b].push_back(static_cast<std::uint32_t>(first + a));
    };
    if (robot.srdf) {
      std::unordered_map<std::string, std::size_t> index;
      for (const Link& link : links) index.emplace(link.name, index.size());
      for (const auto& [a, b] : robot.srdf->switchedOff(namesOf(links))) {
        const auto of_a = index.find(a), of_b = index.find(b);
        if (of_a != index.end() && of_b != index.end()) add(of_a->second, of_b->second);
      }
    } else {
      for (const auto& [a, b] : robot.model->adjacentLinks()) {
        add(static_cast<std::size_t>(a), static_cast<std::size_t>(b));
      }
    }
  }
  for (auto& of_link : others) std::sort(of_link.begin(), of_link.end());
  return others;
}

std::set<std::string> namesIn(const SceneDescription& description, const Objects& objects) {
  const SceneSettings& settings = description.settings;
  std::set<std::string> names;
  const auto addAll = [&](const std::vector<std::string>& all) {
    for (const std::string& name : all) {
      if (!isPattern(name)) names.insert(name);
    }
  };
  for (const auto& entry : settings.link_fidelity) names.insert(entry.first);
  for (const PairRule& rule : settings.pair_rules) addAll({rule.first, rule.second});
  for (const PairPadding& pair : settings.pair_padding) addAll({pair.first, pair.second});
  addAll(description.restriction.names);
  for (const ObjectPtr& object : objects) addAll(object->touch_links);
  for (const RigidObject& cloud : description.clouds) addAll(cloud.touch_links);
  return names;
}

}  // namespace collision_pairs
