// The newest positions of joints, from sensor_msgs/JointState.
#pragma once

#include <map>
#include <string>
#include <vector>

#include <sensor_msgs/JointState.h>

namespace collision_pairs {

/// Messages may name some of the joints, and come late, twice or out of order: of each joint the
/// position with the newest stamp counts.
class JointPositions {
 public:
  struct Position {
    double stamp = 0.0;  ///< s
    double value = 0.0;  ///< rad or m; may be NaN
  };

  /// A stamp more than `tolerance` seconds ahead of `now` is refused, with the whole message.
  void take(const sensor_msgs::JointState& message, double now, double tolerance);
  void clear() { newest_.clear(); }
  const std::map<std::string, Position>& all() const { return newest_; }

  /// The oldest stamp of these joints. Throws InputError for a joint that nobody has reported, or
  /// whose position is not finite.
  double oldestOf(const std::vector<std::string>& joints) const;

 private:
  std::map<std::string, Position> newest_;
};

}  // namespace collision_pairs
