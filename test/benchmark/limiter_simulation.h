// A robot that follows velocity commands, among obstacles, in closed loop with a limiter.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "benchmark_robots.h"
#include "certified_surroundings.h"
#include "limiter_judge.h"
#include "random_inputs.h"
#include "simulated_joints.h"

namespace collision_pairs {

/// What a limiter sees at one instant.
struct LimiterView {
  double now, stamp, obstacles_age;
  std::vector<double> command;
  RobotState state;
};

/// Returns what is passed.
using Limiter = std::function<std::vector<double>(const LimiterView&)>;

struct SimulationOptions {
  double reaction_time = 0.1;
  double command_timeout = 0.2;
  double deceleration = 5.0;    ///< rad/s^2 that the limiter is told
  double max_speed = 1.0;       ///< rad/s of a joint, of a command
  double obstacle_speed = 0.0;  ///< m/s of a box that the limiter sees as a cloud; 0: there is none
  int nb_things = 8;            ///< static objects
  /// Joint states late, lost, out of order; commands that are not finite, or stop; views of
  /// obstacles that stop.
  bool disturbed = false;
};

/// What happened to the robot, and what was passed.
struct SimulationResult : RobotsPart {
  double seconds = 0.0;
  int nb_stops = 0;                             ///< commands that were stopped, of …
  int nb_commands = 0;                          ///< … all that were not zero
  double passed = 0.0;                          ///< integral of passed speed, of …
  double asked = 0.0;                           ///< … that of the commands
  int nb_retreats = 0, nb_retreats_slowed = 0;  ///< commands by which everything near gets further
  void add(const SimulationResult& other);
};

/// One robot with one set of obstacles; the joints that may be commanded.
class LimiterScene {
 public:
  LimiterScene(const BenchmarkRobot& robot, std::vector<std::string> joints, std::uint64_t index,
               const SimulationOptions& options);

  /// From a random state that keeps 3 cm. `seconds` of simulated time.
  SimulationResult run(const Limiter& limiter, RandomInputs& random, double seconds);

  /// Seconds until the robot, at rest in `from`, has come within 0.02 rad of `to`, driven straight
  /// towards it; infinite after a minute.
  double secondsTo(const std::vector<double>& from, const std::vector<double>& to,
                   const Limiter& limiter);

  /// Drives the robot from a random state in a random direction until nothing passes any more.
  /// False if that does not happen within ten seconds.
  bool driveToAStop(RandomInputs& random, const Limiter& limiter, std::vector<double>& stop);

  const std::shared_ptr<const CollisionScene>& seen() const { return seen_; }
  const std::vector<std::string>& joints() const { return joints_; }
  const SimulationOptions& options() const { return options_; }
  LimiterSettings settings() const;

  /// All joints of the robot, with those of the command at `q`.
  std::vector<double> allPositions(const std::vector<double>& q) const;
  std::vector<double> drawState(RandomInputs& random) const;
  /// One where the limited joints keep this clearance, metres.
  std::vector<double> freeState(RandomInputs& random, double clearance,
                                const Eigen::Vector3d& mover = Eigen::Vector3d(9, 9, 9));

 private:
  class Mover;
  class Commands;
  static void note(const LimiterView& view, const std::vector<double>& passed,
                   CertifiedSurroundings& probe, SimulationResult& result);

  std::vector<std::string> joints_;
  SimulationOptions options_;
  std::shared_ptr<const CollisionScene> seen_;
  std::unique_ptr<LimiterJudge> judge_;
  std::vector<double> lower_, upper_, zero_;
};

/// The joints of arms, by the name of the robot.
std::vector<std::string> limitedJoints(const BenchmarkRobot& robot);

}  // namespace collision_pairs
