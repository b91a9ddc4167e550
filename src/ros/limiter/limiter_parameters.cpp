#include "limiter_parameters.h"

#include <algorithm>
#include <map>

#include "collision_pairs/input_error.h"
#include "user_text.h"
#include "yaml_values.h"

namespace collision_pairs {
namespace {

const std::string KEY = "velocity_limiter";
// PassedCommands keeps commands for as long.
constexpr double OLDEST_JOINT_STATE = 1.0;

struct Range {
  double LimiterSettings::*number;
  double lowest, highest;
  bool above_lowest;
};

const std::map<std::string, Range> NUMBERS = {
    {"reaction_time", {&LimiterSettings::reaction_time, 0.0, 10.0, false}},
    {"command_timeout", {&LimiterSettings::command_timeout, 0.0, 10.0, true}},
    {"max_joint_state_age", {&LimiterSettings::max_joint_state_age, 0.0, OLDEST_JOINT_STATE, true}},
    {"stop_distance", {&LimiterSettings::stop_distance, 0.0, 10.0, false}},
    {"self_stop_distance", {&LimiterSettings::self_stop_distance, 0.0, 10.0, false}},
    {"obstacle_speed", {&LimiterSettings::obstacle_speed, 0.0, 100.0, false}},
    {"retreat_scale", {&LimiterSettings::retreat_scale, 0.0, 1.0, false}},
    {"ramp_up", {&LimiterSettings::ramp_up, 0.0, 1e6, true}},
    {"tracking_tolerance", {&LimiterSettings::tracking_tolerance, 0.0, 10.0, true}},
};
const std::vector<std::string> WORDS = {"command", "command_type", "joints", "joint_states",
                                        "deceleration"};

double within(const std::string& key, const YAML::Node& value, const Range& range) {
  const std::string rule = "a number from " + std::to_string(range.lowest) +
                           (range.above_lowest ? " (excluded)" : "") + " to " +
                           std::to_string(range.highest);
  const double found = numberOf(key, value, rule);
  const bool is_low = range.above_lowest ? found <= range.lowest : found < range.lowest;
  if (is_low || found > range.highest) refuseValue(key, value, rule);
  return found;
}

bool isTrajectory(const std::string& key, const YAML::Node& value) {
  const std::string rule = "std_msgs/Float64MultiArray or trajectory_msgs/JointTrajectory";
  const std::string type = textOf(key, value, rule);
  if (type == "trajectory_msgs/JointTrajectory") return true;
  if (type != "std_msgs/Float64MultiArray") refuseValue(key, value, rule);
  return false;
}

/// One number for all joints, or a map with one for each.
void readDeceleration(const YAML::Node& value, LimiterParameters& parameters) {
  const Range range{nullptr, 0.0, 1e6, true};
  const std::string key = KEY + "/deceleration";
  if (!value.IsMap()) {
    parameters.law.deceleration.assign(parameters.joints.size(), within(key, value, range));
    return;
  }
  std::map<std::string, double> numbers;
  for (const auto& entry : value) {
    const std::string name = withoutLeadingSlash(entry.first.Scalar());
    if (std::count(parameters.joints.begin(), parameters.joints.end(), name) != 1) {
      throw InputError(key + ": '" + name + "' is not in joints" +
                       didYouMean(name, parameters.joints));
    }
    const double number = within(key + '/' + name, entry.second, range);
    if (numbers.emplace(name, number).second) continue;
    throw InputError(key + " has two numbers for joint '" + name + "'");
  }
  for (const std::string& joint : parameters.joints) {
    const auto found = numbers.find(joint);
    if (found == numbers.end()) throw InputError(key + " has no number for joint '" + joint + "'");
    parameters.law.deceleration.push_back(found->second);
  }
}

}  // namespace

std::optional<LimiterParameters> LimiterParameters::read(const YAML::Node& value) {
  if (!value || value.IsNull()) return std::nullopt;
  const std::string rule =
      "a map such as {command: servo/command, joints: [a, b], deceleration: 5}";
  if (value.IsMap() && value.size() == 0) return std::nullopt;
  LimiterParameters parameters;
  YAML::Node deceleration;
  forEntries(KEY, value, rule, [&](const std::string& name, const YAML::Node& entry) {
    const std::string key = KEY + '/' + name;
    const auto number = NUMBERS.find(name);
    if (number != NUMBERS.end()) {
      parameters.law.*number->second.number = within(key, entry, number->second);
    } else if (name == "command") {
      parameters.command = textOf(key, entry, "the name of a topic");
    } else if (name == "joint_states") {
      parameters.joint_states = textOf(key, entry, "the name of a topic");
    } else if (name == "command_type") {
      parameters.is_trajectory = isTrajectory(key, entry);
    } else if (name == "joints") {
      parameters.joints = namesOf(key, entry);
      for (std::string& joint : parameters.joints) joint = withoutLeadingSlash(joint);
    } else if (name == "deceleration") {
      deceleration = entry;
    } else {
      std::vector<std::string> known = WORDS;
      for (const auto& other : NUMBERS) known.push_back(other.first);
      throw InputError(KEY + ": '" + name + "' is not a setting of the limiter" +
                       didYouMean(name, known));
    }
  });
  if (parameters.command.empty()) throw InputError(KEY + " has no command: the topic to limit");
  if (parameters.joints.empty()) throw InputError(KEY + " has no joints: those of the command");
  if (deceleration.IsNull()) throw InputError(KEY + " has no deceleration");
  readDeceleration(deceleration, parameters);
  return parameters;
}

}  // namespace collision_pairs
