// What recorded velocity commands and joint states say of one joint: steps, noise, drift.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace collision_pairs {

/// All times in seconds on one clock; positions in rad or m.
struct StoppingRecording {
  struct Command {
    double arrival;
    std::vector<double> velocities;  ///< by joint
  };
  struct State {
    double stamp, arrival, position;
  };
  std::vector<std::string> joints;
  std::vector<Command> commands;           ///< by arrival
  std::vector<std::vector<State>> states;  ///< by joint, in any order
};

/// Seconds for which a command must be held before and after its change to be a step.
constexpr double STEP_HOLD = 0.4;

/// A change of a joint's command that was held. Its positions are on one line before, and on
/// another one from half of the time on.
struct StoppingStep {
  double time = 0.0;     ///< arrival of the command
  double seconds = 0.0;  ///< until the next change, or the end; 2 at most
  double commanded_from = 0.0, commanded_to = 0.0;
  double from = 0.0, to = 0.0;    ///< velocities as they were measured: slopes of the lines
  double start = 0.0, end = 0.0;  ///< positions of the lines at `time`
  double error = 0.0, velocity_error = 0.0;  ///< standard errors of end - start, and of velocities
  bool is_alone = true;      ///< no other joint's command changes in its time, nor STEP_HOLD before
  std::vector<double> t, q;  ///< joint states: seconds since `time`, positions

  double change() const { return from > to ? from - to : to - from; }
  /// Seconds: as if the velocity had changed at once, so much later.
  double delay() const { return (end - start) / (from - to); }
  /// Positions ahead of the line after, in the direction in which the joint comes to it.
  std::vector<double> beyond() const;
};

class RecordedJoint {
 public:
  /// Throws InputError if it has no states or no step.
  RecordedJoint(const StoppingRecording& recording, std::size_t joint);

  std::string name;
  std::vector<StoppingStep> steps;
  /// Held as well, but not until the joint followed, or joint states are missing: `to` is how it
  /// moved at last. Nothing is measured in these, but they may be the slowest.
  std::vector<StoppingStep> unfinished;
  std::size_t nb_other = 0;               ///< changes that are no steps
  double first_command = 0.0;             ///< its arrival
  double noise = 0.0;                     ///< standard deviation of positions
  double period = 0.0;                    ///< s: median of the states'
  double latest = 0.0;                    ///< s: most from stamp to arrival
  double ahead = 0.0;                     ///< s: most by which a stamp is later than its arrival
  double drift = 0.0;                     ///< largest velocity at zero command, beyond the noise
  double commanded = 0.0, reached = 0.0;  ///< the worst of the velocities that were not reached

  /// Means over 20 ms, and what their noise is.
  std::vector<double> averaged(const std::vector<double>& values) const;
  double averagedNoise() const;

  /// How far it moves at zero command in the time of another joint's step, beyond the noise.
  double movedBy(const StoppingStep& other) const;

 private:
  void takeStates(std::vector<StoppingRecording::State> states);
  void gather(double time, double from, double until, StoppingStep& step) const;
  bool takeStep(std::size_t i, double before, double after);
  void compare(double velocity, double measured, double error);

  std::vector<StoppingRecording::State> states_;  ///< `stamp`: when it was measured, at the latest
  std::vector<double> times_, velocities_;        ///< velocities_[i] is commanded until times_[i]
  std::vector<double> times_of_others_;           ///< when the command of another joint changes
  double squares_ = 0.0;
  int nb_free_ = 0;
};

}  // namespace collision_pairs
