// What a user says of a scene: which pairs are looked at, how far they keep apart, what is
// prepared.
#pragma once

#include <cstddef>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "collision_pairs/fidelity.h"
#include "collision_pairs/narrow_phase.h"

namespace collision_pairs {

/// A name, or a pattern of the shell: `*` any letters, `?` one, `[a-c]` one of these. What it may
/// mean: links (with their robot's prefix), links of the world, objects. A name that reads like a
/// pattern, such as "box[1]", means itself, too.
using NamePattern = std::string;

bool isPattern(const NamePattern& pattern);
bool matches(const NamePattern& pattern, const std::string& name);

/// Of the pairs with one name that matches `first` and another that matches `second`, in either
/// order. "Allowed" is a pair that is looked at: the opposite of what MoveIt's allowed collision
/// matrix calls so.
struct PairRule {
  enum class Verdict { ALLOW, DENY };
  Verdict verdict = Verdict::DENY;
  NamePattern first, second;
};

/// The least distance that such pairs shall keep, instead of the sum of what their two say.
struct PairPadding {
  NamePattern first, second;
  double metres = 0.0;
};

/// Only pairs with at least one member in here are checked: the links that move when a group of
/// the SRDF moves (with its robot's prefix, "left/arm"), and what matches `names`. An object
/// attached to one of these links is in. Empty: every pair.
struct Restriction {
  std::string group;
  std::vector<NamePattern> names;

  bool empty() const { return group.empty() && names.empty(); }
  bool operator==(const Restriction& other) const {
    return group == other.group && names == other.names;
  }
};

struct SceneSettings {
  /// The finest geometry that a check of this scene may ask for; what asks for more gets this.
  /// Rungs above it are not prepared.
  Fidelity fidelity = Fidelity::MESH;
  /// The same for single links, by name (of the robot or the world); others: `fidelity`. A pair is
  /// checked at the coarsest of what its two links and the request say, so a link's rung above
  /// what all its partners have is not prepared either. PairReport says which rung it was.
  std::map<std::string, Fidelity> link_fidelity;
  /// Hulls of the `convex` rung have at most this many vertices and are grown so that they still
  /// enclose; >= 4, or 0: exact hulls. Fewer are faster and stick out further.
  int max_hull_vertices = 0;
  /// Who answers its pairs of shapes. Boxes, and what only bounds a pair, are not asked of FCL.
  NarrowPhaseMethod narrow_phase = NarrowPhaseMethod::NATIVE;

  /// Applied in this order after the SRDF, so that the last that matches a pair decides it. Pairs
  /// that can never meet another way (both static, one link and what is attached to it) stay
  /// out whatever they say.
  std::vector<PairRule> pair_rules;
  /// Links that are not in the scene at all.
  std::vector<NamePattern> ignored_links;

  /// Metres, >= 0: a distance that a link of a robot keeps to everything. The distance of a pair
  /// is that of its two shapes, less both paddings: it is in contact where it is closer than that.
  /// The shapes themselves are not changed, so the same distance is kept in every direction.
  double padding = 0.0;
  std::map<std::string, double> link_padding;  ///< for single links, by name, instead of `padding`
  std::vector<PairPadding> pair_padding;       ///< for pairs, instead of the sum; the last decides
  /// Links whose cylinders are replaced by capsules of the same radius and axis, which enclose
  /// them: rounder and cheaper, longer by a radius at either end.
  std::vector<NamePattern> cylinder_as_capsule;

  /// Called, from several threads, whenever one more of `total` meshes is prepared. May be empty.
  std::function<void(std::size_t done, std::size_t total)> progress;
};

}  // namespace collision_pairs
