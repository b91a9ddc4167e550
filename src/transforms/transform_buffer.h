// tf2's buffer behind a gate: poses of frames that are known and not suspect.
#pragma once

#include <memory>
#include <string>
#include <vector>

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

/// A tf2::BufferCore stores the transforms that the gate admits, interpolates between two samples
/// (straight line, and slerp) and walks from frame to frame. A pose is known if tf2 knows it, and
/// no frame on the way is suspect at that stamp.
///
/// tf2 keeps a frame static or moving for ever: where that changes, a new BufferCore takes over.
///
/// 10 s of each frame are kept. Not thread safe.
class TransformBuffer {
 public:
  static const std::size_t DEEPEST_TREE;  ///< of frames: further tf2 does not walk

  explicit TransformBuffer(const PoseLimits& limits = {});
  TransformBuffer(TransformBuffer&&) noexcept;
  ~TransformBuffer();

  /// Returns why it was refused, or why the frame's poses are suspect; empty if all is well.
  /// `publisher`: any name that tells one from the other.
  std::string take(const ReceivedTransform& transform, bool is_static, const std::string& publisher,
                   StampNs now);
  /// The clock went back to `now`: forgets all but static transforms.
  void restart(StampNs now);

  const TransformGate& gate() const { return gate_; }
  const StampLimits& limits() const { return gate_.limits(); }
  /// How often a frame became static, moved again, or got another static pose.
  std::size_t nbStaticChanges() const { return nb_static_changes_; }
  const std::vector<std::string>& frames() const { return gate_.names().all(); }
  /// -1 if no transform names it. Numbers never change.
  int findFrame(const std::string& name) const { return gate_.names().find(name); }
  /// -1: it has none then.
  int parentAt(int frame, StampNs stamp) const;
  /// Pose of a frame in one above it, at a stamp; of a frame in itself even if no transform names
  /// it. In any other frame tf2 would look for it above the first one too, by transforms that are
  /// suspect. Throws InputError if tf2 does not know it.
  Eigen::Isometry3d poseBelow(int top, int frame, StampNs stamp) const;

 private:
  void store(int frame, const FramePose& pose, StampNs stamp, bool is_static) const;
  void begin();

  TransformGate gate_;
  std::size_t nb_static_changes_ = 0;
  std::unique_ptr<tf2::BufferCore> tf_;
};

}  // namespace collision_pairs
