// What the velocity limiter has received, and what is known when it decides.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include <sensor_msgs/JointState.h>

#include "certified_surroundings.h"
#include "command_outlet.h"
#include "limited_command.h"
#include "limiter_clock.h"
#include "monitor.h"

namespace collision_pairs {

/// Joint states and times; without threads, and without a clock of its own. Not thread safe.
class LimiterInputs {
 public:
  struct Settings {
    std::vector<std::string> joints;  ///< of the command
    double max_joint_state_age = 0.1;
    double command_timeout = 0.2;
    bool is_simulated = false;  ///< ROS time is what /clock says
    bool allow_paused = false;  ///< … and may stand still
    double tracking_tolerance = 0.01;
    double max_pose_age = 1.0;  ///< 0: no limit; of joints that are not of the command
  };
  /// Seconds of ROS time and of a clock that never jumps, and how often the monitor has seen the
  /// former jump.
  struct Clocks {
    double ros = 0.0, steady = 0.0;
    unsigned nb_jumps = 0;
  };

  explicit LimiterInputs(Settings settings);

  /// It is that time now. Where the clock went back, the joint states before are of another time,
  /// and dropped.
  CommandOutlet::Time follow(const Clocks& clocks);
  /// Of the last call: for a time about which the monitor was not asked.
  unsigned nbJumps() const { return clock_.nbJumps(); }

  /// What is new of joints of the command, and whether the clock was set since the last message.
  struct Taken {
    bool has_jumped = false;
    std::vector<ResponseWatch::Position> positions;
  };
  Taken take(const sensor_msgs::JointState& message, const Clocks& clocks);
  const JointPositions& positions() const { return positions_; }

  /// What is known of the time and of joints for a command that is passed a little later.
  struct Moment {
    double now = 0.0;    ///< s of ROS time, when it is passed
    LimiterInput input;  ///< `now`, `stamp` and `later`, on the law's time
    unsigned nb_jumps = 0;
    struct Measured {
      std::string joint;
      double value, age;  ///< rad or m, s
    };
    std::vector<Measured> positions;  ///< those that are not too old
    std::vector<std::string> moved;   ///< joints of the command
    double young = 0.0;      ///< s: max_joint_state_age, up to which joints of the command are used
    double tolerance = 0.0;  ///< rad or m: tracking_tolerance
    std::vector<std::string> unknown_because;
  };
  Moment at(const Clocks& clocks, double later);

 private:
  const Settings settings_;
  JointPositions positions_;
  LimiterClock clock_;
  bool has_jumped_ = false;           // since the last message
  double offset_ = 0.0;               // of the clocks, then
  std::vector<double> taken_stamps_;  // by joint, of the last that was taken
};

/// All that is known for the decision: the monitor's snapshot for the measured positions, with the
/// reasons of the moment. Of one without any `state` is set, and the rest of `input` but for the
/// command. Throws InputError if there is no robot, or as Monitor::withMeasured() does.
Snapshot snapshotAt(const LimiterInputs::Moment& moment, const Monitor& monitor,
                    LimiterInput& input, RobotState& state);

}  // namespace collision_pairs
