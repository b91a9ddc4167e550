// A process beside the controller that stops the robot when the limiter does not.
//
// Passes ~limited_command on to ~command, and sends zeros itself when none comes for
// command_timeout, in wall time or in simulated time, whichever is over first, and before it ends
// when it is asked to. It does nothing else, so a machine that is loaded, and a limiter that hangs
// or has died, do not keep it from that. Its settings are those of the limiter: the parameter
// ~velocity_limiter.
#include <algorithm>
#include <atomic>
#include <cmath>
#include <csignal>
#include <string>
#include <type_traits>
#include <vector>

#include <ros/callback_queue.h>
#include <ros/ros.h>
#include <ros/xmlrpc_manager.h>
#include <std_msgs/Float64MultiArray.h>

#include "collision_pairs/input_error.h"
#include "limited_command.h"
#include "limiter_parameters.h"
#include "parameters.h"
#include "ros_master.h"
#include "thread_priority.h"
#include "trajectory_command.h"

namespace collision_pairs {
namespace {

constexpr int PRIORITY = 43;              // above the limiter's, below that of interrupts
constexpr double LONGEST_WAIT = 0.1;      // s, so that it ends soon
constexpr double SIMULATED_WAIT = 0.001;  // s: a simulated clock may be faster
constexpr double TO_BE_SENT = 0.1;        // s, the last zeros: roscpp sends on a thread of its own

std::atomic<bool> is_asked_to_end{false};

void endOnSignal(int) { is_asked_to_end = true; }

void endOnRequest(XmlRpc::XmlRpcValue&, XmlRpc::XmlRpcValue& result) {
  is_asked_to_end = true;
  result = ros::xmlrpc::responseInt(1, "", 0);
}

/// By Ctrl-C, roslaunch or `rosnode kill`. roscpp itself would close the publisher at once, before
/// zeros could be sent. The node has been started, and roscpp has no handler of SIGINT.
void noteWhenAskedToEnd() {
  for (const int number : {SIGINT, SIGTERM}) std::signal(number, endOnSignal);
  const ros::XMLRPCManagerPtr& requests = ros::XMLRPCManager::instance();
  requests->unbind("shutdown");
  requests->bind("shutdown", endOnRequest);
}

template <class Command>
class Guard {
  static constexpr bool IS_ARRAY = std::is_same_v<Command, std_msgs::Float64MultiArray>;

 public:
  Guard(const ros::NodeHandle& node, const ros::NodeHandle& private_node,
        const LimiterParameters& parameters)
      : parameters_(parameters), came_(ros::SteadyTime::now()), came_at_(ros::Time::now()) {
    if constexpr (!IS_ARRAY) last_.joint_names = parameters.joints;
    ros::NodeHandle own(node), own_private(private_node);
    const auto hints = ros::TransportHints().tcpNoDelay();
    // To a controller that connects, or connects again, after the zeros nobody else sends them.
    const auto greet = [this](const ros::SingleSubscriberPublisher& connected) {
      if (!lacks_zeros_) connected.publish(zerosAs(last_));
    };
    publisher_ = own_private.advertise<Command>("command", 1, greet);
    refuseLoop(own.resolveName(parameters.command), publisher_.getTopic());
    commands_ = own_private.subscribe("limited_command", 1, &Guard::pass, this, hints);
    refuseLoop(commands_.getTopic(), publisher_.getTopic());
    if (parameters_.is_trajectory) {
      states_ = own.subscribe(parameters_.joint_states, 10, &Guard::take, this, hints);
    }
  }

  void run() {
    while (ros::ok() && !is_asked_to_end) {
      double wait = LONGEST_WAIT;
      if (lacks_zeros_) {
        wait = std::clamp(parameters_.law.command_timeout - silentFor(), 0.0, wait);
        if (ros::Time::isSimTime()) wait = std::min(wait, SIMULATED_WAIT);
      }
      ros::getGlobalCallbackQueue()->callAvailable(ros::WallDuration(wait));
      if (lacks_zeros_ && silentFor() >= parameters_.law.command_timeout) stop();
    }
    if (!lacks_zeros_) return;
    stop();
    ros::WallDuration(TO_BE_SENT).sleep();
  }

 private:
  void pass(const Command& command) {
    publisher_.publish(command);
    if (isOfAllJoints(command)) last_ = command;
    lacks_zeros_ = true;
    came_ = ros::SteadyTime::now();
    came_at_ = ros::Time::now();
  }
  void stop() {
    publisher_.publish(zerosAs(last_));
    lacks_zeros_ = false;
  }
  void take(const sensor_msgs::JointState& message) {
    const double now = ros::Time::now().toSec();
    if (now < taken_at_) positions_.clear();  // of another time
    taken_at_ = now;
    positions_.take(message, now, parameters_.law.max_joint_state_age);
  }

  double silentFor() const {
    return std::max((ros::SteadyTime::now() - came_).toSec(),
                    ros::Time::now().toSec() - came_at_.toSec());
  }

  bool isOfAllJoints(const std_msgs::Float64MultiArray& command) const {
    return command.data.size() == parameters_.joints.size();
  }
  bool isOfAllJoints(const trajectory_msgs::JointTrajectory& command) const {
    return isAccepted(command, parameters_.joints, parameters_.law.reaction_time);
  }

  Command zerosAs(const Command& command) const {
    LimiterDecision zeros;
    zeros.command.assign(parameters_.joints.size(), 0.0);
    if constexpr (IS_ARRAY) {
      Command sent = command;
      sent.data = zeros.command;
      return sent;
    } else {
      return limitedTrajectory(command, parameters_, zeros, positions_, ros::Time::now().toSec());
    }
  }

  const LimiterParameters parameters_;
  JointPositions positions_;
  double taken_at_ = 0.0;    // s
  Command last_;             // that is of all joints: zeros in its layout stop them all
  bool lacks_zeros_ = true;  // also what a guard before this one, which has died, let pass
  ros::SteadyTime came_;
  ros::Time came_at_;
  ros::Publisher publisher_;
  ros::Subscriber commands_, states_;
};

int run() {
  const ros::NodeHandle node, private_node("~");
  noteWhenAskedToEnd();
  const std::string name = "velocity_limiter";
  const auto parameters = LimiterParameters::read(yamlParameters(private_node, {name})[name]);
  if (!parameters) {
    throw InputError("the parameter ~" + name + " is not set: it is the limiter's");
  }
  if (parameters->is_trajectory) {
    Guard<trajectory_msgs::JointTrajectory>(node, private_node, *parameters).run();
  } else {
    Guard<std_msgs::Float64MultiArray>(node, private_node, *parameters).run();
  }
  return 0;
}

}  // namespace
}  // namespace collision_pairs

int main(int argc, char** argv) {
  // Before roscpp starts its threads, which inherit it: they receive and send.
  const std::string no_real_time = collision_pairs::askForRealTime(collision_pairs::PRIORITY);
  ros::init(argc, argv, "limited_command_guard", ros::init_options::NoSigintHandler);
  if (collision_pairs::isSecondNode()) return 1;
  const ros::NodeHandle keeps_log;
  if (!no_real_time.empty()) ROS_WARN_STREAM("limited_command_guard: " << no_real_time);
  try {
    return collision_pairs::run();
  } catch (const std::exception& error) {
    ROS_FATAL_STREAM("cannot start, and passes no command: " << error.what());
    return 1;
  }
}
