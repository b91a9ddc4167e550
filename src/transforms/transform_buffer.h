// tf2's buffer behind a gate: poses of frames that are known beyond doubt.
#pragma once

#include <deque>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "collision_pairs/input_error.h"
#include "transform_gate.h"

namespace tf2 {
class BufferCore;
}

namespace collision_pairs {

/// Finite, and a rotation: its length is 1 within 1e-3.
bool isPose(const Eigen::Vector3d& p, const Eigen::Quaterniond& R);

/// A transform as received; names without a leading slash are not required.
struct ReceivedTransform {
  std::string parent, child;
  StampNs stamp;  ///< not used if it is static
  Eigen::Vector3d p_PC;
  Eigen::Quaterniond R_PC;
};

/// Which pose of each frame.
struct Instant {
  enum Kind {
    AT,     ///< at the stamp
    NEWEST  ///< the newest one when the clock is at the stamp
  };
  Kind kind;
  StampNs stamp;
};

/// No stamp can help: TF does not connect two frames.
class NotConnected : public InputError {
 public:
  using InputError::InputError;
};

/// A tf2::BufferCore stores the transforms that the gate admits, interpolates between two samples
/// (straight line, and slerp) and walks from frame to frame. A pose is known if tf2 knows it, and
/// no frame on the way is in doubt at that stamp.
///
/// tf2 keeps a frame static or moving for ever, and of a static one the last pose. Where either
/// changes, a new BufferCore takes over for stamps from then on.
///
/// 10 s of each frame are kept. Not thread safe.
class TransformBuffer {
 public:
  explicit TransformBuffer(const PoseLimits& limits = {});
  TransformBuffer(TransformBuffer&&) noexcept;
  ~TransformBuffer();

  /// Returns why it was refused, or why the frame's poses are in doubt; empty if all is well.
  /// `publisher`: any name that tells one from the other.
  std::string take(const ReceivedTransform& transform, bool is_static, const std::string& publisher,
                   StampNs now);
  /// The clock went back to `now`: forgets all but static transforms.
  void restart(StampNs now);

  const TransformGate& gate() const { return gate_; }
  const StampLimits& limits() const { return gate_.limits(); }
  const std::vector<std::string>& frames() const { return gate_.names().all(); }
  /// -1 if no transform names it. Numbers never change.
  int findFrame(const std::string& name) const { return gate_.names().find(name); }
  /// -1: it has none then.
  int parentAt(int frame, StampNs stamp) const;
  /// Whether its pose in its parent is known at that stamp, as TransformGate::isKnown().
  bool isKnown(int frame, StampNs stamp) const {
    return stamp >= epochs_.front().since && gate_.isKnown(frame, stamp);
  }

  /// Of buffers of tf2: bounded.
  std::size_t nbEpochs() const { return epochs_.size(); }

  /// Pose of one frame in another, at a stamp. Throws InputError if tf2 does not know it.
  Eigen::Isometry3d poseAt(int target, int source, StampNs stamp) const;

 private:
  /// Of stamps from `since` on.
  struct Epoch {
    StampNs since;
    std::unique_ptr<tf2::BufferCore> tf;
  };

  const Epoch& epochAt(StampNs stamp) const;
  void store(Epoch& epoch, int frame, const FramePose& pose, StampNs stamp, bool is_static) const;
  void beginEpoch(StampNs now);

  TransformGate gate_;
  std::deque<Epoch> epochs_;  ///< in order, never empty
};

/// Ways of transforms from one frame to others at one instant, as far as they are known.
class FrameWays {
 public:
  FrameWays(const TransformBuffer& buffer, int target, const Instant& instant);

  struct Way {
    bool is_known = false;
    /// Stamps of the transforms on the way but static ones, also of one that leads nowhere.
    StampNs oldest = NEVER, newest = EVER_SINCE;
    bool is_settled = true;  ///< all of its static frames are
    void join(const Way& other);
  };
  Way to(int source) const;
  /// Why to() is not known, in words.
  std::string whyNot(int source) const;
  /// False if its ancestors end at one that TF does not place anywhere, or never.
  bool isPlaced(int frame) const;
  bool isInCycle(int frame) const { return is_in_cycle_ || lastAncestor(frame) < 0; }
  /// On what a frame hung, known or in doubt, when it was last heard of; -1: that is too long ago.
  int lastParent(int frame) const;
  /// Forgets all ways: round a cycle, what hangs on the target would be what it hangs on.
  void breakCycle();
  int target() const { return target_; }

 private:
  /// False: it is not known.
  bool step(int frame, StampNs& stamp, int& parent) const;
  void pass(int frame, StampNs stamp, Way& way) const;
  /// The last ancestor that can be reached; -1: they form a cycle.
  int lastAncestor(int frame) const;
  /// Up to a frame that has been asked about, but no further than tf2 walks.
  Way climb(int frame, std::size_t nb_steps) const;
  /// As emplace() of a map: its index in noted_, and whether it is new.
  std::pair<std::size_t, bool> note(int frame, const Way& way) const;
  /// Its slot, or the one where it would be.
  std::size_t slotOf(int frame) const;
  void makeRoom(std::size_t nb_slots) const;

  const TransformBuffer& buffer_;
  const int target_;
  const Instant instant_;
  bool is_in_cycle_ = false;  ///< the target
  // Of the frames that were asked about, not of all: a look-up costs the same among any number.
  struct Noted {
    int frame;
    Way way;
  };
  mutable std::vector<Noted> noted_;
  mutable std::vector<int> slots_;  ///< a hash table of indices of noted_; -1: empty
};

struct FoundPose {
  Eigen::Isometry3d X_TS = Eigen::Isometry3d::Identity();
  StampNs oldest = NEVER;  ///< NEVER: of static transforms only
};
/// The ways from a frame of the buffer at an instant.
using WaysFrom = std::function<FrameWays(int target, const Instant& instant)>;

/// Pose of one frame in another, and the stamps on the way. At NEWEST: at the newest instant that
/// all transforms on the way have reached. Throws NotConnected, or InputError if that instant is
/// missing.
FoundPose poseBetween(const TransformBuffer& buffer, const std::string& target,
                      const std::string& source, Instant instant, const WaysFrom& waysFrom);
inline FoundPose poseBetween(const TransformBuffer& buffer, const std::string& target,
                             const std::string& source, const Instant& instant) {
  return poseBetween(buffer, target, source, instant,
                     [&](int from, const Instant& when) { return FrameWays(buffer, from, when); });
}

}  // namespace collision_pairs
