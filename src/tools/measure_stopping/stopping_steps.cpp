#include "stopping_steps.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "collision_pairs/input_error.h"
#include "stamps.h"
#include "turns.h"
#include "user_text.h"

namespace collision_pairs {
namespace {

constexpr double STANDS = 0.05;  // a joint that moves by less, of the way commanded
constexpr double LONGEST_BEFORE = 0.5, LONGEST_AFTER = 2.0;  // s of a step that are looked at
constexpr double AVERAGED = 0.02;                            // s
constexpr double LEAST_NOISE = 1e-6;                         // rad or m
constexpr double LEAST_CHANGE = 0.01;                        // of a velocity
constexpr int LEAST_STATES = 4;                              // in which a velocity is measured
constexpr double LONGEST_GAP = 3.0;                          // periods
constexpr double CLIPPED = 0.05;                             // share of a command
constexpr double SETTLED = 0.02;  // share of a change by which a velocity may still change

double square(double x) { return x * x; }

/// Through the positions of a step between two times, by least squares.
struct Line {
  double at_zero = 0.0, slope = 0.0, error = 0.0, slope_error = 0.0;  ///< at_zero: at the command
  double squares = 0.0;                                               ///< of what is left
  int nb_free = 0;
};

std::optional<Line> lineThrough(const StoppingStep& step, double from, double until) {
  if (step.q.empty()) return std::nullopt;
  double n = 0.0, st = 0.0, sq = 0.0, stt = 0.0, stq = 0.0, sqq = 0.0;
  const double origin = step.q.front();
  for (std::size_t i = 0; i < step.t.size(); ++i) {
    if (step.t[i] < from || step.t[i] > until) continue;
    const double t = step.t[i], q = step.q[i] - origin;
    n += 1.0, st += t, sq += q, stt += t * t, stq += t * q, sqq += q * q;
  }
  if (n < LEAST_STATES) return std::nullopt;
  const double spread = stt - st * st / n;
  if (!(spread > 0.0)) return std::nullopt;
  Line line;
  line.slope = (stq - st * sq / n) / spread;
  line.at_zero = (sq - line.slope * st) / n;
  line.nb_free = static_cast<int>(n) - 2;
  line.squares = std::max(0.0, sqq - line.at_zero * sq - line.slope * stq);
  const double variance = std::max(line.squares / line.nb_free, square(LEAST_NOISE));
  line.error = std::sqrt(variance * stt / (n * spread));
  line.slope_error = std::sqrt(variance / spread);
  line.at_zero += origin;
  return line;
}

/// Whether both halves of the line have one velocity: else the joint is still on its way.
bool isSettled(const StoppingStep& step, double from, double until, double change) {
  const double middle = 0.5 * (from + until);
  const auto first = lineThrough(step, from, middle), last = lineThrough(step, middle, until);
  if (!first || !last) return true;
  const double error = std::hypot(first->slope_error, last->slope_error);
  return std::abs(last->slope - first->slope) <= SETTLED * change + 4.0 * error;
}

}  // namespace

std::vector<double> StoppingStep::beyond() const {
  std::vector<double> ways;
  for (std::size_t i = 0; i < t.size(); ++i) {
    ways.push_back(std::copysign(1.0, from - to) * (q[i] - end - to * t[i]));
  }
  return ways;
}

RecordedJoint::RecordedJoint(const StoppingRecording& recording, std::size_t joint)
    : name(recording.joints[joint]), velocities_{0.0} {
  takeStates(recording.states[joint]);
  if (!recording.commands.empty()) first_command = recording.commands.front().arrival;
  std::vector<double> others(recording.joints.size(), 0.0);
  for (const auto& command : recording.commands) {
    const double velocity = command.velocities[joint];
    std::vector<double> now = command.velocities;
    now[joint] = 0.0;
    if (now != others) times_of_others_.push_back(command.arrival);
    others = std::move(now);
    if (velocity == velocities_.back()) continue;
    times_.push_back(command.arrival);
    velocities_.push_back(velocity);
  }
  double longest_way = 0.0;  // the longest way of one command
  for (std::size_t i = 0; i < times_.size(); ++i) {
    const double last = i > 0 ? times_[i - 1] : states_.front().stamp;
    const double next = i + 1 < times_.size() ? times_[i + 1] : states_.back().stamp;
    if (!takeStep(i, times_[i] - last, next - times_[i])) ++nb_other;
    longest_way = std::max(longest_way, std::abs(velocities_[i + 1]) * (next - times_[i]));
  }
  const auto [low, high] =
      std::minmax_element(states_.begin(), states_.end(),
                          [](const auto& a, const auto& b) { return a.position < b.position; });
  if (steps.empty() && high->position - low->position < STANDS * longest_way) {
    throw InputError("joint '" + name +
                     "' stood still, though it was commanded to move: is the "
                     "order of --joints that of the commands, and does its drive follow them?");
  }
  if (steps.empty()) {
    throw InputError("joint '" + name + "' has no step of its command that can be measured (" +
                     std::to_string(nb_other) + " changes): hold each velocity for at least " +
                     inWords(STEP_HOLD) + ", better 1 s, while joint states are recorded");
  }
  noise = std::max(LEAST_NOISE, std::sqrt(squares_ / nb_free_));
}

void RecordedJoint::takeStates(std::vector<StoppingRecording::State> states) {
  std::vector<double> periods;
  for (auto& state : states) {
    latest = std::max(latest, state.arrival - state.stamp);
    ahead = std::max(ahead, state.stamp - state.arrival);
    state.stamp = measuredAt(state.stamp, state.arrival);
  }
  std::stable_sort(states.begin(), states.end(),
                   [](const auto& a, const auto& b) { return a.stamp < b.stamp; });
  for (const auto& state : states) {
    if (!states_.empty()) {
      if (state.stamp <= states_.back().stamp) continue;
      periods.push_back(state.stamp - states_.back().stamp);
    }
    states_.push_back(state);
    if (states_.size() < 2) continue;
    double& position = states_.back().position;
    position -= wholeTurns(position - states_[states_.size() - 2].position);
  }
  if (periods.empty()) throw InputError("no joint state has a position of joint '" + name + "'");
  const auto middle = periods.begin() + static_cast<std::ptrdiff_t>(periods.size() / 2);
  std::nth_element(periods.begin(), middle, periods.end());
  period = *middle;
}

void RecordedJoint::gather(double time, double from, double until, StoppingStep& step) const {
  const auto isEarlier = [](const auto& state, double t) { return state.stamp < t; };
  auto state = std::lower_bound(states_.begin(), states_.end(), time + from, isEarlier);
  for (; state != states_.end() && state->stamp <= time + until; ++state) {
    step.t.push_back(state->stamp - time);
    step.q.push_back(state->position);
  }
}

bool RecordedJoint::takeStep(std::size_t i, double before, double after) {
  if (before < STEP_HOLD || after < STEP_HOLD) return false;
  StoppingStep step;
  step.time = times_[i];
  step.seconds = std::min(after, LONGEST_AFTER);
  gather(step.time, -std::min(0.5 * before, LONGEST_BEFORE), step.seconds, step);
  const auto first = lineThrough(step, -before, 0.0);
  const auto last = lineThrough(step, 0.5 * step.seconds, step.seconds);
  if (!first) return false;
  step.commanded_from = velocities_[i], step.commanded_to = velocities_[i + 1];
  step.from = first->slope, step.to = last ? last->slope : step.commanded_to;
  step.start = first->at_zero;
  step.velocity_error = first->slope_error;
  const double change = step.change();
  if (!isSettled(step, step.t.front(), 0.0, change)) return false;
  bool is_whole = last.has_value();
  for (std::size_t k = 1; k < step.t.size(); ++k) {
    is_whole = is_whole && step.t[k] - step.t[k - 1] <= LONGEST_GAP * period;
  }
  if (!is_whole || !isSettled(step, 0.5 * step.seconds, step.seconds, change)) {
    unfinished.push_back(std::move(step));
    return false;
  }
  compare(velocities_[i], first->slope, 3.0 * first->slope_error);
  compare(velocities_[i + 1], last->slope, 3.0 * last->slope_error);
  if (change < LEAST_CHANGE) return false;
  squares_ += first->squares + last->squares;
  nb_free_ += first->nb_free + last->nb_free;
  step.end = last->at_zero;
  step.error = std::hypot(first->error, last->error);
  step.velocity_error = std::hypot(first->slope_error, last->slope_error);
  const auto other =
      std::lower_bound(times_of_others_.begin(), times_of_others_.end(), step.time - STEP_HOLD);
  step.is_alone = other == times_of_others_.end() || *other > step.time + step.seconds;
  steps.push_back(std::move(step));
  return true;
}

void RecordedJoint::compare(double velocity, double measured, double error) {
  const double difference = std::abs(measured - velocity);
  if (velocity == 0.0) {
    drift = std::max(drift, difference - error);
  } else if (difference > CLIPPED * std::abs(velocity) + error &&
             difference > std::abs(commanded - reached)) {
    commanded = velocity, reached = measured;
  }
}

double RecordedJoint::averagedNoise() const {
  return noise / std::sqrt(std::max(1.0, std::floor(AVERAGED / period)));
}

std::vector<double> RecordedJoint::averaged(const std::vector<double>& values) const {
  const auto count = static_cast<std::size_t>(std::max(1.0, std::floor(AVERAGED / period)));
  std::vector<double> means;
  double sum = 0.0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    sum += values[i];
    if (i >= count) sum -= values[i - count];
    if (i + 1 >= count) means.push_back(sum / static_cast<double>(count));
  }
  return means;
}

double RecordedJoint::movedBy(const StoppingStep& other) const {
  const double begin = other.time - STEP_HOLD, end = other.time + other.seconds;
  const auto change = std::upper_bound(times_.begin(), times_.end(), begin - STEP_HOLD);
  const auto at = static_cast<std::size_t>(change - times_.begin());
  if (velocities_[at] != 0.0 || (change != times_.end() && *change <= end)) return 0.0;
  StoppingStep idle;
  gather(other.time, -STEP_HOLD, other.seconds, idle);
  const auto before = lineThrough(idle, -STEP_HOLD, 0.0);
  if (!before) return 0.0;
  double mean = 0.0, count = 0.0, furthest = 0.0;
  for (std::size_t i = 0; i < idle.t.size() && idle.t[i] <= 0.0; ++i) mean += idle.q[i], ++count;
  mean /= count;
  for (double& q : idle.q) q -= mean;
  for (const double q : averaged(idle.q)) furthest = std::max(furthest, std::abs(q));
  return std::max(0.0, furthest - 5.0 * averagedNoise());
}

}  // namespace collision_pairs
