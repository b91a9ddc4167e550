// Settings of a scene: rules about pairs, paddings, fidelities.
#pragma once

#include <cstddef>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "collision_pairs/fidelity.h"
#include "collision_pairs/narrow_phase.h"

namespace collision_pairs {

/// A name, or a shell pattern: `*` matches any characters, `?` one, `[a-c]` one of these. It
/// matches links (with their robot's prefix), links of the world, and objects. A name that looks
/// like a pattern, such as "box[1]", also matches itself.
using NamePattern = std::string;

/// Names without `*`, `?` and `[` are not: where a rule or a restriction has one, it must exist.
bool isPattern(const NamePattern& pattern);
bool matches(const NamePattern& pattern, const std::string& name);

/// A rule for the pairs with one name that matches `first` and another that matches `second`, in
/// either order. ALLOW means that the pair is checked, the opposite of the meaning in MoveIt's
/// allowed collision matrix.
struct PairRule {
  enum class Verdict { ALLOW, DENY };
  Verdict verdict = Verdict::DENY;
  NamePattern first, second;
};

/// The distance that matching pairs keep, in place of the sum of the paddings of the two.
struct PairPadding {
  NamePattern first, second;
  double metres = 0.0;
};

/// Limits a check to pairs with at least one of these members: links that move with a group of the
/// SRDF (with its robot's prefix, "left/arm"), names that match `names`, and objects attached to
/// any of these links. Empty: every pair.
struct Restriction {
  std::string group;
  std::vector<NamePattern> names;

  bool empty() const { return group.empty() && names.empty(); }
  bool operator==(const Restriction& other) const {
    return group == other.group && names == other.names;
  }
};

struct SceneSettings {
  /// The finest geometry of this scene; checks that request a finer one get this one. Finer rungs
  /// are not prepared.
  Fidelity fidelity = Fidelity::MESH;
  /// The same for individual links, by name (of the robot or the world). A pair is checked at the
  /// coarsest of the fidelities of its two links and of the request, so a rung that no partner of a
  /// link can use is not prepared either. PairReport tells which rung decided.
  std::map<std::string, Fidelity> link_fidelity;
  /// Maximum number of vertices of hulls of the `convex` rung, which are enlarged to enclose the
  /// shape; >= 4, or 0: exact hulls. Fewer vertices are faster and less accurate.
  int max_hull_vertices = 0;
  /// The library that answers pairs of shapes. Boxes and bounds are always native.
  NarrowPhaseMethod narrow_phase = NarrowPhaseMethod::NATIVE;

  /// Applied in this order after the SRDF; the last matching rule decides. Pairs that can never
  /// move relative to each other (both static, a link and an object attached to it) are not
  /// checked, whatever the rules say.
  std::vector<PairRule> pair_rules;
  /// Permits the verdict FREE where nothing is checked, or a robot or the environment is not
  /// checked at all (CollisionScene::unchecked()).
  bool allow_empty_scene = false;
  /// Links that are excluded from the scene. Of objects and clouds, what has a pattern that matches
  /// stays; their names are refused here, in link_padding and in cylinder_as_capsule.
  std::vector<NamePattern> ignored_links;

  /// Metres, >= 0: a distance that each link of a robot keeps to everything else. The distance of a
  /// pair is that of its two shapes minus both paddings, so closer pairs are in contact. The shapes
  /// are not enlarged, so the same distance is kept in every direction.
  double padding = 0.0;
  std::map<std::string, double> link_padding;  ///< for individual links, in place of `padding`
  std::vector<PairPadding> pair_padding;       ///< for pairs; the last match decides
  /// Links whose cylinders are replaced by enclosing capsules of the same radius and axis, which
  /// are faster and longer by a radius at either end.
  std::vector<NamePattern> cylinder_as_capsule;

  /// Called after each of `total` meshes is prepared: from several threads, one at a time. May be
  /// empty.
  std::function<void(std::size_t done, std::size_t total)> progress;
};

}  // namespace collision_pairs
