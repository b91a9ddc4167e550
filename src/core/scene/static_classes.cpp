#include "static_classes.h"

namespace collision_pairs {

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

std::set<std::string> namesIn(const SceneDescription& description) {
  const SceneSettings& settings = description.settings;
  std::set<std::string> names;
  const auto addAll = [&](const std::vector<std::string>& all) {
    for (const std::string& name : all) names.insert(withoutMark(name));
  };
  for (const auto& entry : settings.link_fidelity) names.insert(entry.first);
  for (const auto& entry : settings.link_padding) names.insert(entry.first);
  for (const PairRule& rule : settings.pair_rules) addAll({rule.first, rule.second});
  for (const PairPadding& pair : settings.pair_padding) addAll({pair.first, pair.second});
  addAll(settings.ignored_links);
  addAll(settings.cylinder_as_capsule);
  addAll(description.restriction.names);
  for (const auto* objects : {&description.objects, &description.clouds}) {
    for (const RigidObject& object : *objects) addAll(object.touch_links);
  }
  return names;
}

}  // namespace collision_pairs
