// What drive_steps does, with a simulated robot: a recording for measure_stopping.
#pragma once

#include <string>
#include <vector>

#include "limiter_simulation.h"
#include "stopping_steps.h"

namespace collision_pairs {

/// In each posture, which are reached joint by joint: steps of one joint after the other, and of
/// all together. Dead times, rates, lateness and noise are those of the options.
StoppingRecording driveSteps(const SimulationOptions& options,
                             const std::vector<std::string>& joints,
                             const std::vector<std::vector<double>>& postures,
                             RandomInputs& random);

/// Topics /command and /joint_states.
void writeBag(const StoppingRecording& recording, const std::string& path);

}  // namespace collision_pairs
