// A robot that follows velocity commands, among obstacles, in closed loop with a limiter.
#pragma once

#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <utility>
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

/// What a limiter passes, and when.
struct Passed {
  Passed(std::vector<double> of, double seconds = 0.0) : command(std::move(of)), took(seconds) {}
  std::vector<double> command;
  double took;  ///< s from the view until it is published; no other command is looked at meanwhile
};
/// Called for each command, and with an empty one when none came for command_timeout. Nothing: what
/// passes reaches the robot on another way.
using Limiter = std::function<std::optional<Passed>(const LimiterView&)>;

/// A number that is drawn anew, evenly.
struct Between {
  double low, high;
  double draw(RandomInputs& random) const { return random.uniform(low, high); }
};

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

  // The robot. By default one without mass, which has the deceleration or more.
  std::function<std::unique_ptr<SimulatedRobot>(std::vector<double> positions)> robot;
  std::vector<double> decelerations;  ///< told by joint; empty: the one number for all
  double tracking_tolerance = 0.01;   ///< told; rad or m
  std::optional<Between> dead_time;   ///< s, of each command; default: up to the reaction time
  Between state_rate{50.0, 250.0};    ///< Hz, of a run
  Between state_late{0.0, 0.01};      ///< s, of each joint state
  double state_noise = 0.0;           ///< rad or m, at most, of each position
  bool holds_box = false;             ///< heldBox() is attached
  double check_every = 0.004;         ///< s between exact checks
  double press_share = 0.0;           ///< of the commands: towards what is nearest
  /// In place of random commands: at this time, with the robot at these positions.
  std::function<std::vector<double>(double now, const std::vector<double>& q)> commands;
  /// Called in each step, before the robot moves.
  std::function<void(double now, SimulatedRobot& robot)> pace;
  /// Told of each joint state that arrives. True: zeros are to be passed at once.
  std::function<bool(double now, double stamp, const std::vector<double>& measured)> watch;
};

/// A box beyond all that the robot's last joint moves.
RigidObject heldBox(const RobotModel& robot, const std::string& last_joint);

/// What happened to the robot, and what was passed.
struct SimulationResult : RobotsPart {
  double seconds = 0.0;
  double first_contact = std::numeric_limits<double>::infinity();  ///< s
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

  /// From a random state that keeps 13.5 mm, unless one is given. `seconds` of simulated time, or
  /// none if there is no such state.
  SimulationResult run(const Limiter& limiter, RandomInputs& random, double seconds,
                       std::vector<double> from = {});

  /// By which the distance to the nearest object, or if `any` to anything, falls by 1 m/s; zeros if
  /// nothing is near.
  std::vector<double> towardsNearest(const std::vector<double>& q, bool any,
                                     CertifiedSurroundings& probe) const;

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
  /// One where the limited joints keep this clearance, metres. Empty if none is found: something is
  /// always near some link.
  std::vector<double> freeState(RandomInputs& random, double clearance,
                                const Eigen::Vector3d& mover = Eigen::Vector3d(9, 9, 9));

 private:
  class Mover;
  class Commands;
  std::unique_ptr<SimulatedRobot> robotAt(std::vector<double> q, RandomInputs& random) const;
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
