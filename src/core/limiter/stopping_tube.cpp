#include "stopping_tube.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace collision_pairs {
namespace {

// Commands are kept this much longer than needed, for joint states that are late: seconds.
constexpr double LATEST_JOINT_STATE = 1.0;
constexpr double ROUNDED_UP = 1.0 + 1e-9;
constexpr double STEP = 0.002;  // s, in which the bounds of a velocity are taken as constant
constexpr int MOST_STEPS = 20;  // of a longer time, each is longer
constexpr double INF = std::numeric_limits<double>::infinity();

double square(double x) { return x * x; }

double dot(const std::vector<double>& a, const std::vector<double>& b) {
  double sum = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += a[i] * b[i];
  return sum;
}

/// Of the direction, the multiple that comes nearest to the command; a tube is true of any.
double shareOf(const std::vector<double>& command, const std::vector<double>& direction) {
  const double share = dot(command, direction) / dot(direction, direction);
  return std::isfinite(share) ? share : 0.0;
}

/// Of a number that changes with time: the largest and smallest values of its integral from the
/// measurement on, up to any instant.
struct Integral {
  double low = 0.0, high = 0.0;
};

}  // namespace

/// The commands in effect from the measurement on, in their order, the next one last.
struct PassedCommands::Sequence {
  std::vector<const std::vector<double>*> commands;
  /// Seconds by which the latest end of each is later than that of the one before.
  std::vector<double> seconds;

  /// Of a number of each command, or zero. At t only those commands can be in effect whose latest
  /// end is not before t: as ends keep the order of commands, these are the last ones.
  template <class Value>
  Integral integral(const Value& value) const {
    Integral found;
    double lowest = 0.0, highest = 0.0;
    for (std::size_t i = commands.size(); i-- > 0;) {
      lowest = std::min(lowest, value(i));
      highest = std::max(highest, value(i));
      found.low += seconds[i] * lowest;
      found.high += seconds[i] * highest;
    }
    return found;
  }
};

PassedCommands::PassedCommands(RobotResponse response)
    : response_(std::move(response)), renewed_(-INF) {
  passed_.push_back({-INF, -INF, std::vector<double>(response_.deceleration.size(), 0.0)});
}

void PassedCommands::add(double now, const std::vector<double>& command, double begun) {
  renewed_ = begun;
  if (passed_.back().command == command) return;
  passed_.push_back({now, begun, command});
  forget(now);
}

double PassedCommands::endOf(std::size_t i, double now) const {
  const double replaced = i + 1 < passed_.size() ? passed_[i + 1].time : now;
  return replaced + response_.reaction_time;
}

// A joint may be on its way from a command for as long as it takes to the velocity of the last one.
// From then on the bounds that begin at the one after it enclose those that begin there.
void PassedCommands::forget(double now) {
  const auto hasEffect = [&](const Passed& of) {
    double way = 0.0;
    for (std::size_t i = 0; i < of.command.size(); ++i) {
      const double change = std::abs(of.command[i] - passed_[1].command[i]);
      way = std::max(way, change / response_.deceleration[i]);
    }
    return endOf(0, now) + way > now - LATEST_JOINT_STATE;
  };
  while (passed_.size() > 1 && !hasEffect(passed_.front())) passed_.pop_front();
}

// A velocity is never above all commands that may be in effect, except on its way down from one
// that was: it then falls at least at the deceleration. The same for below.
PassedCommands::Way PassedCommands::way(std::size_t joint, double from, double to, double early,
                                        bool may_stand) const {
  const double rate = response_.deceleration[joint];
  Way way;
  const int nb_steps = std::clamp(static_cast<int>(std::ceil((to - from) / STEP)), 1, MOST_STEPS);
  const double seconds = (to - from) / nb_steps;
  for (int step = 0; step < nb_steps; ++step) {
    const double begin = from + step * seconds, end = begin + seconds;
    double lowest = INF, highest = -INF;
    const auto mayBe = [&](double velocity, double in_effect_until) {
      const double change = rate * std::max(0.0, begin - in_effect_until);
      lowest = std::min(lowest, velocity + change);
      highest = std::max(highest, velocity - change);
    };
    for (std::size_t i = 0; i < passed_.size() && passed_[i].begun - early <= end; ++i) {
      mayBe(passed_[i].command[joint], endOf(i, INF));
    }
    // Whoever stands behind the limiter sends zeros then.
    if (may_stand || end > renewed_ + response_.hold - early) mayBe(0.0, INF);
    way.low += lowest * seconds;
    way.high += highest * seconds;
    way.fastest = std::max({way.fastest, std::abs(lowest), std::abs(highest)});
  }
  return way;
}

