// Recorded joint positions, for look-up at any stamp.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "track.h"

namespace collision_pairs {

struct JointPosition {
  double position;  ///< rad or m
};

/// For Track. Positions a full turn apart agree.
bool contradicts(const JointPosition& sample, const JointPosition& earlier,
                 const JointPosition& before, const JointPosition& after, std::string& how);
inline bool areConnected(const JointPosition&, const JointPosition&) { return true; }

/// By the same rules as transforms, since robot_state_publisher would place the link there. Between
/// two samples it interpolates on a straight line (a continuous joint: the shorter way round).
class JointTracks {
 public:
  struct OfJoint {
    Track<JointPosition> track;
    std::vector<StampNs> stamps;  ///< of all that were received, also of those refused
  };

  /// In the order of arrival, at `now`. Returns why it was refused or is in doubt; empty if all is
  /// well.
  std::string take(const std::string& joint, double position, StampNs stamp,
                   const std::string& publisher, StampNs now, const TrackLimits& limits);

  bool has(const std::string& joint) const { return joints_.count(joint) > 0; }
  const std::map<std::string, OfJoint>& joints() const { return joints_; }

  /// False if it was not known then, or is in doubt; `why` then says so.
  static bool lookUp(const OfJoint& joint, StampNs stamp, const TrackLimits& limits,
                     bool continuous, double& position, std::string& why);

 private:
  std::map<std::string, OfJoint> joints_;
  std::vector<std::string> publishers_;
};

}  // namespace collision_pairs
