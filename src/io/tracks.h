// All transforms and joint positions of a recording, for look-up at any stamp.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <unordered_map>
#include <vector>

#include <Eigen/Geometry>

namespace collision_pairs {

/// Nanoseconds since the epoch.
using StampNs = std::int64_t;

/// The counterpart of tf2's buffer for a recording: it keeps everything, results do not depend on
/// the order of arrival, and a look-up is a binary search. Between two samples it interpolates as
/// tf2 does (straight line, and slerp); it never extrapolates, and never interpolates over a gap
/// that is too long. About 80 bytes per transform.
class TransformTracks {
 public:
  struct Sample {
    StampNs stamp;
    int parent;
    Eigen::Vector3d p_PC;     ///< origin of the child frame C in the parent frame P
    Eigen::Quaterniond R_PC;  ///< unit
  };

  /// False, and nothing is added, if it is not finite, not a rotation (length 1 within 1e-3), or
  /// makes a frame its own parent. Leading slashes of names are dropped.
  bool add(const std::string& parent, const std::string& child, StampNs stamp,
           const Eigen::Vector3d& p_PC, const Eigen::Quaterniond& R_PC, bool is_static);
  /// After the last add(): sorts by stamp. Of equal stamps the first that was added stays.
  void finish();

  bool empty() const { return tracks_.empty(); }
  /// -1 if no transform names it.
  int findFrame(const std::string& name) const;
  const std::vector<std::string>& frames() const { return names_; }
  /// The samples of a frame below its parents; a static frame has one, valid at any instant.
  const std::vector<Sample>& samples(int frame) const { return tracks_[frame].samples; }
  bool isStatic(int frame) const { return tracks_[frame].is_static; }

  /// At `stamp`. False if the frame has no parent then: before its first and after its last sample,
  /// and between two samples that are further apart than max_gap.
  bool lookUp(int frame, StampNs stamp, StampNs max_gap, int& parent,
              Eigen::Isometry3d& X_PC) const;

 private:
  struct Track {
    bool is_static = false;
    std::vector<Sample> samples;
  };
  int frameNumbered(std::string name);

  std::vector<std::string> names_;
  std::vector<Track> tracks_;  // by frame
  std::unordered_map<std::string, int> ids_;
};

/// Poses of any frames in one frame R at one instant; shared steps are computed once.
class FramePoses {
 public:
  FramePoses(const TransformTracks& tracks, StampNs stamp, StampNs max_gap)
      : tracks_(tracks), stamp_(stamp), max_gap_(max_gap) {}

  /// Fixes the pose of a frame, overriding the tracks.
  void anchor(int frame, const Eigen::Isometry3d& X_RF) { known_[frame] = X_RF; }
  /// Makes the ancestors of an anchor known, by following its transforms backwards.
  void climbFrom(int frame);
  /// False if no path leads from a known frame to this one at that stamp.
  bool find(int frame, Eigen::Isometry3d& X_RF);

 private:
  const TransformTracks& tracks_;
  StampNs stamp_;
  StampNs max_gap_;
  std::unordered_map<int, Eigen::Isometry3d> known_;
};

/// Joint positions by name. Between two samples it interpolates on a straight line (a continuous
/// joint: the shorter way round), which is where robot_state_publisher and TF would place the link;
/// it never extrapolates, and never interpolates over a gap that is too long.
class JointTracks {
 public:
  struct Sample {
    StampNs stamp;
    double position;  ///< rad or m
  };

  /// False, and nothing is added, if the position is not finite.
  bool add(const std::string& joint, StampNs stamp, double position);
  /// After the last add(): sorts by stamp. Of equal stamps the first that was added stays.
  void finish();

  bool has(const std::string& joint) const { return tracks_.count(joint) > 0; }
  const std::map<std::string, std::vector<Sample>>& tracks() const { return tracks_; }

  /// False outside the recording and between two samples further apart than max_gap.
  static bool lookUp(const std::vector<Sample>& samples, StampNs stamp, StampNs max_gap,
                     bool continuous, double& position);

 private:
  std::map<std::string, std::vector<Sample>> tracks_;
};

}  // namespace collision_pairs
