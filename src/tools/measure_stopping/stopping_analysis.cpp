#include "stopping_analysis.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <set>
#include <tuple>
#include <utility>

#include <Eigen/Cholesky>
#include <Eigen/Core>

#include "collision_pairs/input_error.h"
#include "user_text.h"

namespace collision_pairs {
namespace {

constexpr double SLOPE_MARGIN = 0.05, DEAD_TIME_MARGIN = 0.05, DEAD_TIME_EXTRA = 0.005;
constexpr double LEAST_WAY = 1e-3;  // rad or m: less is not worth a slower limiter
constexpr double LEAST_DRIFT = 1e-3;
constexpr double MUCH_FURTHER = 0.25;  // share of the way of a change
constexpr double OLDEST_STATE = 0.08;  // s: max_joint_state_age, but for the time of a decision
constexpr std::size_t LEAST_STOPS = 4;
constexpr double TWO_SPEEDS = 1.5;     // ratio
constexpr double KNOWN_SLOPE = 1.2;    // ratio of the ends of its interval: 15 % with the margin
constexpr double LOWEST_SHARE = 0.25;  // of the fitted deceleration
constexpr double WORTH_LOWERING = 0.8, MUCH_LOWER = 0.8;  // ratios
constexpr int SLOPES = 24, BISECTIONS = 10;

/// The lowest point of a function with one minimum, by golden section search.
double lowestOf(const std::function<double(double)>& f, double low, double high, int steps) {
  const double ratio = 0.5 * (std::sqrt(5.0) - 1.0);
  double a = high - ratio * (high - low), b = low + ratio * (high - low);
  double at_a = f(a), at_b = f(b);
  for (int i = 0; i < steps; ++i) {
    if (at_a < at_b) {
      high = b, b = a, at_b = at_a;
      at_a = f(a = high - ratio * (high - low));
    } else {
      low = a, a = b, at_a = at_b;
      at_b = f(b = low + ratio * (high - low));
    }
  }
  return at_a < at_b ? a : b;
}

/// The sum of squares that a ramp after a dead time leaves, with the position and the velocities
/// that fit best.
double squaresOf(const StoppingStep& step, double dead_time, double ramp) {
  double n = 0.0, t1 = 0.0, t2 = 0.0, l1 = 0.0, l2 = 0.0, tl = 0.0;
  double q1 = 0.0, q2 = 0.0, tq = 0.0, lq = 0.0;
  for (std::size_t i = 0; i < step.t.size(); ++i) {
    const double t = step.t[i], lag = lagOf(t - dead_time, ramp);
    const double q = step.q[i] - step.start - step.from * t;
    n += 1.0, t1 += t, t2 += t * t, l1 += lag, l2 += lag * lag, tl += t * lag;
    q1 += q, q2 += q * q, tq += t * q, lq += lag * q;
  }
  Eigen::Matrix3d normal;
  normal << n, t1, l1, t1, t2, tl, l1, tl, l2;
  const Eigen::Vector3d right(q1, tq, lq);
  return std::max(0.0, q2 - right.dot(normal.ldlt().solve(right)));
}

double deadTimeOf(const StoppingStep& step, double slope) {
  const double ramp = step.change() / slope, middle = step.delay() - 0.5 * ramp;
  const double width = 0.02 + 0.25 * ramp;
  return lowestOf([&](double dead_time) { return squaresOf(step, dead_time, ramp); },
                  middle - width, middle + width, 14);
}

struct SlopeInterval {
  double low, best, high;
};

/// One slope for all of these steps, each with a dead time of its own.
SlopeInterval slopeOf(const std::vector<const StoppingStep*>& steps, const RecordedJoint& joint) {
  double change = 0.0, longest = joint.period, count = 0.0;
  for (const StoppingStep* step : steps) {
    change = std::max(change, step->change());
    longest = std::max(longest, step->delay());
    count += static_cast<double>(step->t.size());
  }
  const auto squares = [&](double logarithm) {
    double sum = 0.0;
    for (const StoppingStep* step : steps) {
      const double slope = std::exp(logarithm);
      sum += squaresOf(*step, deadTimeOf(*step, slope), step->change() / slope);
    }
    return sum;
  };
  const double first = std::log(change / (2.0 * longest + 0.05));
  const double last = std::log(change / (0.1 * joint.period));
  const double width = (last - first) / SLOPES;
  double best = first, least = squares(first);
  for (int i = 1; i <= SLOPES; ++i) {
    const double at = first + width * i, found = squares(at);
    if (found < least) best = at, least = found;
  }
  best = lowestOf(squares, best - width, best + width, 12);
  least = squares(best);
  const double variance = std::max(least / count, joint.noise * joint.noise);
  const auto endOf = [&](double outside) {
    double inside = best;
    if (squares(outside) <= least + 4.0 * variance) return outside;
    for (int i = 0; i < BISECTIONS; ++i) {
      const double middle = 0.5 * (inside + outside);
      (squares(middle) <= least + 4.0 * variance ? inside : outside) = middle;
    }
    return outside;
  };
  return {std::exp(endOf(std::min(first, best))), std::exp(best),
          std::exp(endOf(std::max(last, best)))};
}

/// Down or up, slower or faster, of the joint alone or not.
using Kind = std::tuple<bool, bool, bool>;

Kind kindOf(const StoppingStep& step, bool is_alone) {
  const bool is_slower = std::abs(step.commanded_from) > std::abs(step.commanded_to);
  return {step.from > step.to, is_slower, is_alone};
}

void findSlope(JointStopping& found) {
  std::map<Kind, std::vector<const StoppingStep*>> kinds;
  for (const StoppingStep& step : found.joint.steps) {
    kinds[kindOf(step, step.is_alone)].push_back(&step);
  }
  for (const auto& [kind, steps] : kinds) {
    const SlopeInterval slope = slopeOf(steps, found.joint);
    for (const StoppingStep* step : steps) {
      found.dead_time = std::max(found.dead_time, deadTimeOf(*step, slope.high));
    }
    if (found.slope_low > 0.0 && slope.low >= found.slope_low) continue;
    found.slope_low = slope.low, found.slope = slope.best, found.slope_high = slope.high;
  }
  found.deceleration = (1.0 - SLOPE_MARGIN) * found.slope_low;
}

/// How the joint comes to its new velocity, and what the whole way of a step needs.
void findReactionTime(JointStopping& found) {
  const RecordedJoint& joint = found.joint;
  const double noise = joint.averagedNoise();
  double longest = found.dead_time;
  for (const StoppingStep& step : joint.steps) {
    const std::vector<double> beyond = joint.averaged(step.beyond());
    const std::size_t cut = step.t.size() - beyond.size();  // a mean has the time of its last state
    double furthest = 0.0;
    for (std::size_t i = 0; i < beyond.size(); ++i) {
      const double t = step.t[i + cut];
      const double known = 5.0 * noise + 3.0 * step.velocity_error * std::abs(t);
      if (t > step.delay()) furthest = std::max(furthest, beyond[i] - known);
      if (std::abs(beyond[i]) > known + LEAST_WAY) found.settled = std::max(found.settled, t);
    }
    found.overshoot = std::max(found.overshoot, furthest);
    const double whole = step.delay() + (step.error + furthest) / step.change();
    longest = std::max(longest, whole - 0.5 * step.change() / found.deceleration);
  }
  found.reaction_time = (1.0 + DEAD_TIME_MARGIN) * longest + DEAD_TIME_EXTRA;
}

/// What of a difference of positions is noise, or little.
double allowedWay(const RecordedJoint& joint) {
  return std::max(8.0 * joint.averagedNoise(), LEAST_WAY);
}

/// The furthest that positions go, from any earlier one, beyond what the limiter assumes.
double outsideOf(const StoppingStep& step, const JointStopping& found, double reaction_time) {
  const double ramp = step.change() / found.deceleration, sign = step.from > step.to ? 1.0 : -1.0;
  std::vector<double> ahead;
  for (std::size_t i = 0; i < step.t.size(); ++i) {
    const double t = step.t[i];
    if (t < 0.0) continue;
    const double assumed =
        step.start + step.from * t - sign * step.change() * lagOf(t - reaction_time, ramp);
    ahead.push_back(sign * (step.q[i] - assumed) - 4.0 * step.velocity_error * t);
  }
  double lowest = INFINITY, way = 0.0;
  for (const double at : found.joint.averaged(ahead)) {
    lowest = std::min(lowest, at);
    way = std::max(way, at - lowest);
  }
  return way;
}

/// Of each kind of step those of the joint alone, or all if there is a kind without such.
std::vector<const StoppingStep*> ownSteps(const std::vector<StoppingStep>& steps) {
  std::set<Kind> kinds;
  std::vector<const StoppingStep*> own, all;
  for (const StoppingStep& step : steps) {
    all.push_back(&step);
    if (!step.is_alone) continue;
    own.push_back(&step);
    kinds.insert(kindOf(step, true));
  }
  const auto isKnown = [&](const StoppingStep& step) {
    return kinds.count(kindOf(step, true)) > 0;
  };
  return std::all_of(steps.begin(), steps.end(), isKnown) ? own : all;
}

double furthestOutside(const std::vector<const StoppingStep*>& steps, const JointStopping& found,
                       double reaction_time) {
  double outside = 0.0;
  for (const StoppingStep* step : steps) {
    outside = std::max(outside, outsideOf(*step, found, reaction_time));
  }
  return outside;
}

/// A lower one makes the limiter slower: it counts only where more is covered by it. Where others
/// move the joint is no matter of its deceleration.
void lowerDeceleration(JointStopping& found, double reaction_time) {
  const double allowed = allowedWay(found.joint), fitted = found.deceleration;
  const std::vector<const StoppingStep*> steps = ownSteps(found.joint.steps);
  double best = fitted, least_outside = INFINITY;
  while (least_outside > allowed && found.deceleration > LOWEST_SHARE * fitted) {
    const double outside = furthestOutside(steps, found, reaction_time);
    if (outside <= allowed || outside < WORTH_LOWERING * least_outside) {
      best = found.deceleration, least_outside = outside;
    }
    found.deceleration *= 0.97;
  }
  found.deceleration = best;
  found.outside = least_outside;
  for (const StoppingStep& step : found.joint.steps) {
    if (!step.is_alone)
      found.pushed = std::max(found.pushed, outsideOf(step, found, reaction_time));
  }
}

/// What was not measured to its end must not go much further than it says: a slow joint comes to
/// the end of few steps.
void judgeUnfinished(const JointStopping& found, double reaction_time,
                     std::vector<std::string>& warnings) {
  const StoppingStep* worst = nullptr;
  double most = std::max(found.outside, allowedWay(found.joint));
  for (const StoppingStep& step : found.joint.unfinished) {
    const double outside = outsideOf(step, found, reaction_time);
    if (outside > most) worst = &step, most = outside;
  }
  if (!worst) return;
  const std::string what = formatted(
      "joint '%s': when its command changes from %g to %g, %.2f s after the first, it goes %.2g "
      "further than its steps say that it can, and is not measured to its end: hold each velocity "
      "until the joint follows it, while joint states are recorded",
      found.joint.name.c_str(), worst->commanded_from, worst->commanded_to,
      worst->time - found.joint.first_command, most);
  const double change = worst->change();
  const double way = change * (reaction_time + 0.5 * change / found.deceleration);
  if (most > MUCH_FURTHER * way) throw InputError(what);
  warnings.push_back(what);
}

void warnOf(const JointStopping& found, std::vector<std::string>& warnings) {
  const RecordedJoint& joint = found.joint;
  const auto say = [&](bool is_so, const std::string& what) {
    if (is_so) warnings.push_back("joint '" + joint.name + "': " + what);
  };
  std::size_t nb_stops = 0;
  double least = INFINITY, most = 0.0;
  for (const StoppingStep& step : joint.steps) {
    if (std::abs(step.to) < std::abs(step.from)) ++nb_stops;
    least = std::min(least, step.change());
    most = std::max(most, step.change());
  }
  say(nb_stops < LEAST_STOPS, formatted("too few steps: it slows down %zu times, at least %zu are "
                                        "needed",
                                        nb_stops, LEAST_STOPS));
  say(most < TWO_SPEEDS * least,
      "all steps are of one size, so a lag cannot be told from a ramp: drive it at half the "
      "velocity too");
  say(found.slope_high > KNOWN_SLOPE * found.slope_low,
      formatted("its slope is between %.3g and %.3g: higher velocities, or joint states more often "
                "than every %.1f ms, would tell",
                found.slope_low, found.slope_high, 1e3 * joint.period));
  say(joint.latest > OLDEST_STATE,
      formatted("joint states arrive up to %.0f ms after their stamp: max_joint_state_age must "
                "allow for that and 20 ms",
                1e3 * joint.latest));
  say(joint.ahead > 0.0, formatted("joint states are stamped up to %.0f ms after their arrival, "
                                   "which counts instead",
                                   1e3 * joint.ahead));
  say(joint.commanded != 0.0, formatted("at a command of %.3g it moves at %.3g: clipped, or scaled",
                                        joint.commanded, joint.reached));
  say(found.overshoot > LEAST_WAY,
      formatted("it overshoots by %.2g, and the limiter assumes that it does not: add its way to "
                "stop_distance",
                found.overshoot));
  say(joint.drift > LEAST_DRIFT,
      formatted("it drifts at %.2g at zero command, and the limiter assumes that it stands",
                joint.drift));
  say(found.coupled > LEAST_WAY, formatted("it moves by %.2g at zero command when joint '%s' does",
                                           found.coupled, found.coupled_to.c_str()));
  say(found.deceleration < MUCH_LOWER * found.slope_low,
      formatted("its slope is %.3g, but its steps are covered only by a deceleration of %.3g: its "
                "velocity does not change evenly",
                found.slope, found.deceleration));
  say(found.outside > allowedWay(joint),
      formatted("it leaves what the limiter assumes by %.2g, whatever the deceleration: add that "
                "to stop_distance",
                found.outside));
  say(found.pushed > std::max(found.outside, allowedWay(joint)),
      formatted("where other joints change too, it leaves what the limiter assumes by %.2g: add "
                "that to stop_distance",
                found.pushed));
}

}  // namespace

double lagOf(double x, double ramp) {
  if (x <= 0.0) return 0.0;
  return x < ramp ? 0.5 * x * x / ramp : x - 0.5 * ramp;
}

StoppingAnalysis analyseStopping(const StoppingRecording& recording) {
  StoppingAnalysis analysis;
  for (std::size_t i = 0; i < recording.joints.size(); ++i) {
    analysis.joints.emplace_back(RecordedJoint(recording, i));
  }
  for (JointStopping& found : analysis.joints) {
    findSlope(found);
    findReactionTime(found);
    analysis.reaction_time = std::max(analysis.reaction_time, found.reaction_time);
    for (const JointStopping& other : analysis.joints) {
      if (&other == &found) continue;
      for (const StoppingStep& step : other.joint.steps) {
        const double moved = found.joint.movedBy(step);
        if (moved > found.coupled) found.coupled = moved, found.coupled_to = other.joint.name;
      }
    }
  }
  for (JointStopping& found : analysis.joints) {
    lowerDeceleration(found, analysis.reaction_time);
    judgeUnfinished(found, analysis.reaction_time, analysis.warnings);
    warnOf(found, analysis.warnings);
  }
  return analysis;
}

}  // namespace collision_pairs
