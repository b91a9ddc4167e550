// The transforms as they were received, and the clock that their stamps are compared with.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include <tf2_msgs/TFMessage.h>

#include "now.h"
#include "robot_poses.h"

namespace collision_pairs {

/// Message: no poses are known while ROS time is zero.
extern const char* const NO_CLOCK;

StampNs toNs(const ros::Time& stamp);
/// NEVER (static) becomes 0.
ros::Time toTime(StampNs stamp);

/// Seconds. ros::Duration throws beyond 68 years, and stamps may be anything.
inline double secondsBetween(const ros::Time& begin, const ros::Time& end) {
  return end.toSec() - begin.toSec();
}

/// How time and transforms are understood.
struct TransformSettings {
  PoseLimits limits;
  bool is_simulated = false;  ///< ROS time is what /clock says
  bool allow_paused = false;  ///< … and may stand still for longer than max_pose_age of wall time
};

/// A TransformBuffer, and a watch on the clock. Not thread safe.
class TransformInput {
 public:
  TransformInput(const PoseLimits& limits = {}) : TransformInput(TransformSettings{limits}) {}
  explicit TransformInput(const TransformSettings& settings)
      : settings_(settings), buffer_(settings.limits) {}

  /// If the clock went back (a bag that loops, a simulation that restarts), all transforms except
  /// static ones are discarded. At steps back of 0.1 s or less (the clock of a computer that is
  /// being set), time stands still until the clock has caught up.
  void followClock(const Now& now);
  const Now& now() const { return now_; }
  unsigned nbClockJumps() const { return nb_clock_jumps_; }
  /// Whether the last time the clock went back, a simulation or a bag began anew: /clock by more
  /// than 5 s. Otherwise the world is the same, and the clock was set.
  bool isNewRun() const { return is_new_run_; }
  /// Why the current poses may be of another time than it seems: a simulated clock stands still.
  /// Empty if it runs, or may pause.
  std::string clockProblem() const;

  /// Adds the valid transforms to the buffer. Stamps of static transforms are ignored.
  void take(const tf2_msgs::TFMessage& message, bool is_static, const Now& now,
            const std::string& publisher = "");
  /// Number of messages received. If it changes, a look-up that failed may succeed.
  std::uint64_t nbTaken() const { return nb_taken_; }
  /// The frames whose transforms are being refused or are suspect, with the reasons, sorted. A
  /// frame leaves the list with its next valid transform, or when nothing was wrong for 2 s.
  std::vector<std::string> refused() const;

  /// Of all that were received: how many were refused or suspect, and the first of them.
  std::uint64_t nbRefused() const { return nb_refused_; }
  const std::string& firstRefused() const { return first_refused_; }

  const PoseLimits& limits() const { return settings_.limits; }
  const TransformBuffer& buffer() const { return buffer_; }

  struct Found {
    Eigen::Isometry3d X_TS;
    ros::Time stamp;  ///< 0: of static transforms only
  };
  /// Pose of `source` in `target` at that stamp; at 0 the newest. With a robot, of this buffer,
  /// also by its fixed joints. Throws InputError.
  Found lookUp(const std::string& target, const std::string& source, const ros::Time& stamp,
               const RobotPoses* robot = nullptr) const;

 private:
  struct Refusal {
    std::string why;
    double when;  ///< on the steady clock
  };

  std::string takeOne(const geometry_msgs::TransformStamped& transform, bool is_static,
                      const std::string& publisher);

  const TransformSettings settings_;
  TransformBuffer buffer_;
  std::uint64_t nb_taken_ = 0, nb_refused_ = 0;
  std::string first_refused_;
  std::map<std::string, Refusal> refusals_;  // by child frame
  Now now_ = Now(ros::Time(), 0.0);
  double last_step_ = 0.0;  // when ROS time moved, on the steady clock
  unsigned nb_clock_jumps_ = 0;
  bool is_new_run_ = false;
};

}  // namespace collision_pairs
