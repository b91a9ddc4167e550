// Whether a frame is static or moves, if it was published as both.
#pragma once

#include <optional>
#include <vector>

#include "track.h"

namespace collision_pairs {

/// A frame on one of /tf and /tf_static is of that kind. As soon as the other kind arrives, it is
/// ambiguous, until one of them has been silent for max_age; then the other one counts. A frame
/// that moved becomes static only if its static transform was sent again: static transforms do not
/// age, so a single mistaken one would otherwise outlive the last pose. One by another publisher
/// with another pose is in doubt by itself (TransformBuffer::takeStatic).
class TransformKind {
 public:
  enum Kind { UNHEARD, MOVES, STATIC, AMBIGUOUS };

  void noteMoving(StampNs now, StampNs max_age);
  /// `again`: the same publisher has sent it before, or another one the same pose.
  void noteStatic(StampNs now, StampNs max_age, bool again);
  Kind at(StampNs stamp) const;
  /// The clock went back: times so far mean nothing any more, but what was ambiguous stays so.
  void restart(StampNs now, StampNs max_age);

 private:
  struct Conflict {
    StampNs since;  ///< stamps from then on are in doubt: those that are on their way, too
    StampNs begin, end;
    bool was_static;
  };
  struct Change {
    StampNs since;
    bool is_static;
  };
  void settle(StampNs now);
  void begin(StampNs now, StampNs max_age, bool was_static);
  void prolong(StampNs max_age);
  bool isStaticAfterConflict() const;

  StampNs last_moving_ = EVER_SINCE, last_static_ = EVER_SINCE;
  std::optional<Conflict> conflict_;
  std::vector<Span> ambiguous_;  ///< conflicts that are over
  std::vector<Change> changes_;
};

}  // namespace collision_pairs
