#include "limiter_parameters.h"

#include <algorithm>
#include <map>

#include "collision_pairs/input_error.h"
#include "trajectory_command.h"
#include "user_text.h"
#include "yaml_values.h"

namespace collision_pairs {
namespace {

const std::string KEY = "velocity_limiter";
// PassedCommands keeps commands for as long.
constexpr double OLDEST_JOINT_STATE = 1.0;

struct Number {
  double LimiterSettings::*number;
  Range range;
};

const std::map<std::string, Number> NUMBERS = {
    {"reaction_time", {&LimiterSettings::reaction_time, {0.0, 10.0}}},
    {"command_timeout", {&LimiterSettings::command_timeout, {0.0, 10.0, true}}},
    {"max_joint_state_age",
     {&LimiterSettings::max_joint_state_age, {0.0, OLDEST_JOINT_STATE, true}}},
    {"stop_distance", {&LimiterSettings::stop_distance, {0.0, 10.0}}},
    {"self_stop_distance", {&LimiterSettings::self_stop_distance, {0.0, 10.0}}},
    {"obstacle_speed", {&LimiterSettings::obstacle_speed, {0.0, 100.0}}},
    {"retreat_scale", {&LimiterSettings::retreat_scale, {0.0, 1.0}}},
    {"ramp_up", {&LimiterSettings::ramp_up, {0.0, 1e6, true}}},
    {"tracking_tolerance", {&LimiterSettings::tracking_tolerance, {0.0, 10.0, true}}},
};

double within(const std::string& key, const YAML::Node& value, const Range& range) {
  return numberOf(key, value,
                  "a number from " + std::to_string(range.least) +
                      (range.is_above ? " (excluded)" : "") + " to " + std::to_string(range.most),
                  range);
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
  const Range range{0.0, 1e6, true};
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
  if (value.IsMap() && value.size() == 0) return std::nullopt;
  LimiterParameters parameters;
  YAML::Node deceleration;
  const auto topicTo = [](std::string& topic) {
    return [&](auto& key, auto& entry) { topic = textOf(key, entry, "the name of a topic"); };
  };
  std::map<std::string, ValueReader> readers = {
      {"command", topicTo(parameters.command)},
      {"joint_states", topicTo(parameters.joint_states)},
      {"command_type", [&](auto& k, auto& v) { parameters.is_trajectory = isTrajectory(k, v); }},
      {"joints",
       [&](auto& k, auto& v) {
         parameters.joints = namesOf(k, v);
         for (std::string& joint : parameters.joints) joint = withoutLeadingSlash(joint);
       }},
      {"deceleration", [&](auto&, auto& v) { deceleration = v; }}};
  for (const auto& [name, number] : NUMBERS) {
    readers[name] = [&parameters, &number = number](auto& k, auto& v) {
      parameters.law.*number.number = within(k, v, number.range);
    };
  }
  readFields(KEY, value, "a map such as {command: servo/command, joints: [a, b], deceleration: 5}",
             "a setting of the limiter", readers);
  if (parameters.command.empty()) throw InputError(KEY + " has no command: the topic to limit");
  if (parameters.joints.empty()) throw InputError(KEY + " has no joints: those of the command");
  if (deceleration.IsNull()) throw InputError(KEY + " has no deceleration");
  readDeceleration(deceleration, parameters);
  if (parameters.is_trajectory && parameters.law.reaction_time < SHORTEST_TIME_FROM_START) {
    throw InputError(
        formatted("%s/reaction_time is %g s, but each point of a trajectory takes %g s at least",
                  KEY.c_str(), parameters.law.reaction_time, SHORTEST_TIME_FROM_START));
  }
  return parameters;
}

}  // namespace collision_pairs
