// What MoveIt calls bodies, and which pairs of them may touch. Without types of MoveIt.
#pragma once

#include <cmath>
#include <set>
#include <string>

namespace collision_pairs {

/// A body of a robot; objects of the world, which do not move, are known by their names.
struct MoveitBody {
  std::string name;  ///< MoveIt's
  /// Index of the link itself or, of an attached body, of the one that it is attached to.
  int link = -1;
  bool is_attached = false;
  std::set<std::string> touch_links;  ///< names of links that an attached body may touch
};

/// As in an entry of MoveIt's allowed collision matrix; NEVER also if it has none.
enum class AllowedContact { NEVER, ALWAYS, CONDITIONAL };

/// Whether `one` is an attached body that may touch the other whatever the matrix says: a touch
/// link, or another body attached to the same link. The link that carries it is no touch link
/// unless it is named. Null: an object.
inline bool mayAlwaysTouch(const MoveitBody* one, const MoveitBody* other) {
  if (!one || !other || !one->is_attached) return false;
  return other->is_attached ? one->link == other->link : one->touch_links.count(other->name) > 0;
}

/// MoveIt's rule for a pair. `entry()` returns that of the matrix; it is called once, and only if
/// the bodies alone do not decide.
template <class Entry>
AllowedContact allowedContact(const MoveitBody* a, const MoveitBody* b, const Entry& entry) {
  return mayAlwaysTouch(a, b) || mayAlwaysTouch(b, a) ? AllowedContact::ALWAYS : entry();
}

/// Where a continuous joint at `from` arrives if it turns to `to` the shorter way; rad.
inline double afterShorterTurn(double from, double to) {
  return from + std::remainder(to - from, 2.0 * 3.14159265358979323846);
}

}  // namespace collision_pairs
