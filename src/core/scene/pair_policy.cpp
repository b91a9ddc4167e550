#include "pair_policy.h"

#include <algorithm>
#include <unordered_map>

namespace collision_pairs {
namespace {

/// A set of classes, stored like a row of the filter.
class ClassSet {
 public:
  explicit ClassSet(std::size_t nb_classes) : words_((nb_classes + 63) / 64, 0) {}
  void insert(std::size_t c) { words_[c >> 6] |= std::uint64_t{1} << (c & 63); }
  bool has(std::size_t c) const { return (words_[c >> 6] >> (c & 63)) & 1u; }

  void addTo(std::uint64_t* row) const {
    for (std::size_t w = 0; w < words_.size(); ++w) row[w] |= words_[w];
  }
  void removeFrom(std::uint64_t* row) const {
    for (std::size_t w = 0; w < words_.size(); ++w) row[w] &= ~words_[w];
  }
  void keepOnlyIn(std::uint64_t* row) const {
    for (std::size_t w = 0; w < words_.size(); ++w) row[w] &= words_[w];
  }

 private:
  std::vector<std::uint64_t> words_;
};

void switchOff(std::size_t c, std::uint64_t* row) {
  row[c >> 6] &= ~(std::uint64_t{1} << (c & 63));
}

/// The classes whose example satisfies a condition.
template <class Holds>
ClassSet classesWhere(const std::vector<std::size_t>& examples, const Holds& holds) {
  ClassSet classes(examples.size());
  for (std::size_t c = 0; c < examples.size(); ++c) {
    if (holds(examples[c])) classes.insert(c);
  }
  return classes;
}

}  // namespace

PairPolicy::PairPolicy(const SceneDescription& description, const std::vector<SceneMember>& members,
                       const RestrictedNames* restricted)
    : description_(description), members_(members), restricted_(restricted) {
  readSwitchedOff();
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
      // With its prefix, a name in an SRDF may be that of another robot's link.
      const bool is_own =
          members_[first->second].robot == index && members_[second->second].robot == index;
      if (!is_own) continue;
      switched_off_[first->second].push_back(second->second);
      switched_off_[second->second].push_back(first->second);
    }
  }
  for (auto& others : switched_off_) std::sort(others.begin(), others.end());
}

bool PairPolicy::isRestricted(std::size_t member) const {
  const RigidObject* object = members_[member].object;
  return restricted_->have(members_[member].name, object ? object->attached_link : "");
}

PairFilter PairPolicy::filter(const std::vector<std::uint32_t>& class_of,
                              const std::vector<std::size_t>& examples) const {
  const auto where = [&](const auto& holds) { return classesWhere(examples, holds); };
  const ClassSet statics = where([&](std::size_t m) { return members_[m].isStatic(); });
  const ClassSet links = where([&](std::size_t m) { return members_[m].robot >= 0; });
  const ClassSet restricted =
      where([&](std::size_t m) { return restricted_ != nullptr && isRestricted(m); });
  std::vector<std::pair<ClassSet, ClassSet>> rules;
  for (const PairRule& rule : description_.settings.pair_rules) {
    const auto meant = [&](const NamePattern& pattern) {
      return where([&](std::size_t m) { return matches(pattern, members_[m].name); });
    };
    rules.emplace_back(meant(rule.first), meant(rule.second));
  }
  std::map<int, ClassSet> objects_on;  // by body
  for (std::size_t c = 0; c < examples.size(); ++c) {
    const SceneMember& member = members_[examples[c]];
    if (!member.object || member.isStatic()) continue;
    objects_on.try_emplace(member.body, examples.size()).first->second.insert(c);
  }

  PairFilter filter(class_of);
  for (std::uint32_t c = 0; c < examples.size(); ++c) {
    const SceneMember& member = members_[examples[c]];
    std::uint64_t* row = filter.row(c);
    if (member.robot >= 0) {
      if (!description_.check_self) links.removeFrom(row);
      for (const std::uint32_t other : switched_off_[examples[c]]) {
        switchOff(class_of[other], row);
      }
    }
    for (std::size_t i = 0; i < rules.size(); ++i) {
      const bool allow = description_.settings.pair_rules[i].verdict == PairRule::Verdict::ALLOW;
      const auto apply = [&](const ClassSet& to) { allow ? to.addTo(row) : to.removeFrom(row); };
      if (rules[i].first.has(c)) apply(rules[i].second);
      if (rules[i].second.has(c)) apply(rules[i].first);
    }
    if (restricted_ && !restricted.has(c)) restricted.keepOnlyIn(row);
    if (member.isStatic()) statics.removeFrom(row);
    if (member.object && !member.isStatic()) objects_on.at(member.body).removeFrom(row);
    switchOff(c, row);
  }
  switchOffTouching(examples, filter);
  return filter;
}

void PairPolicy::switchOffTouching(const std::vector<std::size_t>& examples,
                                   PairFilter& filter) const {
  std::unordered_map<std::string, std::uint32_t> class_of_name;
  for (std::uint32_t c = 0; c < examples.size(); ++c) {
    class_of_name.emplace(members_[examples[c]].name, c);
  }
  for (std::uint32_t c = 0; c < examples.size(); ++c) {
    const RigidObject* object = members_[examples[c]].object;
    if (!object) continue;
    const auto mayTouch = [&](const std::string& name) {
      const auto found = class_of_name.find(name);
      if (found != class_of_name.end()) filter.setClassPair(c, found->second, false);
    };
    std::for_each(object->touch_links.begin(), object->touch_links.end(), mayTouch);
    mayTouch(object->attached_link);
  }
}

ClassPaddings PairPolicy::paddings(const PairFilter& filter,
                                   const std::vector<std::size_t>& examples) const {
  ClassPaddings paddings;
  for (const PairPadding& pair : description_.settings.pair_padding) {
    const auto meant = [&](const NamePattern& pattern) {
      std::vector<std::uint32_t> classes;
      for (std::uint32_t c = 0; c < examples.size(); ++c) {
        if (matches(pattern, members_[examples[c]].name)) classes.push_back(c);
      }
      return classes;
    };
    const std::vector<std::uint32_t> second = meant(pair.second);
    for (const std::uint32_t a : meant(pair.first)) {
      for (const std::uint32_t b : second) {
        if (!filter.classPairAllowed(a, b)) continue;
        paddings[std::minmax(a, b)] = pair.metres;  // the last
      }
    }
  }
  return paddings;
}

}  // namespace collision_pairs
