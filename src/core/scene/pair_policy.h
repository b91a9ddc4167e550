// The pair rules of a scene: which pairs are checked, and with which padding.
#pragma once

#include <cstdint>
#include <map>
#include <utility>

#include "collision_pairs/pair_filter.h"
#include "scene_classes.h"

namespace collision_pairs {

/// By classes, the smaller first.
using ClassPaddings = std::map<std::pair<std::uint32_t, std::uint32_t>, double>;

/// All rules about pairs, in this order: SRDF (or adjacent links) of each robot;
/// the user's rules, of which the last match applies; touch links; the restriction. Evaluated only
/// while a scene is built or changed.
struct PairPolicy {
  /// Of the classes; has no models yet.
  PairFilter filter;
  /// Those set for single pairs that the filter allows.
  ClassPaddings paddings;

  /// Evaluates the rules for the examples of the classes, and sets what each class needs. Cost:
  /// O(classes^2 / 64 * (1 + rules) + pairs of the SRDF).
  static PairPolicy of(const SceneDescription& description, SceneClasses& classes);
};

}  // namespace collision_pairs
