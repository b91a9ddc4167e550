// What drive_steps does, with a simulated robot: a recording for measure_stopping.
#pragma once

#include <string>
#include <vector>

#include "limiter_simulation.h"
#include "stopping_steps.h"

namespace collision_pairs {

struct StepsOptions {
  double velocity = 1.0, hold = 1.0;  ///< rad/s, s
  int nb_postures = 3;  ///< others than the first, each at the end of a motion of all joints
};

/// Dead times, rates, lateness and noise are those of the options; the robot stands in `from`.
StoppingRecording driveSteps(const SimulationOptions& options, const StepsOptions& steps,
                             const std::vector<std::string>& joints,
                             const std::vector<double>& from, RandomInputs& random);

/// Topics /command and /joint_states.
void writeBag(const StoppingRecording& recording, const std::string& path);

}  // namespace collision_pairs
