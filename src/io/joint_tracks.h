// All joint positions of a recording, to be asked for at any instant.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "transform_tracks.h"

namespace collision_pairs {

/// Joint positions by name. Between two samples it interpolates on a straight line (a continuous
/// joint: on the shorter way round), which is where robot_state_publisher and TF would put the
/// link; it never extrapolates, and never interpolates over a gap that is too long.
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

  /// False outside of what was recorded and between two samples further apart than max_gap.
  static bool lookUp(const std::vector<Sample>& samples, StampNs stamp, StampNs max_gap,
                     bool continuous, double& position);

 private:
  std::map<std::string, std::vector<Sample>> tracks_;
};

}  // namespace collision_pairs
