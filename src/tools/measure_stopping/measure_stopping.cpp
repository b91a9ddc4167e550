// measure_stopping: a recording of velocity commands and joint states in, the parameters of the
// velocity limiter out. Needs no roscore.
#include <cmath>
#include <cstdio>
#include <fstream>
#include <map>
#include <set>
#include <string>
#include <vector>

#include <sensor_msgs/JointState.h>
#include <std_msgs/Float64MultiArray.h>
#include <trajectory_msgs/JointTrajectory.h>
#include <unistd.h>

#include "bag_index.h"
#include "collision_pairs/input_error.h"
#include "command_line.h"
#include "joint_state_positions.h"
#include "message_layout.h"
#include "plot_script.h"
#include "stopping_analysis.h"
#include "text_files.h"
#include "trajectory_command.h"
#include "user_text.h"

namespace collision_pairs {
namespace {

using std_msgs::Float64MultiArray;
using trajectory_msgs::JointTrajectory;

struct Options {
  std::string bag, command, joint_states, out, plot;
  std::vector<std::string> joints;
};

void declare(CommandLine& command_line, Options& options) {
  command_line.operand(options.bag, "BAG", "the recording");
  command_line.option("joints", options.joints, "NAME...",
                      "names in the order of the command (default: those of the first trajectory)");
  command_line.option(
      "command", options.command, "TOPIC",
      "of several topics of std_msgs/Float64MultiArray or "
      "trajectory_msgs/JointTrajectory in the bag, the one to which the robot moves");
  command_line.option("joint-states", options.joint_states, "TOPIC",
                      "of several topics of joint states in the bag, the one to use");
  command_line.output("out", options.out, "OUT.yaml", "output file (default: standard output)");
  command_line.output("plot", options.plot, "PICTURE.png",
                      "draw commanded and measured velocities, and what the limiter would assume");
}

template <class Message>
bool isType(const RawMessage& raw) {
  return raw.md5sum == ros::message_traits::MD5Sum<Message>::value();
}

bool isCommand(const RawMessage& raw) {
  return isType<Float64MultiArray>(raw) || isType<JointTrajectory>(raw);
}

std::string withSlash(const std::string& topic) { return '/' + withoutLeadingSlash(topic); }

/// The one that is asked for, or the only one.
std::string topicOf(const std::set<std::string>& topics, const std::string& asked,
                    const std::string& option, const std::string& what) {
  const std::vector<std::string> known(topics.begin(), topics.end());
  if (known.empty()) throw InputError("no " + what + " in it");
  for (const std::string& topic : known) {
    if (asked.empty() ? known.size() == 1 : withSlash(topic) == withSlash(asked)) return topic;
  }
  throw InputError(asked.empty() ? option + " must say which of " + joined(known) + " to use"
                                 : option + " " + asked + ": the bag has " + joined(known));
}

struct Recording {
  std::string command, joint_states;  ///< topics
  bool is_trajectory = false;
  double time_from_start = 0.0;     ///< s: the longest of trajectories
  std::vector<std::string> losses;  ///< what of the bag could not be used
  StoppingRecording content;
};

std::vector<double> velocitiesIn(const RawMessage& raw, Recording& recording) {
  std::vector<std::string>& joints = recording.content.joints;
  if (isType<JointTrajectory>(raw)) {
    const auto message = readMessage<JointTrajectory>(raw.data, raw.size);
    if (!message) throw InputError("a command is garbled");
    if (joints.empty()) joints = message->joint_names;
    recording.is_trajectory = true;
    std::vector<double> velocities = velocitiesOf(*message, joints);
    const double seconds = message->points.front().time_from_start.toSec();
    recording.time_from_start = std::max(recording.time_from_start, seconds);
    return velocities;
  }
  const auto message = readMessage<Float64MultiArray>(raw.data, raw.size);
  if (!message) throw InputError("a command is garbled");
  if (joints.empty()) throw InputError("--joints must name the joints in the order of the command");
  if (message->data.size() == joints.size()) return message->data;
  throw InputError("a command has " + std::to_string(message->data.size()) + " numbers, but " +
                   std::to_string(joints.size()) + " joints are named");
}

using States = std::map<std::string, std::vector<StoppingRecording::State>>;

void takeStates(const RawMessage& raw, double now, States& states) {
  const auto message = readMessage<sensor_msgs::JointState>(raw.data, raw.size);
  if (!message) return;  // indexBag() counts it
  for (const auto& [name, position] : finitePositionsIn(*message)) {
    states[name].push_back({message->header.stamp.toSec(), now, position});
  }
}

Recording readTopics(const Options& options, const BagIndex& index, const RawMessageFilter& wants,
                     const std::set<std::string>& commands,
                     const std::set<std::string>& all_states) {
  std::int64_t start = 0;
  Recording recording;
  recording.command = topicOf(commands, options.command, "--command", "velocity commands");
  recording.joint_states =
      topicOf(all_states, options.joint_states, "--joint-states", "joint states");
  recording.content.joints = options.joints;
  States states;
  replayBag(options.bag, index, wants, [&](const RawMessage& raw) {
    if (start == 0) start = raw.received;
    const double now = inSeconds(raw.received);
    if (raw.topic == recording.joint_states) takeStates(raw, now, states);
    if (raw.topic != recording.command) return;
    std::vector<double> velocities =
        naming(recording.command + " at +" + inWords(now - inSeconds(start)),
               [&] { return velocitiesIn(raw, recording); });
    for (const double velocity : velocities) {
      if (!std::isfinite(velocity))
        throw InputError(recording.command + ": a command is not finite");
    }
    recording.content.commands.push_back({now, std::move(velocities)});
  });
  std::vector<std::string> known;
  for (const auto& joint : states) known.push_back(joint.first);
  for (const std::string& name : recording.content.joints) {
    if (states.count(name) == 0) {
      throw InputError(recording.joint_states + " has no joint '" + name + "'" +
                       didYouMean(name, known));
    }
    recording.content.states.push_back(states[name]);
  }
  return recording;
}

Recording read(const Options& options) {
  std::set<std::string> commands, all_states;
  const RawMessageFilter wants = [&](const RawMessage& raw) {
    if (isCommand(raw)) commands.insert(raw.topic);
    if (isType<sensor_msgs::JointState>(raw)) all_states.insert(raw.topic);
    return isCommand(raw) || isType<sensor_msgs::JointState>(raw);
  };
  const BagIndex index = indexBag(options.bag, wants);
  for (const BagLoss& loss : index.records.losses) warn(options.bag + ": " + loss.what);
  Recording recording =
      naming(options.bag, [&] { return readTopics(options, index, wants, commands, all_states); });
  for (const BagLoss& loss : index.records.losses) recording.losses.push_back(loss.what);
  return recording;
}

/// A text in double quotes, as YAML has it.
std::string inYaml(const std::string& text) {
  std::string quoted = "\"";
  for (const char letter : text) {
    const auto byte = static_cast<unsigned char>(letter);
    if (letter == '"' || letter == '\\') quoted += '\\';
    quoted += byte < 0x20 || byte == 0x7f ? formatted("\\x%02x", byte) : std::string(1, letter);
  }
  return quoted + '"';
}

/// Three digits, on the side of a slower robot.
std::string lessThan(double number) {
  const double digit = std::pow(10.0, std::floor(std::log10(number)) - 2.0);
  return formatted("%.6g", digit * std::floor(number / digit));
}

void writeYaml(const Recording& recording, const StoppingAnalysis& found, std::ostream& out) {
  out << "# Written by measure_stopping; docs/limiter.md says what the numbers mean.\n";
  for (const auto* warnings : {&recording.losses, &found.warnings}) {
    for (const std::string& text : *warnings) out << "# warning: " << inYaml(text) << '\n';
  }
  out << "velocity_limiter:\n"
      << "  # As recorded. The limiter must hear what is to be limited, not what the controller "
         "hears.\n"
      << "  command: " << inYaml(recording.command) << '\n'
      << "  command_type: "
      << (recording.is_trajectory ? "trajectory_msgs/JointTrajectory"
                                  : "std_msgs/Float64MultiArray")
      << "\n  joints:\n";
  for (const std::string& name : recording.content.joints) out << "  - " << inYaml(name) << '\n';
  out << "  joint_states: " << inYaml(recording.joint_states) << '\n'
      << "  # The longest of the joints, with a margin of 5 % and 5 ms.\n"
      << formatted("  reaction_time: %.3f\n", std::ceil(1e3 * found.reaction_time) / 1e3)
      << "  # The least slope within two standard errors, less 5 %, or what covers every step.\n"
      << "  deceleration:\n";
  for (const JointStopping& joint : found.joints) {
    const RecordedJoint& recorded = joint.joint;
    out << formatted("    # %zu steps, %zu other changes, joint states every %.1f ms, noise %.2g\n",
                     recorded.steps.size(), recorded.nb_other, 1e3 * recorded.period,
                     recorded.noise)
        << formatted(
               "    # dead time up to %.0f ms; slope %.3g (%.3g to %.3g); settled after %.2f s\n",
               1e3 * joint.dead_time, joint.slope, joint.slope_low, joint.slope_high, joint.settled)
        << formatted("    # overshoot %.2g, drift %.2g/s, moved by others %.2g, not covered %.2g\n",
                     joint.overshoot, recorded.drift, joint.coupled, joint.outside)
        << "    " << inYaml(recorded.name) << ": " << lessThan(joint.deceleration) << '\n';
  }
}

/// One row for each joint state around a step: what plot_stopping draws.
void writeSteps(const StoppingAnalysis& found, const std::string& path) {
  std::ofstream out(path, std::ios::binary);
  out << "joint,step,time,since,position,commanded_from,commanded_to,from,to,reaction_time,"
         "deceleration\n";
  for (std::size_t j = 0; j < found.joints.size(); ++j) {
    const JointStopping& joint = found.joints[j];
    for (std::size_t s = 0; s < joint.joint.steps.size(); ++s) {
      const StoppingStep& step = joint.joint.steps[s];
      for (std::size_t i = 0; i < step.t.size(); ++i) {
        out << formatted("%zu,%zu,%.6f,%.6f,%.9g,%.9g,%.9g,%.9g,%.9g,%.6f,%.9g\n", j, s, step.time,
                         step.t[i], step.q[i], step.commanded_from, step.commanded_to, step.from,
                         step.to, found.reaction_time, joint.deceleration);
      }
    }
  }
  out.close();
  if (!out) throw InputError(path + ": writing failed (disk full?)");
}

void draw(const StoppingAnalysis& found, const std::string& picture) {
  const std::string table = picture + ".steps" + std::to_string(::getpid()) + ".csv";
  struct Removed {
    const std::string& path;
    ~Removed() { std::remove(path.c_str()); }
  } removed{table};
  writeSteps(found, table);
  std::vector<std::string> arguments{table, "--out", picture, "--joints"};
  for (const JointStopping& joint : found.joints) arguments.push_back(joint.joint.name);
  if (!runPlotScript("plot_stopping", arguments)) {
    throw InputError(picture + ": could not be drawn; see the line above");
  }
}

void measure(const Options& options) {
  const Recording recording = read(options);
  StoppingAnalysis found = naming(options.bag, [&] { return analyseStopping(recording.content); });
  // The limiter refuses a command that would be in effect later.
  found.reaction_time = std::max(found.reaction_time, recording.time_from_start);
  for (const std::string& warning : found.warnings) warn(warning);
  writeTextFile(options.out, [&](std::ostream& out) {
    if (!options.plot.empty()) draw(found, options.plot);
    writeYaml(recording, found, out);
  });
}

}  // namespace
}  // namespace collision_pairs

int main(int argc, char** argv) {
  using namespace collision_pairs;
  return runTool(
      argc, argv,
      {"measure_stopping",
       "Measures how a robot follows velocity commands: reaction_time and deceleration of "
       "the velocity limiter."},
      declare, measure);
}
