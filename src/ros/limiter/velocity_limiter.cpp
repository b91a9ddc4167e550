#include "velocity_limiter.h"

#include <algorithm>
#include <limits>
#include <utility>

#include <std_msgs/Float64.h>

#include "cloud_view.h"
#include "collision_pairs/input_error.h"
#include "joint_query.h"
#include "parameters.h"
#include "user_text.h"

namespace collision_pairs {
namespace {

// Seconds: a decision is made as if the command were passed this much later than it begins. One
// that takes longer is an overrun.
constexpr double TIME_TO_DECIDE = 0.02;
constexpr double LONGEST_WAIT = 0.1;      // s, so that the thread ends soon
constexpr double SIMULATED_WAIT = 0.001;  // s: a simulated clock may be faster
constexpr double SHOWN_FOR = 1.0;         // s
constexpr double WARN_PERIOD = 5.0;       // s between repeated warnings in the log

template <class Message, class Take>
ros::Subscriber subscribed(ros::NodeHandle& node, const std::string& topic,
                           std::uint32_t queue_size, const Take& take) {
  const boost::function<void(const boost::shared_ptr<const Message>&)> callback =
      [take](const auto& message) { take(*message); };
  return node.subscribe<Message>(topic, queue_size, callback, nullptr,
                                 ros::TransportHints().tcpNoDelay());
}

}  // namespace

VelocityLimiter::VelocityLimiter(const ros::NodeHandle& node, const ros::NodeHandle& private_node,
                                 const QueryContext& context)
    : context_(context) {
  const std::string name = "velocity_limiter";
  try {
    parameters_ = LimiterParameters::read(yamlParameters(private_node, {name})[name]);
    if (parameters_) start(node, private_node);
  } catch (const std::exception& error) {
    error_ = error.what();
    parameters_.reset();
    ROS_ERROR_STREAM("nothing is limited, and no command is passed: " << error_);
  }
}

VelocityLimiter::~VelocityLimiter() {
  stopping_ = true;
  if (thread_.joinable()) thread_.join();
}

void VelocityLimiter::start(const ros::NodeHandle& node, const ros::NodeHandle& private_node) {
  law_ = std::make_unique<LimiterLaw>(parameters_->law);
  ros::NodeHandle own(node), own_private(private_node);
  own.setCallbackQueue(&queue_);
  scale_ = own_private.advertise<std_msgs::Float64>("speed_scale", 1);
  limit_ = own_private.advertise<SpeedLimit>("speed_limit", 1);
  subscribers_.push_back(subscribed<sensor_msgs::JointState>(
      own, parameters_->joint_states, 10, [this](const sensor_msgs::JointState& message) {
        positions_.take(message, followClock(), parameters_->law.max_joint_state_age);
      }));
  // Only the newest command counts: one that waited is replaced.
  if (parameters_->is_trajectory) {
    using trajectory_msgs::JointTrajectory;
    limited_ = own_private.advertise<JointTrajectory>("limited_command", 1);
    subscribers_.push_back(
        subscribed<JointTrajectory>(own, parameters_->command, 1, [this](const auto& message) {
          next_ = {{}, message, ros::SteadyTime::now(), timeOfLaw()};
        }));
  } else {
    using std_msgs::Float64MultiArray;
    limited_ = own_private.advertise<Float64MultiArray>("limited_command", 1);
    subscribers_.push_back(
        subscribed<Float64MultiArray>(own, parameters_->command, 1, [this](const auto& message) {
          next_ = {message, {}, ros::SteadyTime::now(), timeOfLaw()};
        }));
  }
  thread_ = std::thread([this] { work(); });
}

void VelocityLimiter::work() {
  while (!stopping_ && ros::ok()) {
    double wait = LONGEST_WAIT;
    if (!has_stopped_) {
      wait = std::clamp(parameters_->law.command_timeout - silentFor(*last_), 0.0, wait);
      if (ros::Time::isSimTime()) wait = std::min(wait, SIMULATED_WAIT);
    }
    queue_.callAvailable(ros::WallDuration(wait));
    if (next_) {
      last_ = std::move(next_);
      next_.reset();
      answer(*last_);
    } else if (!has_stopped_) {
      stopAfterSilence();
    }
  }
}

double VelocityLimiter::followClock() {
  const double now = context_.transforms.followClock().toSec();
  const unsigned nb_jumps = context_.transforms.nbClockJumps();
  if (now < last_clock_ - TIME_TO_DECIDE || nb_jumps != nb_clock_jumps_) {
    positions_.clear();
    last_clock_ = now;
  }
  law_now_ = ros::Time::isSimTime() ? law_now_ + std::max(0.0, now - last_clock_)
                                    : ros::SteadyTime::now().toSec();
  last_clock_ = std::max(last_clock_, now);
  nb_clock_jumps_ = nb_jumps;
  return now;
}

double VelocityLimiter::timeOfLaw() {
  followClock();
  return law_now_;
}

/// Where a simulated clock stands still, or is slow, nobody waits for it.
double VelocityLimiter::silentFor(const Command& command) {
  return std::max((ros::SteadyTime::now() - command.arrived).toSec(),
                  timeOfLaw() - command.law_arrived);
}

void VelocityLimiter::answer(const Command& command) {
  const double now = followClock() + TIME_TO_DECIDE;
  passed_at_ = std::max(passed_at_, law_now_ + TIME_TO_DECIDE);
  LimiterDecision decision;
  try {
    decision = decide(command, now);
  } catch (const std::exception& error) {
    decision = law_->stop(passed_at_, error.what());
  }
  const double took = (ros::SteadyTime::now() - command.arrived).toSec();
  const bool is_late = took > TIME_TO_DECIDE || timeOfLaw() > passed_at_;
  if (is_late) {
    passed_at_ = std::max(passed_at_, law_now_);
    decision = law_->stop(passed_at_, "overrun: the decision took " + inWords(took));
  }
  publish(command, decision);
  has_stopped_ = false;
  const bool is_fault = decision.verdict == Verdict::UNKNOWN && decision.first.empty();
  if (is_fault) ROS_WARN_STREAM_THROTTLE(WARN_PERIOD, "a command is stopped: " << decision.reason);
  const std::lock_guard<std::mutex> lock(mutex_);
  fault_ = is_fault ? decision.reason : "";
  ++nb_commands_;
  nb_overruns_ += is_late ? 1 : 0;
  slowest_ = std::max(slowest_, took);
}

void VelocityLimiter::stopAfterSilence() {
  if (silentFor(*last_) < parameters_->law.command_timeout) return;
  has_stopped_ = true;
  passed_at_ = std::max(passed_at_, law_now_);
  const LimiterDecision decision =
      law_->stop(passed_at_, "no command for " + inWords(parameters_->law.command_timeout));
  publish(*last_, decision);
}

LimiterDecision VelocityLimiter::decide(const Command& command, double now) {
  LimiterInput input;
  input.now = passed_at_;
  input.command =
      command.array ? command.array->data : velocitiesOf(*command.trajectory, parameters_->joints);
  prepare(now, input);
  return law_->decide(input, *surroundings_);
}

// The scene, joint states, transforms and clouds of one instant.
void VelocityLimiter::prepare(double now, LimiterInput& input) {
  const Fidelity fidelity = context_.defaults().fidelity;
  const ActiveScenePtr active = context_.scenes.active();
  if (!active) throw InputError("there is no robot yet");
  if (active != scene_ || fidelity != fidelity_) {
    surroundings_ =
        std::make_unique<CertifiedSurroundings>(active->scene, parameters_->joints, fidelity);
    scene_ = active;
    fidelity_ = fidelity;
  }
  if (!active->broken_links.empty()) {
    throw InputError("link '" + active->broken_links.front() + "' could not be read");
  }
  const ros::Time clock = context_.transforms.followClock();
  if (clock.isZero()) throw InputError(NO_CLOCK);
  const double age = std::max(0.0, now - positions_.oldestOf(parameters_->joints));
  input.stamp = passed_at_ - age;

  const std::string still = context_.transforms.clockDoubt();
  if (!still.empty()) throw InputError(still);  // nothing is seen to age
  const RobotModel& robot = active->scene->robot();
  std::vector<std::string> names;
  std::vector<double> values;
  for (const auto& [name, position] : positions_.all()) {
    const int id = robot.findJoint(name);
    if (id < 0 || !robot.joints()[id].hasPosition() || robot.joints()[id].mimic) continue;
    if (now - position.stamp > parameters_->law.max_joint_state_age) continue;
    names.push_back(name);
    values.push_back(position.value);
  }
  const JointQuery query(names, *active->scene,
                         {context_.transforms, active->frame, ros::Time(), clock,
                          active->tf_poses->heldAt(clock), active->tf_poses.get()});
  if (!query.doubts().empty()) throw InputError(query.doubts().front());
  RobotState state;
  state.positions = query.jointPositionsAt(values);
  state.placed = query.placedBodies();

  if (active->clouds) {
    BodyPoses poses;
    const auto views = active->clouds->views(clock);
    const std::vector<CloudDoubt> doubts = addVoxels(views, *active->scene, poses);
    if (!doubts.empty()) throw InputError(doubts.front().why);
    state.voxels = std::move(poses.voxels);
    for (const auto& [name, view] : views) {
      input.obstacles_age = std::max(input.obstacles_age, now - view.stamp);
    }
  }
  surroundings_->setState(std::move(state));
}

void VelocityLimiter::publish(const Command& layout, const LimiterDecision& decision) {
  std_msgs::Float64 scale;
  scale.data = decision.scale;
  SpeedLimit limit;
  limit.stamp = ros::Time::now();
  limit.scale = decision.scale;
  limit.verdict = static_cast<std::uint8_t>(decision.verdict);
  limit.first_link = decision.first;
  limit.second_link = decision.second;
  limit.distance =
      decision.has_distance ? decision.distance : std::numeric_limits<double>::quiet_NaN();
  limit.reason = decision.reason;
  if (layout.array) {
    std_msgs::Float64MultiArray limited = *layout.array;
    limited.data = decision.command;
    limited_.publish(limited);
  } else {
    limited_.publish(
        limitedTrajectory(*layout.trajectory, parameters_->joints, decision, positions_));
  }
  scale_.publish(scale);
  limit_.publish(limit);
  const std::lock_guard<std::mutex> lock(mutex_);
  last_limit_ = std::move(limit);
  last_limit_from_ = ros::SteadyTime::now();
}

std::optional<SpeedLimit> VelocityLimiter::lastLimit() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  const bool is_old = (ros::SteadyTime::now() - last_limit_from_).toSec() > SHOWN_FOR;
  return is_old ? std::nullopt : last_limit_;
}

void VelocityLimiter::diagnose(diagnostic_updater::DiagnosticStatusWrapper& status) {
  using diagnostic_msgs::DiagnosticStatus;
  if (!error_.empty()) {
    status.summary(DiagnosticStatus::ERROR, error_);
    return;
  }
  const std::lock_guard<std::mutex> lock(mutex_);
  if (nb_commands_ == 0) {
    status.summary(DiagnosticStatus::OK, "no commands on " + subscribers_.back().getTopic());
  } else if (nb_overruns_ > 0) {
    status.summary(DiagnosticStatus::WARN, "decisions took too long");
  } else if (!fault_.empty()) {
    status.summary(DiagnosticStatus::WARN, "commands are stopped: " + fault_);
  } else {
    status.summary(DiagnosticStatus::OK, "commands are limited");
  }
  status.add("commands", nb_commands_);
  status.add("overruns", nb_overruns_);
  status.add("longest decision [s]", slowest_);
  status.add("scale", last_limit_ ? last_limit_->scale : 0.0);
  status.add("reason", last_limit_ ? last_limit_->reason : "no command yet");
  nb_overruns_ = nb_commands_ = 0;
  slowest_ = 0.0;
}

}  // namespace collision_pairs