std::size_t PassedCommands::firstInEffect(double stamp, double now) const {
  std::size_t first = passed_.size() - 1;
  while (first > 0 && endOf(first - 1, now) > stamp) --first;
  return first;
}

bool PassedCommands::areAlong(const std::vector<double>& direction, double stamp) const {
  for (std::size_t i = firstInEffect(stamp, stamp); i < passed_.size(); ++i) {
    const std::vector<double>& command = passed_[i].command;
    const double share = shareOf(command, direction);
    if (share < 0.0) return false;
    for (std::size_t j = 0; j < command.size(); ++j) {
      if (std::abs(command[j] - share * direction[j]) > 1e-9) return false;
    }
  }
  return true;
}

StoppingTube PassedCommands::tube(double stamp, double now, const std::vector<double>& direction,
                                  const std::vector<double>& next,
                                  const std::vector<double>& later) const {
  const std::size_t first = firstInEffect(stamp, now), nb_joints = direction.size();
  const double end = now + response_.hold + response_.reaction_time, moving = end - stamp;
  Sequence sequence;
  double before = stamp;
  for (std::size_t i = first; i < passed_.size(); ++i) {
    sequence.commands.push_back(&passed_[i].command);
    sequence.seconds.push_back(endOf(i, now) - before);
    before = endOf(i, now);
  }
  sequence.commands.push_back(&next);
  sequence.seconds.push_back(end - before);

  std::vector<double> shares;
  for (const auto* command : sequence.commands) shares.push_back(shareOf(*command, direction));
  const Integral along = sequence.integral([&](std::size_t i) { return shares[i]; });

  StoppingTube tube;
  double braking = 0.0;
  for (std::size_t j = 0; j < nb_joints; ++j) {
    const auto commanded = [&](std::size_t i) { return (*sequence.commands[i])[j]; };
    const Integral across =
        sequence.integral([&](std::size_t i) { return commanded(i) - shares[i] * direction[j]; });

    // Velocities at the measurement: that of a command in effect, or of an earlier one from which
    // the joint is still on its way.
    const double rate = response_.deceleration[j];
    double slowest = commanded(0), fastest = commanded(0);
    for (std::size_t i = 0; i < first; ++i) {
      const double changed = rate * (stamp - endOf(i, now));
      slowest = std::min(slowest, passed_[i].command[j] + changed);
      fastest = std::max(fastest, passed_[i].command[j] - changed);
    }
    double lowest = commanded(0), highest = commanded(0), fallen = 0.0, risen = 0.0;
    for (std::size_t i = 0; i < sequence.commands.size(); ++i) {
      lowest = std::min(lowest, commanded(i));
      highest = std::max(highest, commanded(i));
      const double change =
          (i + 1 < sequence.commands.size() ? commanded(i + 1) : 0.0) - commanded(i);
      (change > 0.0 ? risen : fallen) += std::abs(change);
    }
    slowest = std::min(slowest, lowest);
    fastest = std::max(fastest, highest);
    fallen += fastest - commanded(0);
    risen += commanded(0) - slowest;

    // The integral of v - w where v > w. The difference grows only where w falls, by as much, and
    // shrinks at least at the deceleration: together at most fallen^2 / (2 deceleration), since
    // difference^2 / (2 deceleration) falls at least as fast as the integral grows. Also, it is at
    // most fastest - lowest until zeros take effect, and from then on v is at most fastest.
    // The same where v < w.
    const double ahead =
        std::min(square(fallen) / (2.0 * rate),
                 (fastest - lowest) * moving + square(std::max(fastest, 0.0)) / (2.0 * rate));
    const double behind =
        std::min(square(risen) / (2.0 * rate),
                 (highest - slowest) * moving + square(std::min(slowest, 0.0)) / (2.0 * rate));
    double low = across.low - behind, high = across.high + ahead;
    // A position that was measured later has what the joint moved until then in it.
    if (j < later.size() && later[j] > 0.0) {
      const Way until = way(j, stamp, stamp + later[j], 0.0, false);
      low -= until.high;
      high -= until.low;
    }
    const double middle = 0.5 * (low + high);
    tube.from.push_back(along.low * direction[j] + middle);
    tube.to.push_back(along.high * direction[j] + middle);
    tube.deviation.push_back(0.5 * (high - low) * ROUNDED_UP);
    braking = std::max(braking, std::max(std::abs(slowest), std::abs(fastest)) / rate);
  }
  tube.seconds = moving + braking;
  return tube;
}

}  // namespace collision_pairs
