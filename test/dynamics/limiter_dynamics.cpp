// The velocity limiter on robots with mass, in MuJoCo, judged by the exact check. Prints CSV, or
// how it is used.
//
// Broken robots are driven towards an object that is near, or, fast, to and fro in empty space.
// Goals are at the end of straight free ways, with and without limiter.
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <iostream>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <yaml-cpp/yaml.h>

#include "collision_pairs/motion_check.h"
#include "dynamic_robots.h"
#include "simulated_limiters.h"

namespace collision_pairs {
namespace {

constexpr double RUN = 20.0;  // s in one scene
constexpr double NEVER = std::numeric_limits<double>::infinity();
// Of broken robots: where they set out, as the limiter is told; m, s, m/s.
constexpr int MOST_STATES = 2000;
constexpr double NEAR = 0.03, RESTS = 0.3, BROKEN_RUN = 3.0, FASTEST = 0.5;
// In empty space: speeds of joints, rad/s, and s until they are reversed.
constexpr Between FREE_SPEED{0.5, 1.0};
constexpr double REVERSED_AFTER = 0.6;
// Of ways to goals: what they keep, links of each other, and within what they pass something, m;
// where a goal is reached, rad; when it counts as lost, s.
constexpr double KEPT = 0.0125, LINKS_KEEP = 0.0045, PASSED = 0.05, THERE = 0.02, LOST = 20.0;

std::vector<DynamicRobot> chosen(const std::string& name, const std::string& servo) {
  std::vector<DynamicRobot> found;
  for (const BenchmarkRobot& robot : dynamicRobots()) {
    for (const Servo of : {Servo::RAMP, Servo::PI}) {
      const bool is_wanted =
          (name.empty() || name == robot.name) && (servo.empty() || servo == servoName(of));
      if (is_wanted) found.emplace_back(robot, of);
    }
  }
  return found;
}

StoppingAnalysis measured(const DynamicRobot& robot, unsigned seed) {
  RandomInputs random(seed);
  const StoppingAnalysis found = analyseStopping(robot.steps(random));
  std::cerr << robot.robot.name << ' ' << servoName(robot.servo) << ": reaction_time "
            << found.reaction_time << ", deceleration (slope, dead time, overshoot)";
  for (const JointStopping& joint : found.joints) {
    std::cerr << ' ' << joint.deceleration << " (" << joint.slope << ", " << joint.dead_time << ", "
              << joint.overshoot << ')';
  }
  std::cerr << '\n';
  for (const std::string& warning : found.warnings) std::cerr << "  " << warning << '\n';
  return found;
}

void tell(const YAML::Node& limiter, SimulationOptions& options) {
  options.reaction_time = limiter["reaction_time"].as<double>();
  options.decelerations.clear();
  for (const auto& joint : limiter["joints"]) {
    options.decelerations.push_back(limiter["deceleration"][joint.as<std::string>()].as<double>());
  }
}

struct Run {
  SimulationResult result;
  int nb_alarms = 0;
};

Run run(const DynamicRobot& robot, const SimulationOptions& told, unsigned seed) {
  RandomInputs random(seed);
  SimulationOptions options = robot.options(random.integer(0, 1) == 1);
  options.reaction_time = told.reaction_time;
  options.decelerations = told.decelerations;
  options.command_timeout = random.integer(0, 3) == 0 ? 0.05 : 0.2;
  options.max_speed = random.uniform(0.3, 1.0);
  std::unique_ptr<NodeLimiter> limiter;
  options.watch = [&](double now, double stamp, const std::vector<double>& q) {
    return limiter->measured(now, stamp, q);
  };
  LimiterScene scene(robot.robot, robot.joints, seed, options);
  limiter = std::make_unique<NodeLimiter>(scene, random, false);
  Run all;
  all.result = scene.run([&](const LimiterView& view) { return (*limiter)(view); }, random, RUN);
  all.nb_alarms = limiter->nbFaults();
  const LimiterSettings settings = scene.settings();
  const SimulationResult& found = all.result;
  if (found.nearest < settings.stop_distance - 1e-4 ||
      found.nearest_links < settings.self_stop_distance - 1e-4 || all.nb_alarms > 0) {
    std::cerr << robot.robot.name << ' ' << servoName(robot.servo) << " seed " << seed
              << ": nearest " << found.nearest << ", links " << found.nearest_links << ", "
              << all.nb_alarms << " alarms " << limiter->fault() << '\n';
  }
  return all;
}

void runs(double seconds, const std::vector<std::string>& of) {
  const unsigned seed = givenSeed();
  std::cout << "robot,servo,seconds,contacts,nearest,nearest_links,passed,alarms\n";
  for (const DynamicRobot& robot : chosen(of[0], of[1])) {
    SimulationOptions told;
    if (of[2].empty()) {
      tell(measured(robot, seed), told);
    } else {
      tell(YAML::LoadFile(of[2])["velocity_limiter"], told);
    }
    Run all;
    for (unsigned i = 0; all.result.seconds < seconds; ++i) {
      const Run one = run(robot, told, seed + i);
      all.result.add(one.result);
      all.nb_alarms += one.nb_alarms;
    }
    const SimulationResult& found = all.result;
    std::cout << robot.robot.name << ',' << servoName(robot.servo) << ',' << found.seconds << ','
              << found.nb_contacts << ',' << found.nearest << ',' << found.nearest_links << ','
              << found.passed / found.asked << ',' << all.nb_alarms << std::endl;
  }
}

/// A state near an object; empty if none is found.
std::vector<double> stateNear(LimiterScene& scene, CertifiedSurroundings& probe,
                              RandomInputs& random) {
  const std::vector<double> all(scene.joints().size(), 1.0);
  std::vector<NearPair> pairs;
  std::string why;
  for (int i = 0; i < MOST_STATES; ++i) {
    const std::vector<double> q = scene.freeState(random, 0.0135);
    if (q.empty()) return {};
    RobotState state;
    state.positions = scene.allPositions(q);
    probe.setState(std::move(state));
    probe.nearPairs(NEAR + 0.005, all, pairs, why);
    const auto isObject = [](const NearPair& pair) { return !pair.is_robot; };
    const auto found = std::find_if(pairs.begin(), pairs.end(), isObject);
    if (found != pairs.end() && found->distance > NEAR) return q;
  }
  return {};
}

double largestOf(const std::vector<double>& v) {
  double largest = 0.0;
  for (const double x : v) largest = std::max(largest, std::abs(x));
  return largest;
}

struct Noticed {
  double contact, fault, onset;  ///< s; infinite: none
  double nearest;                ///< m
  double fastest;                ///< rad/s that were passed to a joint
  std::string words;
};

/// One robot of which this is wrong, in empty space, or driven towards an object, if one can be
/// near.
std::optional<Noticed> broken(const DynamicRobot& robot, const SimulationOptions& told,
                              const std::string& wrong, bool is_near, unsigned seed) {
  RandomInputs random(seed);
  RobotFault fault;
  fault.exchanges_joints = wrong == "exchanged";
  fault.sags = wrong == "sags" ? 0.5 : 0.0;
  SimulationOptions options = robot.options(false);
  options.reaction_time = told.reaction_time;
  options.decelerations = told.decelerations;
  options.tracking_tolerance = told.tracking_tolerance;
  if (!is_near) options.nb_things = 0;
  if (wrong == "late") options.dead_time = {0.15, 0.25};
  if (wrong == "slow") {
    for (double& x : options.decelerations) x *= 3.0;
  }
  std::unique_ptr<NodeLimiter> limiter;
  std::unique_ptr<CertifiedSurroundings> probe;
  LimiterScene* scene_of = nullptr;
  const double speed = random.uniform(0.1, FASTEST);
  std::vector<double> to_and_fro;
  for (std::size_t j = 0; j < robot.joints.size(); ++j) {
    to_and_fro.push_back((random.integer(0, 1) ? 1.0 : -1.0) * FREE_SPEED.draw(random));
  }
  options.robot = [&](std::vector<double> q) {
    return std::make_unique<MujocoRobot>(robot.bare, robot.servo, std::move(q), fault);
  };
  options.watch = [&](double now, double stamp, const std::vector<double>& q) {
    return limiter->measured(now, stamp, q);
  };
  options.commands = [&](double now, const std::vector<double>& q) {
    std::vector<double> command(q.size(), 0.0);
    if (now < RESTS || wrong == "sags" || wrong == "pushed") return command;
    if (!is_near) {
      command = to_and_fro;
      const bool is_back = std::fmod(now - RESTS, 2.0 * REVERSED_AFTER) > REVERSED_AFTER;
      for (double& x : command) x *= is_back ? -1.0 : 1.0;
      return command;
    }
    command = scene_of->towardsNearest(q, false, *probe);
    const double most = std::max(largestOf(command) * speed, 1.0);
    for (double& x : command) x *= speed / most;
    return command;
  };
  LimiterScene scene(robot.robot, robot.joints, seed, options);
  scene_of = &scene;
  probe = std::make_unique<CertifiedSurroundings>(scene.seen(), scene.joints(), Fidelity::MESH);
  limiter = std::make_unique<NodeLimiter>(scene, random, true);
  const std::vector<double> from =
      is_near ? stateNear(scene, *probe, random) : scene.freeState(random, 0.0135);
  if (from.empty()) return std::nullopt;
  Noticed found{NEVER, NEVER, wrong == "sags" ? 0.0 : NEVER, 1.0, 0.0, ""};
  if (wrong == "pushed") {  // harder than the motor of the joint that leads nearest
    const std::vector<double> towards = scene.towardsNearest(from, false, *probe);
    const double largest = largestOf(towards);
    for (const double x : towards)
      fault.push.push_back(std::abs(x) < largest ? 0.0 : 1.3 * x / largest);
    fault.push_from = found.onset = RESTS;
  }
  double before = 0.0, fastest = 0.0;
  const SimulationResult result = scene.run(
      [&](const LimiterView& view) {
        const Passed passed = (*limiter)(view);
        const double now = largestOf(passed.command);
        // Of a robot that is slow to follow: where it is to brake, or has far to go.
        const bool shows = wrong == "slow" && is_near ? now < before : now > 0.0;
        if (shows) found.onset = std::min(found.onset, view.now + passed.took);
        before = now;
        fastest = std::max(fastest, now);
        return passed;
      },
      random, BROKEN_RUN, from);
  found.contact = result.first_contact;
  found.nearest = result.nearest;
  found.fastest = fastest;
  found.fault = limiter->firstFault();
  found.words = limiter->fault();
  return found;
}

void broken(int number, const DynamicRobot& robot, const SimulationOptions& told,
            const std::string& wrong, bool is_near, unsigned seed) {
  std::vector<double> took, fastest;
  int nb_contacts = 0, nb_before = 0;
  double nearest = 1.0;
  for (int i = 0; i < number;) {
    const auto found = broken(robot, told, wrong, is_near, seed++);
    if (!found) continue;
    if (i++ == 0) std::cerr << wrong << ": " << found->words << '\n';
    if (std::isfinite(found->fault)) took.push_back(found->fault - found->onset);
    fastest.push_back(found->fastest);
    nb_contacts += std::isfinite(found->contact) ? 1 : 0;
    nearest = std::min(nearest, found->nearest);
    nb_before += found->contact < found->fault ? 1 : 0;
  }
  std::sort(took.begin(), took.end());
  std::sort(fastest.begin(), fastest.end());
  const auto nb_in_time =
      std::count_if(took.begin(), took.end(), [](double x) { return x <= 0.2; });
  std::cout << robot.robot.name << ',' << servoName(robot.servo) << ',' << wrong << ','
            << (is_near ? "near" : "free") << ',' << number << ',' << took.size() << ','
            << nb_in_time << ',' << nb_contacts << ',' << nb_before << ',' << nearest << ','
            << fastest[fastest.size() / 2] << ',';
  if (!took.empty()) std::cout << took[took.size() / 2];
  std::cout << ',';
  if (!took.empty()) std::cout << took.back();
  std::cout << std::endl;
}

void broken(int number, const std::string& name, const std::string& servo, double tolerance) {
  std::cout << "robot,servo,wrong,where,runs,noticed,in_time,contacts,contacts_before,nearest,"
               "speed,median_s,longest_s\n";
  const unsigned seed = givenSeed();
  for (const DynamicRobot& robot : chosen(name, servo)) {
    SimulationOptions told;
    tell(measured(robot, seed), told);
    if (tolerance > 0.0) told.tracking_tolerance = tolerance;
    for (const bool is_near : {true, false}) {
      for (const std::string wrong : {"nothing", "exchanged", "sags", "late", "pushed", "slow"}) {
        const bool needs_object = wrong == "sags" || wrong == "pushed";
        if (is_near || !needs_object) broken(number, robot, told, wrong, is_near, seed);
      }
    }
  }
}

struct Goal {
  double seconds[2] = {NEVER, NEVER};  ///< without and with limiter
  SimulationResult result;
  std::string reason;
};

/// Straight from one random state to another; nothing if the robot without limiter does not get
/// there, or touches something.
std::optional<Goal> driven(const DynamicRobot& robot, const SimulationOptions& told,
                           unsigned seed) {
  Goal goal;
  std::vector<double> from, to;
  double* reached = goal.seconds;
  std::unique_ptr<NodeLimiter> limiter;
  SimulationOptions options = robot.options(false);
  options.reaction_time = told.reaction_time;
  options.decelerations = told.decelerations;
  options.watch = [&](double now, double stamp, const std::vector<double>& q) {
    return limiter && limiter->measured(now, stamp, q);
  };
  options.commands = [&](double now, const std::vector<double>& q) {
    std::vector<double> command(q.size());
    for (std::size_t j = 0; j < q.size(); ++j) command[j] = to[j] - q[j];
    const double left = largestOf(command);
    if (left < THERE) *reached = std::min(*reached, now);
    const double factor = std::isfinite(*reached) ? 0.0 : std::min(1.0 / left, 4.0);
    for (double& x : command) x *= factor;
    return command;
  };
  LimiterScene scene(robot.robot, robot.joints, seed, options);
  MotionCheck check(scene.seen());
  MotionSettings settings;
  settings.only_free = settings.only_moved = true;
  settings.clearance_of = [&](auto first, auto second) {
    const int carrier = scene.seen()->carrierOf(first);
    return carrier >= 0 && carrier == scene.seen()->carrierOf(second) ? LINKS_KEEP
                                                                      : settings.clearance;
  };
  const auto keeps = [&](double clearance) {
    settings.clearance = clearance;
    const JointMotion way{scene.allPositions(from), scene.allPositions(to)};
    return check.check(way, settings).verdict == Verdict::FREE;
  };
  RandomInputs random(seed);
  do {
    from = scene.drawState(random), to = scene.drawState(random);
    const double share = random.uniform(0.05, 1.0);
    for (std::size_t j = 0; j < to.size(); ++j) to[j] = from[j] + share * (to[j] - from[j]);
  } while (!keeps(KEPT) || keeps(PASSED));
  RandomInputs same(seed), same_again(seed);
  const auto none = [](const LimiterView& view) { return Passed(view.command); };
  const bool touches = scene.run(none, same, LOST, from).nb_contacts > 0;
  if (touches || *reached++ == NEVER) return std::nullopt;
  limiter = std::make_unique<NodeLimiter>(scene, random, true, false);
  goal.result =
      scene.run([&](const LimiterView& view) { return (*limiter)(view); }, same_again, LOST, from);
  goal.reason = limiter->reason();
  return goal;
}

void goals(int number, const std::string& name, const std::string& servo) {
  std::cout << "robot,servo,goals,reached,median,worst,contacts,nearest,nearest_links\n";
  for (const DynamicRobot& robot : chosen(name, servo)) {
    unsigned seed = givenSeed();
    SimulationOptions told;
    tell(measured(robot, seed), told);
    std::vector<double> ratios;
    SimulationResult all;
    while (ratios.size() < static_cast<std::size_t>(number)) {
      const auto goal = driven(robot, told, seed++);
      if (!goal) continue;
      all.add(goal->result);
      ratios.push_back(goal->seconds[1] / goal->seconds[0]);
      std::cerr << seed - 1 << ": " << ratios.back() << " times, " << goal->reason << '\n';
    }
    std::sort(ratios.begin(), ratios.end());
    const auto nb_reached = std::lower_bound(ratios.begin(), ratios.end(), NEVER) - ratios.begin();
    std::cout << robot.robot.name << ',' << servoName(robot.servo) << ',' << number << ','
              << nb_reached << ',' << ratios[ratios.size() / 2] << ',' << ratios.back() << ','
              << all.nb_contacts << ',' << all.nearest << ',' << all.nearest_links << std::endl;
  }
}

int main(const std::vector<std::string>& arguments) {
  const std::string what = arguments.empty() ? "" : arguments[0];
  const auto argument = [&](std::size_t i) { return i < arguments.size() ? arguments[i] : ""; };
  const double number = std::atof(argument(1).c_str());
  if (what == "runs" && number > 0.0) {
    runs(number, {argument(2), argument(3), argument(4)});
  } else if (what == "steps" && arguments.size() == 4) {
    RandomInputs random;
    for (const DynamicRobot& robot : chosen(arguments[2], arguments[3])) {
      writeBag(robot.steps(random), arguments[1]);
    }
  } else if (what == "broken" && number >= 1.0) {
    broken(static_cast<int>(number), argument(2), argument(3), std::atof(argument(4).c_str()));
  } else if (what == "goals" && number >= 1.0) {
    goals(static_cast<int>(number), argument(2), argument(3));
  } else {
    std::cerr << "usage: limiter_dynamics runs SECONDS [ROBOT [SERVO [LIMITER.yaml]]] | steps BAG "
                 "ROBOT SERVO | broken NUMBER [ROBOT [SERVO [TOLERANCE]]] | goals NUMBER [ROBOT "
                 "[SERVO]]\n";
    return 1;
  }
  return 0;
}

}  // namespace
}  // namespace collision_pairs

int main(int argc, char** argv) {
  return collision_pairs::main(std::vector<std::string>(argv + 1, argv + argc));
}
