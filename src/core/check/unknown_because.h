// The reasons of UNKNOWN in words: the same for a configuration and for a motion.
#pragma once

#include <cstdint>
#include <initializer_list>
#include <string>
#include <vector>

#include "collision_pairs/collision_scene.h"
#include "user_text.h"

namespace collision_pairs {

/// "no usable pose: a, b"; without names there is nothing to say.
struct NamedReason {
  const char* what;
  const std::vector<std::string>& names;
};

/// Of CollisionScene::missing(); empty: nothing is.
inline std::string missingGeometry(const CollisionScene& scene) {
  std::vector<std::string> links;
  for (const auto& entry : scene.missing()) links.push_back(entry.first);
  return links.empty() ? "" : "geometry that could not be read: " + firstOf(links);
}

/// All that speaks against FREE, one sentence each. `unchecked`: of the report.
inline std::vector<std::string> unknownBecause(const CollisionScene& scene,
                                               const std::string& unchecked,
                                               std::initializer_list<NamedReason> named,
                                               const std::vector<std::string>& of_input) {
  std::vector<std::string> reasons;
  const bool may_be_empty = scene.description().settings.allow_empty_scene;
  if (!unchecked.empty() && !may_be_empty) reasons.push_back(unchecked);
  const std::string missing = missingGeometry(scene);
  if (!missing.empty() && !contains(of_input, missing)) reasons.push_back(missing);
  for (const auto& [what, names] : named) {
    if (!names.empty()) reasons.push_back(std::string(what) + ": " + firstOf(names));
  }
  reasons.insert(reasons.end(), of_input.begin(), of_input.end());
  return reasons;
}

/// "a|b", of two models.
inline std::string pairName(const CollisionScene& scene, std::uint32_t first,
                            std::uint32_t second) {
  return scene.models()[first].name + '|' + scene.models()[second].name;
}

}  // namespace collision_pairs
