// Notices when the clock goes back: a bag that loops, a simulation that begins anew.
#pragma once

#include <ros/time.h>

namespace collision_pairs {

/// To be asked once a cycle.
class ClockWatch {
 public:
  /// True once for each time that the clock went back since the last call.
  bool wentBack(const ros::Time& now, const ros::WallTime& wall_now);
  /// Whether transforms of this stamp are left over from before the clock went back. What was still
  /// under way then arrives a little later, with stamps that the clock has yet to reach; it would
  /// be the newest, and hold the poses, until the clock has come there again. Only for a moment
  /// after a jump: stamps ahead of the clock may be sound at other times (clocks that differ).
  bool isLeftOver(const ros::Time& stamp, const ros::Time& now,
                  const ros::WallTime& wall_now) const;
  unsigned nbJumps() const { return nb_jumps_; }

 private:
  ros::Time last_;
  ros::WallTime jumped_;
  unsigned nb_jumps_ = 0;
};

}  // namespace collision_pairs
