#include "limited_command.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "collision_pairs/input_error.h"
#include "joint_state_positions.h"
#include "stamps.h"
#include "trajectory_command.h"
#include "user_text.h"

namespace collision_pairs {
namespace {

constexpr std::size_t MOST_NAMES = 10000;  // of joints: names are external input

// Splines and joysticks leave something of a zero.
bool isWanted(double velocity) { return !(std::abs(velocity) <= 1e-6); }

// On the way to `given`, and no further than the velocity that passes, which alone is certified,
// leads in `seconds`.
double limitedPosition(double from, double given, double scale, double velocity, double seconds) {
  const double reach = velocity * std::max(0.0, seconds);
  return from + std::clamp(scale * (given - from), std::min(0.0, reach), std::max(0.0, reach));
}

// Of a command that is refused it is all the same how many: the zeros have the measured ones.
bool asksForPositions(const trajectory_msgs::JointTrajectory& command, bool is_accepted) {
  return std::any_of(command.points.begin(), command.points.end(), [&](const auto& point) {
    const std::size_t nb_positions = point.positions.size();
    return is_accepted ? nb_positions == command.joint_names.size() : nb_positions > 0;
  });
}

}  // namespace

void JointPositions::take(const sensor_msgs::JointState& message, double now, double tolerance) {
  const double stamp = message.header.stamp.toSec();
  if (differInNumber(message)) {
    for (const std::string& given : message.name) {
      const std::string name = withoutLeadingSlash(given);
      if (isRoomFor(name)) uneven_[name] = now;
    }
    return;
  }
  for (const auto& [name, value] : positionsIn(message)) {
    if (!isRoomFor(name)) continue;
    if (stamp > now + tolerance) {
      refused_[name] = {stamp - now, now};
      continue;
    }
    Position& position = newest_[name];
    if (stamp < position.stamp) continue;
    position = {stamp, measuredAt(stamp, now), value};
  }
}

void JointPositions::clear() {
  newest_.clear();
  refused_.clear();
  uneven_.clear();
}

bool JointPositions::isRoomFor(const std::string& name) const {
  return newest_.count(name) + refused_.count(name) + uneven_.count(name) > 0 ||
         newest_.size() + refused_.size() + uneven_.size() < MOST_NAMES;
}

double JointPositions::oldestOf(const std::vector<std::string>& joints, double now,
                                double tolerance) const {
  double oldest = std::numeric_limits<double>::infinity();
  for (const std::string& name : joints) {
    const auto refused = refused_.find(name);
    if (refused != refused_.end() && now - refused->second.when <= tolerance) {
      throw InputError("the position of joint '" + name + "' is stamped " +
                       inWords(refused->second.ahead) +
                       " ahead of the clock: is /clock late, or the clock of a computer ahead?");
    }
    const auto found = newest_.find(name);
    const auto uneven = uneven_.find(name);
    const bool is_old = found == newest_.end() || now - found->second.measured > tolerance;
    if (is_old && uneven != uneven_.end() && now - uneven->second <= tolerance) {
      throw InputError("no position of joint '" + name +
                       "': names and positions of its joint state differ in number");
    }
    if (found == newest_.end()) throw InputError("nobody reports joint '" + name + "'");
    if (!std::isfinite(found->second.value)) {
      throw InputError("the position of joint '" + name + "' is not finite");
    }
    oldest = std::min(oldest, found->second.measured);
  }
  return oldest;
}

bool JointPositions::areYoung(const std::vector<std::string>& joints, double now,
                              double most) const {
  try {
    return std::abs(now - oldestOf(joints, now, most)) <= most;  // after now: the clock went back
  } catch (const InputError&) {
    return false;
  }
}

double JointPositions::newestStampOf(const std::vector<std::string>& joints) const {
  double newest = -std::numeric_limits<double>::infinity();
  for (const std::string& name : joints) {
    const auto found = newest_.find(name);
    if (found != newest_.end()) newest = std::max(newest, found->second.stamp);
  }
  return newest;
}

bool asksToMove(const std_msgs::Float64MultiArray& command) {
  return std::any_of(command.data.begin(), command.data.end(), isWanted);
}

bool asksToMove(const trajectory_msgs::JointTrajectory& command) {
  return std::any_of(command.points.begin(), command.points.end(), [](const auto& point) {
    return std::any_of(point.velocities.begin(), point.velocities.end(), isWanted);
  });
}

void refuseLoop(const std::string& read, const std::string& passed_on) {
  if (read != passed_on) return;
  throw InputError("commands are read from " + read +
                   " and passed on there, so what is passed would be heard again; who commands, "
                   "the limiter and the controller need a topic each");
}

trajectory_msgs::JointTrajectory limitedTrajectory(const trajectory_msgs::JointTrajectory& command,
                                                   const LimiterParameters& parameters,
                                                   const LimiterDecision& decision,
                                                   const JointPositions& measured, double now) {
  const std::vector<std::string>& joints = parameters.joints;
  trajectory_msgs::JointTrajectory limited;
  limited.header.frame_id = command.header.frame_id;
  const bool is_accepted = isAccepted(command, joints, parameters.law.reaction_time);
  limited.joint_names = is_accepted ? command.joint_names : joints;
  limited.points.resize(1);
  auto& point = limited.points.front();
  point.time_from_start = ros::Duration(SHORTEST_TIME_FROM_START);
  if (is_accepted) {
    point.time_from_start = std::max(point.time_from_start, command.points.front().time_from_start);
  }
  const bool has_positions =
      asksForPositions(command, is_accepted) &&
      measured.areYoung(limited.joint_names, now, parameters.law.max_joint_state_age);
  for (std::size_t i = 0; i < limited.joint_names.size(); ++i) {
    const auto joint = std::find(joints.begin(), joints.end(), limited.joint_names[i]);
    const auto at = static_cast<std::size_t>(joint - joints.begin());
    const double velocity = is_accepted && at < joints.size() ? decision.command[at] : 0.0;
    point.velocities.push_back(velocity);
    if (!has_positions) continue;
    const double from = measured.all().at(limited.joint_names[i]).value;
    // A joint that is given no velocity is certified where it is, and not where it should go.
    const bool moves = decision.scale > 0.0 && velocity != 0.0;
    point.positions.push_back(moves ? limitedPosition(from, command.points.front().positions[i],
                                                      decision.scale, velocity,
                                                      point.time_from_start.toSec())
                                    : from);
  }
  const auto isKnown = [](double position) { return std::isfinite(position); };
  if (!std::all_of(point.positions.begin(), point.positions.end(), isKnown)) {
    point.positions.clear();
  }
  return limited;
}

}  // namespace collision_pairs
