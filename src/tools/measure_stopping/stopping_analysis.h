// From recorded commands and joint states: deceleration and reaction time for the velocity limiter.
#pragma once

#include <string>
#include <vector>

#include "stopping_steps.h"

namespace collision_pairs {

struct JointStopping {
  explicit JointStopping(RecordedJoint of) : joint(std::move(of)) {}

  RecordedJoint joint;
  double deceleration = 0.0;  ///< for the limiter, with its margin; rad/s^2 or m/s^2
  /// Of the kind of steps (up or down, slower or faster, alone or not) that has the least; what is
  /// within two standard errors.
  double slope = 0.0, slope_low = 0.0, slope_high = 0.0;
  double dead_time = 0.0;      ///< s, the longest of its steps
  double reaction_time = 0.0;  ///< s, with its margin
  double overshoot = 0.0;      ///< rad or m: how far beyond, and back
  double settled = 0.0;        ///< s from a command until the joint moves as it says, at most
  double outside = 0.0;        ///< rad or m: how far positions leave what is assumed, with noise
  double pushed = 0.0;         ///< the same of steps that are not of the joint alone
  double coupled = 0.0;        ///< rad or m moved at zero command while another joint changes
  std::string coupled_to;
};

struct StoppingAnalysis {
  double reaction_time = 0.0;  ///< s: for the limiter, that of all joints
  std::vector<JointStopping> joints;
  std::vector<std::string> warnings;
};

/// Seconds: the integral of what share of a change of velocity has not come about, negated: how
/// far a joint lags behind its former velocity, `x` s after the dead time, by velocity, if the
/// change takes `ramp` s. Of a change by v the limiter assumes, with R and D, that a joint lags by
/// v lagOf(t - R, v / D) at least, and by v t at most.
double lagOf(double x, double ramp);

/// To each kind of steps a ramp after a dead time is fitted by least squares. Then the reaction
/// time is raised until the whole way of each step is covered, and the deceleration lowered, to a
/// quarter at most, until each part of the way is, up to 1 mrad or mm or the noise, or as long as
/// that covers more; of steps of the joint alone, if there is one of each kind (where others move
/// it then is said). Margins: of the slope 5 % below the least that is within two standard errors;
/// of the reaction time 5 % and 5 ms. Throws InputError that names a joint without states or steps,
/// or one of whose RecordedJoint::unfinished changes goes a quarter further than the result says.
/// Cost: some 1,000 times the states of steps.
StoppingAnalysis analyseStopping(const StoppingRecording& recording);

}  // namespace collision_pairs
