// Poses of frames from transforms: the same for the node and for recordings.
#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include "collision_pairs/input_error.h"
#include "transform_buffer.h"

namespace collision_pairs {

constexpr std::size_t DEEPEST_TREE = 1000;  ///< steps; tf2's limit, for cycles of frames

/// Which pose of each frame.
struct Instant {
  enum Kind {
    AT,             ///< at the stamp
    AS_IT_ARRIVED,  ///< the same, if it was known in time (TransformBuffer::poseAt())
    NEWEST          ///< the newest one when the clock is at the stamp
  };
  Kind kind;
  StampNs stamp;
};

/// Poses of frames in one frame R; steps that several of them share are computed once.
class FramePoses {
 public:
  struct Known {
    Eigen::Isometry3d X_RF;
    StampNs oldest = NEVER, newest = EVER_SINCE;  ///< of the transforms on the way but static ones
    void pass(StampNs stamp) {
      oldest = std::min(oldest, stamp);
      if (stamp != NEVER) newest = std::max(newest, stamp);
    }
  };

  FramePoses(const TransformBuffer& buffer, const Instant& instant);

  /// Fixes the pose of a frame, and of its ancestors as far as they are not known. One whose
  /// ancestors form a cycle stays unknown.
  void anchor(int frame, const Known& known);
  /// False if no path leads from a known frame to this one; `found` then has the oldest stamp of
  /// the transforms up to where it ends.
  bool find(int frame, Known& found);
  /// Why find() is false, in words.
  std::string whyUnknown(int frame) const;
  /// False if its ancestors end at one that TF does not place anywhere, or never.
  bool isPlaced(int frame) const;
  bool isInCycle(int frame) const { return lastAncestor(frame) < 0; }

 private:
  /// The last ancestor that can be reached; -1: they form a cycle.
  int lastAncestor(int frame) const;
  bool step(int frame, StampNs& stamp, int& parent, Eigen::Isometry3d& X_PF) const;
  void learn(int frame, const Known& known);
  void forgetFrom(int first);  ///< in known_

  const TransformBuffer& buffer_;
  const Instant instant_;
  std::vector<int> index_;  ///< by frame, in known_; -1: not known
  std::vector<Known> known_;
  struct Step {
    int frame;
    StampNs stamp;
    Eigen::Isometry3d X_PF;
  };
  std::vector<Step> way_;  ///< scratch of find()
};

/// No stamp can help: TF does not connect two frames.
class NotConnected : public InputError {
 public:
  using InputError::InputError;
};

/// Pose of one frame in another. Throws NotConnected, or InputError if that instant is missing.
FramePoses::Known poseBetween(const TransformBuffer& buffer, const std::string& target,
                              const std::string& source, Instant instant);

}  // namespace collision_pairs
