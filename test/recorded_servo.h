// A joint that follows steps of its command, and the joint states that are recorded of it.
#pragma once

#include <algorithm>
#include <vector>

#include "random_inputs.h"
#include "stopping_analysis.h"

namespace collision_pairs {

constexpr double DT = 0.0005;

/// A joint that follows commands: dead time, ramp, then a lag of first order or a servo of second.
struct Servo {
  double least_dead_time = 0.05, dead_time = 0.05, slope = 4.0, lag = 0.0;
  double frequency = 0.0, damping = 1.0;  ///< rad/s; 0: no servo of second order
  double creep = 0.0, creep_time = 0.12;  ///< share of the velocity that comes later; s
  double slope_up = 0.0;                  ///< of rising velocities; 0: as the others
};

struct Recorder {
  double rate = 200.0, noise = 0.001, delay = 0.01;
  double stamped_late = 0.0;  ///< stamp, after the measurement
};

struct Truth {
  std::vector<double> changes, values;  ///< commands: times and velocities
  std::vector<double> positions;        ///< by DT
  double dead_time = 0.0;               ///< the longest that occurred
};

/// To each velocity, and back to zero, both ways, then reversed.
inline std::vector<double> stepsAt(const std::vector<double>& velocities) {
  std::vector<double> steps;
  for (const double v : velocities) {
    for (const double step : {v, 0.0, -v, 0.0, v, -v, 0.0}) steps.push_back(step);
  }
  return steps;
}

inline Truth drive(RandomInputs& random, const Servo& servo, const std::vector<double>& steps,
                   double begin, double hold, double end) {
  Truth truth;
  std::vector<double> in_effect;
  double ready = 0.0;
  for (std::size_t i = 0; i < steps.size(); ++i) {
    const double dead_time = random.uniform(servo.least_dead_time, servo.dead_time);
    truth.changes.push_back(begin + hold * static_cast<double>(i));
    truth.values.push_back(steps[i]);
    ready = std::max(ready, truth.changes.back() + dead_time);
    in_effect.push_back(ready);
    truth.dead_time = std::max(truth.dead_time, dead_time);
  }
  double wanted = 0.0, ramp = 0.0, lagging = 0.0, creeping = 0.0, v = 0.0, a = 0.0, q = 0.0;
  std::size_t next = 0;
  for (double t = 0.0; t < end; t += DT) {
    truth.positions.push_back(q);
    while (next < steps.size() && in_effect[next] <= t) wanted = steps[next++];
    const double up = servo.slope_up > 0.0 ? servo.slope_up : servo.slope;
    ramp += std::clamp(wanted - ramp, -servo.slope * DT, up * DT);
    lagging = servo.lag > 0.0 ? lagging + (ramp - lagging) * DT / servo.lag : ramp;
    if (servo.frequency > 0.0) {
      const double w = servo.frequency;
      a += (w * w * (lagging - v) - 2.0 * servo.damping * w * a) * DT;
      v += a * DT;
    } else {
      v = lagging;
    }
    creeping += (v - creeping) * DT / servo.creep_time;
    q += (v + servo.creep * (creeping - v)) * DT;
  }
  return truth;
}

inline void record(RandomInputs& random, const Truth& truth, const Recorder& recorder,
                   std::vector<StoppingRecording::State>& states) {
  const double end = DT * static_cast<double>(truth.positions.size() - 1);
  for (double t = 0.0; t < end; t += 1.0 / recorder.rate) {
    const double at = t / DT;
    const auto i = static_cast<std::size_t>(at);
    const double share = at - static_cast<double>(i);
    const double q =
        i + 1 < truth.positions.size()
            ? truth.positions[i] + share * (truth.positions[i + 1] - truth.positions[i])
            : truth.positions[i];
    const double stamp = t + recorder.stamped_late;
    states.push_back({stamp, stamp + random.uniform(0.0, recorder.delay),
                      q + recorder.noise * random.uniform(-1.0, 1.0)});
  }
}

}  // namespace collision_pairs
