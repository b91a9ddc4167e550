#include "velocity_limiter.h"

#include <algorithm>
#include <limits>
#include <utility>

#include <boost/weak_ptr.hpp>
#include <pthread.h>
#include <std_msgs/Float64.h>

#include "collision_pairs/input_error.h"
#include "parameters.h"
#include "thread_priority.h"
#include "trajectory_command.h"
#include "user_text.h"

namespace collision_pairs {
namespace {

// Seconds: a decision is made as if the command were passed this much later than it begins. One
// that takes longer is an overrun.
constexpr double TIME_TO_DECIDE = 0.02;
constexpr double TIME_TO_PREPARE = 0.01,
                 TIME_TO_SEARCH = 0.015;  // s of it: by then they have ended
constexpr int PRIORITY = 40;              // of the thread that decides: below interrupts
constexpr double LONGEST_WAIT = 0.1;      // s, so that the thread ends soon
constexpr double SIMULATED_WAIT = 0.001;  // s: a simulated clock may be faster
constexpr double SHOWN_FOR = 1.0;         // s
constexpr double WARN_PERIOD = 5.0;       // s between repeated warnings in the log

using Connections = std::vector<boost::weak_ptr<ros::M_string>>;

/// Whether no message came on this connection before. Those that have ended are forgotten.
bool isNew(const boost::shared_ptr<ros::M_string>& connection, Connections& known) {
  const auto isOver = [](const auto& other) { return other.expired(); };
  known.erase(std::remove_if(known.begin(), known.end(), isOver), known.end());
  const auto isThis = [&](const auto& other) { return other.lock() == connection; };
  if (std::any_of(known.begin(), known.end(), isThis)) return false;
  known.push_back(connection);
  return true;
}

/// What a latching publisher sends to whoever connects may be of long ago, as a command that
/// `rostopic pub` left behind: it is not taken, and what comes after it is.
template <class Message, class Take>
ros::Subscriber subscribedToCommands(ros::NodeHandle& node, const std::string& topic,
                                     const Take& take) {
  const auto latching = std::make_shared<Connections>();
  const boost::function<void(const ros::MessageEvent<const Message>&)> callback =
      [take, latching](const ros::MessageEvent<const Message>& event) {
        const boost::shared_ptr<ros::M_string> connection = event.getConnectionHeaderPtr();
        const auto latches = connection->find("latching");
        const bool does_latch = latches != connection->end() && latches->second == "1";
        if (!does_latch || !isNew(connection, *latching)) return take(*event.getConstMessage());
        ROS_WARN_STREAM("a command of '"
                        << event.getPublisherName()
                        << "' is not passed: its publisher latches, so it may be of long ago; "
                           "publish at a rate (rostopic pub -r 20)");
      };
  // Only the newest command counts: one that waited is replaced.
  return node.subscribe<Message>(topic, 1, callback, nullptr, ros::TransportHints().tcpNoDelay());
}

std::chrono::steady_clock::duration after(double seconds) {
  using std::chrono::steady_clock;
  return std::chrono::duration_cast<steady_clock::duration>(std::chrono::duration<double>(seconds));
}

/// To be read under the lock of the inputs: their time does not go back because a thread was late.
LimiterInputs::Clocks clocksNow(unsigned nb_jumps) {
  return {ros::Time::now().toSec(), ros::SteadyTime::now().toSec(), nb_jumps};
}

}  // namespace

VelocityLimiter::VelocityLimiter(const ros::NodeHandle& node, const ros::NodeHandle& private_node,
                                 const QueryContext& context, bool allow_paused)
    : context_(context) {
  const std::string name = "velocity_limiter";
  try {
    parameters_ = LimiterParameters::read(yamlParameters(private_node, {name})[name]);
    if (parameters_) start(node, private_node, allow_paused);
  } catch (const std::exception& error) {
    error_ = error.what();
    parameters_.reset();
    subscribers_.clear();
    ROS_ERROR_STREAM("nothing is limited, and no command is passed: " << error_);
  }
}

VelocityLimiter::~VelocityLimiter() {
  stopping_ = true;
  received_.notify_all();
  for (std::thread* thread : {&listener_, &decider_}) {
    if (thread->joinable()) thread->join();
  }
}

void VelocityLimiter::start(const ros::NodeHandle& node, const ros::NodeHandle& private_node,
                            bool allow_paused) {
  const LimiterSettings& settings = parameters_->law;
  inputs_.emplace(LimiterInputs::Settings{parameters_->joints, settings.max_joint_state_age,
                                          settings.command_timeout, ros::Time::isSimTime(),
                                          allow_paused, settings.tracking_tolerance,
                                          context_.monitor.with([](const Monitor& monitor) {
                                            return monitor.transforms().limits().max_pose_age;
                                          })});
  law_ = std::make_unique<LimiterLaw>(parameters_->law);
  ros::NodeHandle own(node), own_private(private_node);
  own.setCallbackQueue(&queue_);
  scale_ = own_private.advertise<std_msgs::Float64>("speed_scale", 1);
  limit_ = own_private.advertise<SpeedLimit>("speed_limit", 1);
  const boost::function<void(const sensor_msgs::JointState::ConstPtr&)> take_state =
      [this](const auto& message) { take(*message); };
  subscribers_.push_back(own.subscribe<sensor_msgs::JointState>(
      parameters_->joint_states, 10, take_state, nullptr, ros::TransportHints().tcpNoDelay()));
  if (parameters_->is_trajectory) {
    using trajectory_msgs::JointTrajectory;
    limited_ = own_private.advertise<JointTrajectory>("limited_command", 1);
    const auto take_command = [this](const JointTrajectory& message) { take({{}, message, {}}); };
    subscribers_.push_back(
        subscribedToCommands<JointTrajectory>(own, parameters_->command, take_command));
  } else {
    using std_msgs::Float64MultiArray;
    limited_ = own_private.advertise<Float64MultiArray>("limited_command", 1);
    const auto take_command = [this](const Float64MultiArray& message) { take({message, {}, {}}); };
    subscribers_.push_back(
        subscribedToCommands<Float64MultiArray>(own, parameters_->command, take_command));
  }
  refuseLoop(subscribers_.back().getTopic(), limited_.getTopic());
  const auto wanted = [this] {
    const ActiveScenePtr active = context_.monitor.activeScene();
    return PreparedSurroundings::Wanted{active ? active->scene : nullptr,
                                        context_.defaults().fidelity};
  };
  prepared_ = std::make_unique<PreparedSurroundings>(
      wanted, [this, joints = parameters_->joints,
               needed = law_->needed()](const PreparedSurroundings::Wanted& of) {
        auto made = std::make_shared<CertifiedSurroundings>(of.scene, joints, of.fidelity);
        if (!std::exchange(is_first_scene_known_, true)) warnOf(made->alwaysNear(needed));
        return made;
      });
  CommandOutlet::Settings outlet;
  outlet.joints = parameters_->joints;
  outlet.law = parameters_->law;
  outlet.may_stand = parameters_->is_trajectory;
  if (ros::Time::isSimTime()) outlet.poll = SIMULATED_WAIT;
  outlet.now = [this] { return now(); };
  outlet.began = [this] { beginThread("limiter_watch", PRIORITY + 2); };
  outlet_ = std::make_unique<CommandOutlet>(std::move(outlet));
  listener_ = std::thread([this] { listen(); });
  decider_ = std::thread([this] { work(); });
}

void VelocityLimiter::beginThread(const char* name, int priority) {
  pthread_setname_np(pthread_self(), name);
  const std::string why = askForRealTime(priority);
  const std::lock_guard<std::mutex> lock(mutex_);
  if (!why.empty() && !std::exchange(lacks_real_time_, true)) {
    ROS_WARN_STREAM("velocity limiter: " << why);
  }
  real_time_ = why.empty() ? "yes" : why;
}

void VelocityLimiter::warnOf(std::vector<std::string> always_near) {
  for (const std::string& pair : always_near) ROS_WARN_STREAM("velocity limiter: " << pair);
  const std::lock_guard<std::mutex> lock(mutex_);
  always_near_ = std::move(always_near);
}

void VelocityLimiter::listen() {
  beginThread("limiter_listen", PRIORITY + 1);
  while (!stopping_ && ros::ok()) queue_.callAvailable(ros::WallDuration(LONGEST_WAIT));
}

void VelocityLimiter::work() {
  beginThread("limiter_decide", PRIORITY);
  while (!stopping_ && ros::ok()) {
    CommandPtr command;
    {
      std::unique_lock<std::mutex> lock(inputs_mutex_);
      received_.wait_for(lock, std::chrono::duration<double>(LONGEST_WAIT),
                         [this] { return next_ || stopping_; });
      command = std::exchange(next_, nullptr);
    }
    if (command) answer(command);
  }
}

void VelocityLimiter::take(const sensor_msgs::JointState& message) {
  const unsigned nb_jumps = nbClockJumps();
  LimiterInputs::Taken taken;
  {
    const std::lock_guard<std::mutex> lock(inputs_mutex_);
    taken = inputs_->take(message, clocksNow(nb_jumps));
  }
  if (taken.has_jumped) outlet_->forgetMeasured();
  const std::string fault = outlet_->measured(taken.positions);
  std::unique_lock<std::mutex> lock(mutex_);
  const bool is_new = !fault.empty() && is_fault_over_;
  is_fault_over_ = fault.empty();
  if (!fault.empty()) response_fault_ = fault;
  lock.unlock();
  if (is_new) ROS_ERROR_STREAM("velocity limiter: " << fault);
}

void VelocityLimiter::take(Command command) {
  const unsigned nb_jumps = nbClockJumps();
  {
    const std::lock_guard<std::mutex> lock(inputs_mutex_);
    command.arrived = inputs_->follow(clocksNow(nb_jumps));
    next_ = std::make_shared<const Command>(std::move(command));
  }
  received_.notify_all();
}

unsigned VelocityLimiter::nbClockJumps() const {
  return context_.monitor.with(
      [](const Monitor& monitor) { return monitor.transforms().nbClockJumps(); });
}

// Called by the watchdog, which waits for no transforms.
CommandOutlet::Time VelocityLimiter::now() {
  const std::lock_guard<std::mutex> lock(inputs_mutex_);
  return inputs_->follow(clocksNow(inputs_->nbJumps()));
}

void VelocityLimiter::answer(const CommandPtr& command) {
  const auto start = std::chrono::steady_clock::now();
  const double began = ros::SteadyTime::now().toSec();
  outlet_->tell(*law_,
                command->array ? asksToMove(*command->array) : asksToMove(*command->trajectory));
  LimiterDecision decision;
  const auto send = sendAs(command);
  auto result = CommandOutlet::Result::LATE;
  const bool has_waited = began - command->arrived.steady >= parameters_->law.command_timeout;
  if (!has_waited) {
    try {
      decision = decide(*command, start);
    } catch (const std::exception& error) {
      decision = law_->stop(error.what());
    }
    result = outlet_->pass(decision, began + TIME_TO_DECIDE, command->arrived, send);
  }
  const CommandOutlet::Time ended = now();
  const double took = ended.steady - command->arrived.steady;
  using Result = CommandOutlet::Result;
  if (result != Result::PUBLISHED) {
    const double of_clock = ended.latest - command->arrived.latest;  // simulated, it may be faster
    decision = law_->stop(result == Result::LATE
                              ? "overrun: the decision took " + inWords(std::max(took, of_clock))
                          : result == Result::FAULT ? outlet_->fault()
                                                    : "zeros were published while it was decided");
    outlet_->stop(decision, send);
  }
  const bool is_fault = decision.verdict == Verdict::UNKNOWN && decision.first.empty();
  if (is_fault) ROS_WARN_STREAM_THROTTLE(WARN_PERIOD, "a command is stopped: " << decision.reason);
  const std::lock_guard<std::mutex> lock(mutex_);
  fault_ = is_fault ? decision.reason : "";
  ++nb_commands_;
  nb_overruns_ += result == Result::LATE ? 1 : 0;
  slowest_ = std::max(slowest_, took);
}

LimiterDecision VelocityLimiter::decide(const Command& command,
                                        std::chrono::steady_clock::time_point start) {
  LimiterInput input;
  input.command = command.array ? command.array->data
                                : velocitiesOf(*command.trajectory, parameters_->joints,
                                               parameters_->law.reaction_time);
  const auto prepared = [&](const ActiveScenePtr& active) {
    if (!active) throw InputError("there is no robot yet");
    return prepared_->get({active->scene, context_.defaults().fidelity},
                          start + after(TIME_TO_PREPARE));
  };
  prepared(context_.monitor.activeScene());  // may take long: before the states are looked at
  RobotState state;
  const Snapshot snapshot = takeSnapshot(input, state);
  if (!snapshot.poses.unknown_because.empty())
    return law_->stop(snapshot.poses.unknown_because.front());
  const auto surroundings = prepared(snapshot.scene);
  surroundings->setDeadline(start + after(TIME_TO_SEARCH));
  surroundings->setState(std::move(state));
  return law_->decide(input, *surroundings);
}

Snapshot VelocityLimiter::takeSnapshot(LimiterInput& input, RobotState& state) {
  const unsigned nb_jumps = nbClockJumps();
  LimiterInputs::Moment moment;
  {
    const std::lock_guard<std::mutex> lock(inputs_mutex_);
    moment = inputs_->at(clocksNow(nb_jumps), TIME_TO_DECIDE);
  }
  return context_.monitor.with(
      [&](const Monitor& monitor) { return snapshotAt(moment, monitor, input, state); });
}

CommandOutlet::Send VelocityLimiter::sendAs(const CommandPtr& layout) {
  return [this, layout](const LimiterDecision& decision) { send(*layout, decision); };
}

void VelocityLimiter::send(const Command& layout, const LimiterDecision& decision) {
  if (layout.array) {
    std_msgs::Float64MultiArray limited;
    const bool is_accepted = layout.array->data.size() == parameters_->joints.size();
    if (is_accepted) limited.layout = layout.array->layout;
    limited.data = decision.command;
    limited_.publish(limited);
  } else {
    std::unique_lock<std::mutex> lock(inputs_mutex_);
    const auto limited = limitedTrajectory(*layout.trajectory, *parameters_, decision,
                                           inputs_->positions(), ros::Time::now().toSec());
    lock.unlock();
    limited_.publish(limited);
  }
  std_msgs::Float64 scale;
  scale.data = decision.scale;
  scale_.publish(scale);
  SpeedLimit limit;
  limit.stamp = ros::Time::now();
  limit.scale = decision.scale;
  limit.verdict = static_cast<std::uint8_t>(decision.verdict);
  limit.first_link = decision.first;
  limit.second_link = decision.second;
  limit.distance =
      decision.has_distance ? decision.distance : std::numeric_limits<double>::quiet_NaN();
  limit.reason = decision.reason;
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
  if (!response_fault_.empty()) {
    status.summary(DiagnosticStatus::ERROR, response_fault_);
    if (is_fault_over_) response_fault_.clear();
  } else if (nb_commands_ == 0 && always_near_.empty()) {
    status.summary(DiagnosticStatus::OK, "no commands on " + subscribers_.back().getTopic());
  } else if (nb_overruns_ > 0) {
    status.summary(DiagnosticStatus::WARN, "decisions took too long");
  } else if (!fault_.empty()) {
    status.summary(DiagnosticStatus::WARN, "commands are stopped: " + fault_);
  } else if (!always_near_.empty()) {
    status.summary(DiagnosticStatus::WARN, always_near_.front());
  } else {
    status.summary(DiagnosticStatus::OK, "commands are limited");
  }
  status.add("commands", nb_commands_);
  status.add("overruns", nb_overruns_);
  status.add("longest decision [s]", slowest_);
  status.add("real-time scheduling", real_time_);
  status.add("scale", last_limit_ ? last_limit_->scale : 0.0);
  status.add("reason", last_limit_ ? last_limit_->reason : "no command yet");
  nb_overruns_ = nb_commands_ = 0;
  slowest_ = 0.0;
}

}  // namespace collision_pairs
