// ~velocity_limiter: passes velocity commands as far as the robot can stop in time.
#pragma once

#include <atomic>
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
#include "limited_command.h"
#include "limiter_parameters.h"
#include "query_services.h"
#include "transform_input.h"

namespace collision_pairs {

/// Runs on a thread of its own, with a checker of its own for the node's active scene: the cycle
/// never waits for it. Without its parameter, or with one that is refused, it passes nothing.
class VelocityLimiter {
 public:
  VelocityLimiter(const ros::NodeHandle& node, const ros::NodeHandle& private_node,
                  const QueryContext& context);
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
    ros::SteadyTime arrived;
    double law_arrived = 0.0;  ///< seconds, as law_now_
  };

  void start(const ros::NodeHandle& node, const ros::NodeHandle& private_node);
  void work();
  /// Returns the time, seconds, and brings law_now_ up to date. Where the clock went back since the
  /// last call, the joint states are of another time, and dropped.
  double followClock();
  double timeOfLaw();
  double silentFor(const Command& command);
  void answer(const Command& command);
  void stopAfterSilence();
  /// `now`: when the command is passed, on the clock of stamps.
  LimiterDecision decide(const Command& command, double now);
  void prepare(double now, LimiterInput& input);
  void publish(const Command& layout, const LimiterDecision& decision);

  const QueryContext context_;
  std::string error_;  ///< why the parameter is refused
  std::optional<LimiterParameters> parameters_;

  // Used by its thread only.
  std::unique_ptr<LimiterLaw> law_;
  JointPositions positions_;
  ActiveScenePtr scene_;
  std::unique_ptr<CertifiedSurroundings> surroundings_;
  Fidelity fidelity_ = Fidelity::MESH;
  std::optional<Command> next_, last_;
  bool has_stopped_ = true;
  // What was passed has an effect for as long as it takes the robot, whatever happens to the clock:
  // the law has a time of its own, which no jump sets back. It is that of the steady clock, or goes
  // on with a simulated one.
  double law_now_ = 0.0, passed_at_ = 0.0;  // the latter: that of the last decision
  double last_clock_ = 0.0;                 // the latest, but for a jump back
  unsigned nb_clock_jumps_ = 0;
  ros::Publisher limited_, scale_, limit_;

  mutable std::mutex mutex_;  // guards what diagnose() and lastLimit() read
  std::optional<SpeedLimit> last_limit_;
  ros::SteadyTime last_limit_from_;
  std::string fault_;     // why the last command was stopped, if it was not for what is near
  double slowest_ = 0.0;  // seconds of a decision, since asked
  std::size_t nb_commands_ = 0, nb_overruns_ = 0;

  ros::CallbackQueue queue_;
  std::vector<ros::Subscriber> subscribers_;
  std::atomic<bool> stopping_{false};
  std::thread thread_;
};

}  // namespace collision_pairs
