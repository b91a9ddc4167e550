// ~velocity_limiter: passes velocity commands as far as the robot can stop in time.
#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include <collision_pairs/SpeedLimit.h>
#include <diagnostic_updater/diagnostic_updater.h>
#include <ros/callback_queue.h>
#include <ros/node_handle.h>
#include <sensor_msgs/JointState.h>
#include <std_msgs/Float64MultiArray.h>
#include <trajectory_msgs/JointTrajectory.h>

#include "certified_surroundings.h"
#include "command_outlet.h"
#include "limiter_inputs.h"
#include "limiter_parameters.h"
#include "prepared_surroundings.h"
#include "query_services.h"

namespace collision_pairs {

/// Receives on one thread, decides on another, with a checker of its own for the node's active
/// scene, and publishes through a CommandOutlet, whose watchdog is a third one: the cycle never
/// waits for it, and no decision delays zeros. Without its parameter, or with one that is refused,
/// it passes nothing.
class VelocityLimiter {
 public:
  /// allow_paused: a simulated clock may stand still.
  VelocityLimiter(const ros::NodeHandle& node, const ros::NodeHandle& private_node,
                  const QueryContext& context, bool allow_paused);
  ~VelocityLimiter();

  bool isWanted() const { return !error_.empty() || parameters_; }
  void diagnose(diagnostic_updater::DiagnosticStatusWrapper& status);
  /// The last decision, if it is no older than a second: for people.
  std::optional<SpeedLimit> lastLimit() const;

 private:
  /// A command of either type.
  struct Command {
    std::optional<std_msgs::Float64MultiArray> array;
    std::optional<trajectory_msgs::JointTrajectory> trajectory;
    CommandOutlet::Time arrived;
  };
  using CommandPtr = std::shared_ptr<const Command>;

  void start(const ros::NodeHandle& node, const ros::NodeHandle& private_node, bool allow_paused);
  void beginThread(const char* name, int priority);
  void warnOf(std::vector<std::string> always_near);
  void listen();
  void work();
  void take(Command command);
  void take(const sensor_msgs::JointState& message);

  unsigned nbClockJumps() const;
  CommandOutlet::Time now();

  void answer(const CommandPtr& command);
  LimiterDecision decide(const Command& command, std::chrono::steady_clock::time_point start);
  /// All that is known now, with the positions of joint states that are young enough.
  Snapshot takeSnapshot(LimiterInput& input, RobotState& state);
  CommandOutlet::Send sendAs(const CommandPtr& layout);
  void send(const Command& layout, const LimiterDecision& decision);

  const QueryContext context_;
  std::string error_;  ///< why the parameter is refused
  std::optional<LimiterParameters> parameters_;
  ros::Publisher limited_, scale_, limit_;

  std::mutex inputs_mutex_;  // guards what was received
  std::condition_variable received_;
  std::optional<LimiterInputs> inputs_;
  CommandPtr next_;

  bool is_first_scene_known_ = false;  // used by the thread that prepares checkers only

  // Used by the thread that decides only.
  std::unique_ptr<LimiterLaw> law_;

  mutable std::mutex mutex_;  // guards what diagnose() and lastLimit() read
  std::optional<SpeedLimit> last_limit_;
  ros::SteadyTime last_limit_from_;
  std::string fault_;           // why the last command was stopped, if it was not for what is near
  std::string response_fault_;  // of the watch, until it is over and was diagnosed
  bool is_fault_over_ = true;
  std::string real_time_ = "not asked for yet";  // or "yes", or why not
  std::vector<std::string> always_near_;         // what stops every command, and the remedy
  bool lacks_real_time_ = false;                 // and the log says so
  double slowest_ = 0.0;                         // seconds of a decision, since asked
  std::size_t nb_commands_ = 0, nb_overruns_ = 0;

  ros::CallbackQueue queue_;
  std::vector<ros::Subscriber> subscribers_;
  std::unique_ptr<PreparedSurroundings> prepared_;
  std::unique_ptr<CommandOutlet> outlet_;
  std::atomic<bool> stopping_{false};
  std::thread listener_, decider_;
};

}  // namespace collision_pairs
