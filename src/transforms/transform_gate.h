// Which transforms are admitted to tf2's buffer, and at which stamps a frame's pose is suspect.
#pragma once

#include <algorithm>
#include <array>
#include <deque>
#include <map>
#include <string>
#include <unordered_map>
#include <vector>

#include <Eigen/Geometry>

#include "stamps.h"

namespace collision_pairs {

/// Pose of a frame C in its parent P.
struct FramePose {
  int parent;               ///< number of the frame P
  Eigen::Vector3d p_PC;     ///< origin of C in P
  Eigen::Quaterniond R_PC;  ///< unit
};

constexpr double SAME_PLACE = 1e-4;  ///< m and rad; two poses that agree may round differently
inline double distanceOf(const FramePose& a, const FramePose& b) {
  return (a.p_PC - b.p_PC).norm();
}
inline double angleOf(const FramePose& a, const FramePose& b) {
  return a.R_PC.angularDistance(b.R_PC);
}

/// Numbers for names that are external input: at most 10000.
class Names {
 public:
  /// -1 if there are too many.
  int add(const std::string& name);
  /// -1: unknown.
  int find(const std::string& name) const;
  const std::vector<std::string>& all() const { return all_; }

 private:
  std::vector<std::string> all_;
  std::unordered_map<std::string, int> numbers_;
};

/// tf2 stores transforms, interpolates and walks. It knows no publishers, ages, gaps or
/// contradictions; those are the gate's, by these rules (docs/node.md):
///
///  1. A stamp that is zero, further ahead of the clock than clock_tolerance, or older than
///     max_pose_age on arrival is refused.
///  2. Between samples a pose is known where two of one publisher, in one parent, are at most
///     max_transform_age apart, the first of which is not suspect.
///  3. Two publishers of one frame, or one that publishes it in two sequences, contradict each
///     other where a sample of one is further from both neighbours in time of the other than these,
///     or the two before, are from each other (0.1 mm, 0.1 mrad), or names another parent than
///     both.
///  4. Then stamps from max_pose_age before to the first sample that is max_pose_age after it are
///     suspect.
///  5. A frame is static or moves, as it was heard first. While the other kind is heard too, it is
///     suspect, until one of them has been silent for max_pose_age.
///  6. Then it moves if that was heard last, for at least max_pose_age; it becomes static if its
///     static pose was sent twice.
///  7. Of static poses the newest counts that one node alone has sent, or that was sent twice.
///  8. Until there is one again, a frame whose static publishers contradict each other is suspect.
///  9. Where a static pose changes, or a frame becomes static, earlier stamps are suspect.
/// 10. When the clock goes back, all but static poses is forgotten.
///
/// Without a limit of the age, max_transform_age stands for max_pose_age in rule 4. Of a frame are
/// kept its static pose of each publisher, their samples of the last few seconds, and the suspect
/// spans. Cost of a sample in order: O(publishers of the frame * log samples).
class TransformGate {
 public:
  explicit TransformGate(const PoseLimits& limits);

  /// What the buffer is to do with an admitted transform.
  enum class Store {
    NOTHING,
    IT,
    KIND  ///< the frame is of the other kind from now on, which tf2 cannot change
  };
  struct Answer {
    Store store;
    std::string why;  ///< it was refused, or the frame is suspect; empty: all is well
  };
  Answer admit(int frame, const FramePose& pose, bool is_static, const std::string& publisher,
               StampNs stamp, StampNs now);
  void restart(StampNs now);

  Names& names() { return names_; }
  const Names& names() const { return names_; }
  const StampLimits& limits() const { return limits_; }

  /// False if nothing was received of it: it is a parent only.
  bool isHeard(int frame) const;
  bool isStatic(int frame) const {
    return frame < static_cast<int>(frames_.size()) && frames_[frame].is_static;
  }
  /// visit(pose, stamp): the static pose that counts, at NEVER; or all samples that are kept.
  template <class Visit>
  void forEach(int number, const Visit& visit) const {
    if (number >= static_cast<int>(frames_.size())) return;
    const Frame& frame = frames_[number];
    if (frame.is_static) return visit(frame.static_pose.pose, NEVER);
    std::map<StampNs, const FramePose*> samples;
    for (const Source& source : frame.sources) {
      for (const Sample& sample : source.samples) samples.emplace(sample.stamp, &sample.pose);
    }
    for (const auto& [stamp, pose] : samples) visit(*pose, stamp);
  }
  /// Of all its samples; EVER_SINCE: none.
  StampNs newestStamp(int frame) const;
  /// The newest stamp that `now` has reached, unless it is too old and there is one ahead of now.
  /// NEVER: static.
  StampNs newestAt(int frame, StampNs now) const;
  /// Whether its pose in its parent is known at that stamp.
  bool isKnown(int frame, StampNs stamp) const;
  /// Whether a frame that is static has been so for all stamps, with one pose and never suspect.
  bool isSettled(int frame) const;
  /// Why isKnown() is false, in words.
  std::string whyUnknown(int frame, StampNs stamp) const;
  /// Its parent at that stamp; -1: to be asked of tf2, because it has had several.
  int parentAt(int frame, StampNs stamp) const;

