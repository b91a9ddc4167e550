// What the velocity limiter reads of joint states, and of commands of type
// trajectory_msgs/JointTrajectory.
#pragma once

#include <map>
#include <string>
#include <vector>

#include <sensor_msgs/JointState.h>
#include <std_msgs/Float64MultiArray.h>
#include <trajectory_msgs/JointTrajectory.h>

#include "limiter_law.h"
#include "limiter_parameters.h"

namespace collision_pairs {

/// The newest positions of joints. Messages may name some of the joints, and come late, twice or
/// out of order: of each joint the position with the newest stamp counts, of what positionsIn() a
/// message. Times are those of the clock of stamps, in seconds.
class JointPositions {
 public:
  struct Position {
    double stamp = 0.0;
    double measured = 0.0;  ///< at the latest: measuredAt()
    double value = 0.0;     ///< rad or m; may be NaN
  };

  /// A stamp more than `tolerance` ahead of `now` is refused, with the whole message: either the
  /// clock is late, or that of the sender is ahead, so the age of nothing is known.
  void take(const sensor_msgs::JointState& message, double now, double tolerance);
  void clear();
  const std::map<std::string, Position>& all() const { return newest_; }

  /// When the oldest position of these joints was measured. Throws InputError for a joint that
  /// nobody has reported, whose position is not finite, or of which positions are refused: until
  /// the clock has gone on for `tolerance` without one. Also for a joint whose position is older
  /// than `tolerance`, if a message has come since that cannot be used.
  double oldestOf(const std::vector<std::string>& joints, double now, double tolerance) const;
  /// Whether these joints are where they were measured, `most` seconds ago at the longest: false
  /// where oldestOf() throws.
  bool areYoung(const std::vector<std::string>& joints, double now, double most) const;
  /// The newest stamp of these joints; -infinity if there is none.
  double newestStampOf(const std::vector<std::string>& joints) const;

 private:
  bool isRoomFor(const std::string& name) const;

  struct Refused {
    double ahead = 0.0, when = 0.0;
  };
  std::map<std::string, Position> newest_;
  std::map<std::string, Refused> refused_;
  std::map<std::string, double> uneven_;  // when a message came with a name, but differInNumber()
};

/// Whether a velocity is more than 1e-6 rad/s or m/s, or not a number.
bool asksToMove(const std_msgs::Float64MultiArray& command);
bool asksToMove(const trajectory_msgs::JointTrajectory& command);

/// Throws InputError if who reads commands from one topic and passes them on to the other would
/// hear itself: topics, resolved.
void refuseLoop(const std::string& read, const std::string& passed_on);

/// The command with the velocities that the decision passes, in the command's order. Positions, if
/// it has some, are on the way from the measured ones to the given ones, by the scale, and no
/// further from them than these velocities lead in time_from_start; there are none if a measured
/// one is older than max_joint_state_age at `now`: they would lead there from wherever the robot
/// is. Of a command that is not isAccepted(): zeros of the limiter's `joints`, whatever it names,
/// with positions if it has some. All begins now, whatever stamp the command has, since later it is
/// not certified, and is reached in the command's own time_from_start: a ramp of a length that was
/// chosen here would begin anew with each repetition, and never end. It has
/// SHORTEST_TIME_FROM_START at least.
trajectory_msgs::JointTrajectory limitedTrajectory(const trajectory_msgs::JointTrajectory& command,
                                                   const LimiterParameters& parameters,
                                                   const LimiterDecision& decision,
                                                   const JointPositions& measured, double now);

}  // namespace collision_pairs
