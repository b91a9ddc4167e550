// What a user says about pairs by name, beside the SRDF.
#pragma once

#include <string>
#include <vector>

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

}  // namespace collision_pairs