  /// Number of spans and samples kept of a frame: bounded.
  std::size_t nbKept(int frame) const;

 private:
  struct Sample {
    StampNs stamp;
    FramePose pose;
  };
  using Samples = std::deque<Sample>;  // by stamp, each once
  using Place = Samples::const_iterator;
  static Place placeOf(const Samples& samples, StampNs stamp) {
    if (samples.empty() || samples.back().stamp < stamp) return samples.end();  // most often
    return std::lower_bound(samples.begin(), samples.end(), stamp,
                            [](const Sample& sample, StampNs t) { return sample.stamp < t; });
  }
  struct Source {
    int publisher;
    Samples samples;
  };
  struct StaticPose {
    int publisher;
    FramePose pose;
  };
  enum Reason { GAP, PUBLISHERS, BOTH_KINDS, STATIC_POSE, NB_REASONS };
  struct Frame {
    bool is_heard = false, is_static = false;
    StampNs since = EVER_SINCE;  ///< stamps before had another static pose, or it moved
    StampNs last_moving = EVER_SINCE, last_static = EVER_SINCE;  ///< arrivals
    StampNs both_since = NEVER;       ///< arrival from which on both kinds are heard; NEVER: one is
    std::vector<StaticPose> statics;  ///< the newest of each publisher
    StaticPose static_pose{-1, {-1, {}, {}}};    ///< the one that counts, if it is static
    StaticPose newest_static{-1, {-1, {}, {}}};  ///< the one that was received last
    bool newest_counts = false;                  ///< by rule 7
    std::vector<Source> sources;
    StampNs oldest = NEVER, newest = EVER_SINCE;  ///< samples
    StampNs parent_since = EVER_SINCE;            ///< stamp from which on the parent is `parent`
    int parent = -1;
    std::array<SuspectSpans, NB_REASONS> suspect;
  };

  Answer admitStatic(Frame& frame, const FramePose& pose, int by, StampNs now);
  Answer admitMoving(Frame& frame, const FramePose& pose, int by, StampNs stamp, StampNs now);
  void noteKind(Frame& frame, bool is_static, StampNs now);
  StampNs endOfBoth(const Frame& frame) const;
  Source* sourceOf(Frame& frame, int publisher) const;
  void noteSample(Frame& frame, const Samples& samples, Place added);
  bool isBridge(const Frame& frame, const Sample& from, const Sample& to) const;
  void noteParent(Frame& frame, int parent, StampNs stamp);
  std::string compare(Frame& frame, const Source& source, Place added, StampNs now);
  std::string note(Frame& frame, const Source& source, Place sample, int other, StampNs now,
                   const std::string& how);
  void forget(Frame& frame, StampNs now) const;
  StampNs newestAt(const Frame& frame, StampNs now) const;
  static const std::string* whySuspectAt(const Frame& frame, StampNs stamp);
  /// `now`, or beyond the newest stamp of all frames: no look-up so far was as late.
  StampNs reached(StampNs now) const { return newest_ > now ? newest_ + 1 : now; }

  static constexpr std::size_t MOST_PUBLISHERS = 16;  // of one frame
  static const char *const TOO_MANY_NODES, *const IS_ON_BOTH, *const SENT_ONCE, *const CHANGED;

  const StampLimits limits_;
  std::string too_far_apart_;
  Names names_, publishers_;
  std::vector<Frame> frames_;
  StampNs newest_ = EVER_SINCE;  ///< of all that move
  StampNs last_now_ = EVER_SINCE;
};

/// `sample` of one publisher against three consecutive poses of another, or of its own. `how`: by
/// how much.
bool contradicts(const FramePose& sample, const FramePose& earlier, const FramePose& before,
                 const FramePose& after, std::string& how);

}  // namespace collision_pairs
