#include "simulated_limiter.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "collision_pairs/input_error.h"

namespace simulation {

using namespace collision_pairs;

namespace {

constexpr double MAX_AGE = 0.3, COMMAND_TIMEOUT = 0.2, LATER = 0.02;  // s
constexpr double SET_BACK = 0.02;  // s: more is a clock that was set

LimiterInputs::Settings settingsOf(const Scenario& setup, const std::vector<int>& joints) {
  LimiterInputs::Settings settings{
      {}, MAX_AGE, COMMAND_TIMEOUT, setup.is_simulated, setup.allow_paused};
  for (const int link : joints) settings.joints.push_back(jointName(link));
  return settings;
}

std::vector<int> measuredJoints(const Scenario& setup) {
  std::vector<int> links;
  for (int i = 0; i < static_cast<int>(setup.links.size()); ++i) {
    if (SimulatedLimiter::isMeasured(setup.links[static_cast<std::size_t>(i)])) links.push_back(i);
  }
  return links;
}

std::vector<int> everySecond(const std::vector<int>& all) {
  std::vector<int> some;
  for (std::size_t i = 0; i < all.size(); i += 2) some.push_back(all[i]);
  return some;
}

}  // namespace

SimulatedLimiter::SimulatedLimiter(const Scenario& setup, const Knowledge& knowledge)
    : setup_(setup),
      knowledge_(knowledge),
      measured_(measuredJoints(setup)),
      joints_(everySecond(measured_)),
      inputs_(settingsOf(setup, joints_)) {}

double SimulatedLimiter::latest() const {
  double latest = clock_;
  for (const int link : joints_) {
    const auto found = newest_.find(link);
    if (!setup_.is_simulated || found == newest_.end()) continue;
    latest = std::max(latest, seconds(found->second.stamp));
  }
  return latest;
}

double SimulatedLimiter::upper() const {
  double most = 0.0;
  for (const auto& [when, lag] : lags_) {
    if (clocks_.steady - when <= 1.0) most = std::max(most, lag);
  }
  return latest() + most;
}

/// Commands have an effect for as long as the robot takes, and zeros follow after a while, whatever
/// happens to the clock: the law's time is that of the wall, or goes on with a simulated clock.
void SimulatedLimiter::judgeTime(const CommandOutlet::Time& time, double gone) {
  const bool is_first = !is_clock_known_;
  if (!is_first && std::abs(time.law - law_ - gone) > ROUNDING) {
    wrong_time_ = "the law's time goes on by another span than what has passed";
  }
  if (!is_first && time.latest < latest_law_) wrong_time_ = "the law's latest time goes back";
  law_ = time.law;
  latest_law_ = time.latest;
}

void SimulatedLimiter::advance(Ns ros, double steady, unsigned nb_jumps) {
  const double now = seconds(ros), steady_before = clocks_.steady;
  if (now < clock_ - SET_BACK || nb_jumps != clocks_.nb_jumps) {
    newest_.clear();
    refused_.clear();
    lags_.clear();
    clock_ = now;
  }
  if (setup_.is_simulated && is_clock_known_ && now > latest() && now - latest() < 0.5) {
    lags_.emplace_back(steady, now - latest());
  }
  const double gone = setup_.is_simulated ? std::max(0.0, now - clock_) : steady - steady_before;
  clock_ = std::max(clock_, now);
  clocks_ = {now, steady, nb_jumps};
  judgeTime(inputs_.follow(clocks_), gone);
  is_clock_known_ = true;
  if (latest() != last_latest_) last_step_ = steady;
  last_latest_ = latest();
}

void SimulatedLimiter::hear(const Event& event) {
  const Ns stamp = static_cast<Ns>(std::llround(1e9 * (clocks_.ros - event.lag)));
  if (stamp <= 0) return;
  sensor_msgs::JointState message;
  message.header.stamp.fromNSec(static_cast<std::uint64_t>(stamp));
  for (const int link : measured_) {
    if (event.what == 6 && link != event.who) continue;
    const bool slides =
        setup_.links[static_cast<std::size_t>(link)].joint == SimulatedLink::SLIDING;
    double value = slides ? event.at.x * std::pow(2.0, link) : event.at.yaw;
    if (event.what == 7) value = std::numeric_limits<double>::quiet_NaN();
    message.name.push_back(jointName(link));
    message.position.push_back(value);
    if (seconds(stamp) > clock_ + MAX_AGE) {
      refused_[link] = clock_;
    } else if (newest_.count(link) == 0 || stamp >= newest_[link].stamp) {
      newest_[link] = {stamp, std::min(seconds(stamp), clock_), value};
    }
  }
  inputs_.take(message, clocks_);
  if (latest() != last_latest_) last_step_ = clocks_.steady;
  last_latest_ = latest();
}

/// By the rules of docs/limiter.md.
std::string SimulatedLimiter::whySuspect() const {
  if (knowledge_.isClockSuspect()) return "the clock stands still";
  const bool stands = clocks_.steady - last_step_ > COMMAND_TIMEOUT;
  if (setup_.is_simulated && !setup_.allow_paused && stands) return "nothing later was heard";
  for (const int link : joints_) {
    const auto refused = refused_.find(link);
    if (refused != refused_.end() && clock_ - refused->second <= MAX_AGE) return "a clock is ahead";
    const auto found = newest_.find(link);
    if (found == newest_.end()) return "a joint was not reported";
    if (!std::isfinite(found->second.value)) return "a position is not finite";
  }
  return "";
}

/// By the positions alone; nothing if a joint that is not limited is on the way.
std::optional<Pose> SimulatedLimiter::poseOf(int link) const {
  if (setup_.fixed_frame >= 0) return std::nullopt;  // of W no pose is measured
  Pose X_WB;
  for (; link >= 0; link = setup_.links[static_cast<std::size_t>(link)].parent) {
    const SimulatedLink& of = setup_.links[static_cast<std::size_t>(link)];
    const bool is_unknown =
        isMeasured(of) && std::find(joints_.begin(), joints_.end(), link) == joints_.end();
    if (of.joint == SimulatedLink::FLOATING || is_unknown) return std::nullopt;
    Pose motion;
    if (of.joint == SimulatedLink::SLIDING) motion.x = newest_.at(link).value;
    if (of.joint == SimulatedLink::TURNING) motion.yaw = newest_.at(link).value;
    X_WB = of.X_PJ * (motion * X_WB);
  }
  return X_WB;
}

std::string SimulatedLimiter::violation(const Monitor& monitor) {
  const LimiterInputs::Moment moment = inputs_.at(clocks_, LATER);
  if (!wrong_time_.empty()) return wrong_time_;
  LimiterInput input;
  RobotState state;
  problem_ = whySuspect();
  try {
    const Snapshot snapshot = snapshotAt(moment, monitor, input, state);
    const auto& reasons = snapshot.poses.unknown_because;
    if (!problem_.empty()) return reasons.empty() ? "the limiter does not know: " + problem_ : "";
    double oldest = upper() + LATER;
    for (const int link : joints_) oldest = std::min(oldest, newest_.at(link).measured);
    const double age = upper() + LATER - oldest;
    if (reasons.empty() && std::abs(input.now - input.stamp - age) > ROUNDING) {
      return "the limiter takes the positions for younger or older than they are";
    }
    if (age > MAX_AGE) {
      problem_ = "positions are too old";  // by input.stamp, the law stops
      return "";
    }
    if (!reasons.empty()) {
      problem_ = reasons.front();
      return "";
    }
    for (const auto& [name, value, told_age] : moment.positions) {
      const int link = std::stoi(name.substr(1));
      const Reported& reported = newest_.at(link);
      const bool is_limited = std::find(joints_.begin(), joints_.end(), link) != joints_.end();
      const double since = upper() + LATER - reported.measured;
      if (is_limited && since > MAX_AGE + ROUNDING) {
        return "the limiter uses an old position of " + name;
      }
      if (std::abs(told_age - since) > ROUNDING) return "the age of " + name + " is another";
      if (value != reported.value && std::isfinite(reported.value)) {
        return "the limiter decides on another position of " + name;
      }
    }
    const RobotModel& robot = snapshot.scene->scene->robot();
    std::vector<Eigen::Isometry3d> X_WB;
    std::vector<double> values;
    for (const auto& measured : moment.positions) values.push_back(measured.value);
    snapshot.joints->bodyPosesAt(values, X_WB);
    for (const int link : joints_) {
      const int joint = robot.findJoint(jointName(link));
      if (state.positions[static_cast<std::size_t>(joint)] != newest_.at(link).value) {
        return "the limiter loses the position of " + jointName(link);
      }
      const auto expected = poseOf(link);
      const int body = robot.links()[static_cast<std::size_t>(robot.findLink(linkName(link)))].body;
      if (!expected || body < 0) continue;
      const Eigen::Vector3d p = X_WB[static_cast<std::size_t>(body)].translation();
      const auto q = setup_.inSpace(*expected);
      if ((p - Eigen::Vector3d(q[0], q[1], q[2])).norm() > 1e-6) {
        return "the limiter has " + linkName(link) + " elsewhere";
      }
    }
    if (input.obstacles_age < 0.0) return "a cloud of the future";
  } catch (const InputError& error) {
    problem_ = error.what();
  }
  return "";
}

}  // namespace simulation
