// Transforms between frames, live or recorded: one set of rules for both.
#pragma once

#include <string>
#include <unordered_map>
#include <vector>

#include <Eigen/Geometry>

#include "track.h"
#include "transform_kind.h"

namespace collision_pairs {

/// Pose of a frame C in its parent P.
struct FramePose {
  int parent;               ///< number of the frame P
  Eigen::Vector3d p_PC;     ///< origin of C in P
  Eigen::Quaterniond R_PC;  ///< unit
};

/// For Track: `sample` against three consecutive poses of another publisher.
bool contradicts(const FramePose& sample, const FramePose& earlier, const FramePose& before,
                 const FramePose& after, std::string& how);

inline bool areConnected(const FramePose& a, const FramePose& b) { return a.parent == b.parent; }

/// Finite, and a rotation: its length is 1 within 1e-3.
bool isPose(const Eigen::Vector3d& p, const Eigen::Quaterniond& R);

/// A transform as received; names without a leading slash are not required.
struct ReceivedTransform {
  std::string parent, child;
  StampNs stamp;  ///< not used if it is static
  Eigen::Vector3d p_PC;
  Eigen::Quaterniond R_PC;
};

/// What tf2's buffer is for a listener, with rules that never let a wrong or missing transform pass
/// as a pose. Like tf2 it interpolates between two samples (straight line, and slerp), never
/// extrapolates, and lets a static transform hold at any instant. Unlike tf2 it refuses
/// stamps far ahead of the clock and those too old to be used; does not interpolate over gaps or
/// between publishers; finds publishers that contradict each other (Track) and frames that are
/// published as static and as moving (TransformKind), whose poses are unknown while that lasts.
///
/// A recording gives the same answers if its transforms are added in the order of arrival, with the
/// time of arrival as `now`. Memory: about 90 bytes per transform. Not thread safe.
class TransformBuffer {
 public:
  /// Live: 10 s of each frame are kept. Of a recording: everything.
  explicit TransformBuffer(const PoseLimits& limits = {}, bool keeps_all = false)
      : limits_(limits, keeps_all) {}

  /// Returns why it was refused, or why the frame's poses are in doubt; empty if all is well.
  /// `publisher`: any name that tells one from the other.
  std::string take(const ReceivedTransform& transform, bool is_static, const std::string& publisher,
                   StampNs now);
  /// The clock went back to `now`: forgets all but static transforms.
  void restart(StampNs now);

  /// -1 if no transform names it. Numbers never change.
  int findFrame(const std::string& name) const;
  const std::vector<std::string>& frames() const { return names_; }
  const TrackLimits& limits() const { return limits_; }

  /// False if nothing was received of it: it is a parent only.
  bool isHeard(int frame) const {
    return !frames_[frame].statics.empty() || !frames_[frame].moving.empty();
  }
  /// EVER_SINCE: it has not moved.
  StampNs newestStamp(int frame) const { return frames_[frame].moving.newest(); }
  /// Pose in its parent at `stamp`; false if it has no parent then, or its pose is in doubt. With
  /// `as_it_arrived`, also if it was not known or too old when that was the current time.
  bool poseAt(int frame, StampNs stamp, bool as_it_arrived, int& parent,
              Eigen::Isometry3d& X_PC) const;
  /// The newest pose that the clock has reached; `stamp` is NEVER if it is static. False also if it
  /// is too old.
  bool newestPose(int frame, StampNs now, StampNs& stamp, int& parent,
                  Eigen::Isometry3d& X_PC) const;
  bool isStaticAt(int frame, StampNs stamp, int& parent) const;
  /// Why poseAt() is false, in words.
  std::string whyUnknown(int frame, StampNs stamp, bool as_it_arrived) const;
  /// Why newestPose() is.
  std::string whyNoNewest(int frame, StampNs now) const;

 private:
  struct Static {
    StampNs received;
    int publisher;
    FramePose pose;
  };
  struct Frame {
    TransformKind kind;
    Track<FramePose> moving;
    std::vector<Static> statics;   ///< in the order of arrival
    StampNs static_since = NEVER;  ///< no look-up before its first static transform was later
    std::vector<Doubt> doubts;     ///< of the static ones
  };

  int numberOf(const std::string& name, std::vector<std::string>& names,
               std::unordered_map<std::string, int>& ids);
  std::string takeStatic(Frame& frame, const FramePose& pose, int publisher, StampNs now);
  /// As in Arrival.
  StampNs reached(StampNs now) const { return newest_ > now ? newest_ + 1 : now; }
  const FramePose& staticAt(const Frame& frame, StampNs stamp) const;
  const std::string* doubtAt(const Frame& frame, TransformKind::Kind kind, StampNs stamp) const;

  const TrackLimits limits_;
  std::vector<std::string> names_, publishers_;
  std::unordered_map<std::string, int> ids_, publisher_ids_;
  std::vector<Frame> frames_;
  StampNs newest_ = EVER_SINCE;  ///< of all moving ones
};

}  // namespace collision_pairs
