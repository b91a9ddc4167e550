#include "pair_policy.h"

#include <algorithm>
#include <unordered_map>

#include "collision_pairs/input_error.h"
#include "link_group.h"

namespace collision_pairs {
namespace {

bool contains(const std::vector<std::string>& names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

/// Does `a` say that it may touch `b`?
bool mayTouch(const SceneMember& a, const SceneMember& b) {
  if (!a.object) return false;
  return contains(a.object->touch_links, b.name) || a.object->attached_link == b.name;
}

}  // namespace

PairPolicy::PairPolicy(const SceneDescription& description, const std::vector<SceneMember>& members)
    : description_(description), members_(members) {
  readSwitchedOff();
  for (const PairRule& rule : description.settings.pair_rules) {
    rules_.push_back(meant(rule.first, rule.second));
  }
  for (const PairPadding& pair : description.settings.pair_padding) {
    paddings_.push_back(meant(pair.first, pair.second));
  }
  for (const SceneMember& member : members) {
    if (member.isStatic()) continue;
    moving_.insert(member.name);
    if (!member.object) continue;
    touched_.insert(member.object->touch_links.begin(), member.object->touch_links.end());
  }
  if (!description.restriction.empty()) readRestriction();
}

PairPolicy::Meant PairPolicy::meant(const NamePattern& first, const NamePattern& second) const {
  Meant meant;
  for (const SceneMember& member : members_) {
    meant.first.push_back(matches(first, member.name));
    meant.second.push_back(matches(second, member.name));
  }
  return meant;
}

void PairPolicy::readSwitchedOff() {
  std::unordered_map<std::string, std::uint32_t> member_of;
  for (std::size_t i = 0; i < members_.size(); ++i) {
    if (members_[i].robot >= 0) member_of.emplace(members_[i].name, i);
  }
  switched_off_.resize(members_.size());
  for (int index = 0; index < static_cast<int>(description_.robots.size()); ++index) {
    const SceneRobot& robot = description_.robots[static_cast<std::size_t>(index)];
    const auto& links = robot.model->links();
    std::set<Srdf::LinkPair> off;
    if (robot.srdf) {
      std::vector<std::string> names;
      for (const Link& link : links) names.push_back(link.name);
      off = robot.srdf->switchedOff(names);
    } else {
      for (const auto& [a, b] : robot.model->adjacentLinks()) {
        off.insert(std::minmax(links[a].name, links[b].name));
      }
    }
    for (const auto& [a, b] : off) {
      const auto first = member_of.find(withPrefix(robot.prefix, a));
      const auto second = member_of.find(withPrefix(robot.prefix, b));
      if (first == member_of.end() || second == member_of.end()) continue;  // no geometry
      // An SRDF may name what is, with its prefix, a link of another robot.
      const bool is_own =
          members_[first->second].robot == index && members_[second->second].robot == index;
      if (!is_own) continue;
      switched_off_[first->second].push_back(second->second);
      switched_off_[second->second].push_back(first->second);
    }
  }
  for (auto& others : switched_off_) std::sort(others.begin(), others.end());
}

void PairPolicy::readRestriction() {
  const Restriction& restriction = description_.restriction;
  std::set<std::string> names;
  if (!restriction.group.empty()) addGroup(restriction.group, names);
  const auto isIn = [&](const std::string& name) {
    return names.count(name) > 0 ||
           std::any_of(restriction.names.begin(), restriction.names.end(),
                       [&](const NamePattern& pattern) { return matches(pattern, name); });
  };
  for (const SceneMember& member : members_) {
    // The link that an object is attached to need not be a member: it may have no geometry.
    const bool attached = member.object && !member.isStatic();
    restricted_.push_back(isIn(member.name) || (attached && isIn(member.object->attached_link)));
  }
}

void PairPolicy::addGroup(const std::string& name, std::set<std::string>& names) const {
  const SceneRobot* owner = nullptr;
  for (const SceneRobot& robot : description_.robots) {
    const bool is_meant = name.rfind(withPrefix(robot.prefix, ""), 0) == 0;
    if (!is_meant || (owner && robot.prefix.size() < owner->prefix.size())) continue;
    owner = &robot;
  }
  if (!owner) {
    throw InputError("group '" + name + "' is of no robot; it must begin with the prefix of one");
  }
  if (!owner->srdf) {
    throw InputError("group '" + name + "' is asked for, but robot '" + owner->model->name() +
                     "' has no SRDF");
  }
  const std::string prefix = withPrefix(owner->prefix, "");
  for (const int link : linksMovedBy(*owner->srdf, *owner->model, name.substr(prefix.size()))) {
    names.insert(prefix + owner->model->links()[link].name);
  }
}

bool PairPolicy::neverMeet(const SceneMember& a, const SceneMember& b) const {
  if (a.isStatic() && b.isStatic()) return true;
  if (mayTouch(a, b) || mayTouch(b, a)) return true;
  return a.object && b.object && a.body == b.body;
}

bool PairPolicy::allowedBySrdf(std::size_t a, std::size_t b) const {
  if (members_[a].robot < 0 || members_[b].robot < 0) return true;
  const auto& off = switched_off_[a];
  return description_.check_self && !std::binary_search(off.begin(), off.end(), b);
}

bool PairPolicy::allowed(std::size_t a, std::size_t b) const {
  if (neverMeet(members_[a], members_[b])) return false;
  if (!restricted_.empty() && !restricted_[a] && !restricted_[b]) return false;
  for (std::size_t i = rules_.size(); i-- > 0;) {
    if (!rules_[i].both(a, b)) continue;
    return description_.settings.pair_rules[i].verdict == PairRule::Verdict::ALLOW;
  }
  return allowedBySrdf(a, b);
}

std::optional<double> PairPolicy::padding(std::size_t a, std::size_t b) const {
  for (std::size_t i = paddings_.size(); i-- > 0;) {
    if (paddings_[i].both(a, b)) return description_.settings.pair_padding[i].metres;
  }
  return std::nullopt;
}

std::string PairPolicy::signature(std::size_t member) const {
  const SceneMember& m = members_[member];
  std::string text(1, static_cast<char>(m.finest));
  for (const auto* all : {&rules_, &paddings_}) {
    for (const Meant& one : *all) {
      text += one.first[member] ? '1' : '0';
      text += one.second[member] ? '1' : '0';
    }
  }
  if (!restricted_.empty()) text += restricted_[member] ? 'r' : '-';
  const auto add = [&](char kind, const std::string& name) {  // names may hold any letter
    text += kind + std::to_string(name.size()) + ":" + name;
  };
  if (touched_.count(m.name) > 0) add('t', m.name);
  if (!m.object) return text;
  for (const std::string& link : m.object->touch_links) {
    if (moving_.count(link) > 0) add('m', link);  // the others it never meets
  }
  return text;
}

}  // namespace collision_pairs
