// The velocity limiter on robots with mass, in MuJoCo, judged by the exact check. Prints CSV.
//
// usage: limiter_dynamics runs SECONDS [ROBOT [SERVO [LIMITER.yaml]]]
//        limiter_dynamics steps BAG ROBOT SERVO
#include <algorithm>
#include <cstdlib>
#include <iostream>
#include <string>
#include <vector>

#include <yaml-cpp/yaml.h>

#include "dynamic_robots.h"
#include "simulated_limiters.h"

namespace collision_pairs {
namespace {

constexpr double RUN = 20.0;  // s in one scene

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

SimulationResult run(const DynamicRobot& robot, const SimulationOptions& told, unsigned seed) {
  RandomInputs random(seed);
  SimulationOptions options = robot.options(random.integer(0, 1) == 1);
  options.reaction_time = told.reaction_time;
  options.decelerations = told.decelerations;
  options.command_timeout = random.integer(0, 3) == 0 ? 0.05 : 0.2;
  options.max_speed = random.uniform(0.3, 1.0);
  LimiterScene scene(robot.robot, robot.joints, seed, options);
  const auto surroundings =
      std::make_shared<CertifiedSurroundings>(scene.seen(), scene.joints(), Fidelity::MESH);
  const auto law = std::make_shared<LimiterLaw>(scene.settings());
  const SimulationResult result = scene.run(nodeLimiter(law, surroundings, random), random, RUN);
  const LimiterSettings settings = scene.settings();
  if (result.nearest < settings.stop_distance - 1e-4 ||
      result.nearest_links < settings.self_stop_distance - 1e-4) {
    std::cerr << robot.robot.name << ' ' << servoName(robot.servo) << " seed " << seed
              << ": nearest " << result.nearest << ", links " << result.nearest_links << '\n';
  }
  return result;
}

void runs(double seconds, const std::vector<std::string>& of) {
  const unsigned seed = givenSeed();
  std::cout << "robot,servo,seconds,contacts,nearest,nearest_links,passed\n";
  for (const DynamicRobot& robot : chosen(of[0], of[1])) {
    SimulationOptions told;
    if (of[2].empty()) {
      tell(measured(robot, seed), told);
    } else {
      tell(YAML::LoadFile(of[2])["velocity_limiter"], told);
    }
    SimulationResult all;
    for (unsigned i = 0; i * RUN < seconds; ++i) all.add(run(robot, told, seed + i));
    std::cout << robot.robot.name << ',' << servoName(robot.servo) << ',' << all.seconds << ','
              << all.nb_contacts << ',' << all.nearest << ',' << all.nearest_links << ','
              << all.passed / all.asked << std::endl;
  }
}

int main(const std::vector<std::string>& arguments) {
  const std::string what = arguments.empty() ? "" : arguments[0];
  const auto argument = [&](std::size_t i) { return i < arguments.size() ? arguments[i] : ""; };
  const double seconds = std::atof(argument(1).c_str());
  if (what == "runs" && seconds > 0.0) {
    runs(seconds, {argument(2), argument(3), argument(4)});
  } else if (what == "steps" && arguments.size() == 4) {
    RandomInputs random;
    for (const DynamicRobot& robot : chosen(arguments[2], arguments[3])) {
      writeBag(robot.steps(random), arguments[1]);
    }
  } else {
    std::cerr << "usage: limiter_dynamics runs SECONDS [ROBOT [SERVO [LIMITER.yaml]]]\n"
                 "       limiter_dynamics steps BAG ROBOT SERVO\n";
    return 1;
  }
  return 0;
}

}  // namespace
}  // namespace collision_pairs

int main(int argc, char** argv) {
  return collision_pairs::main(std::vector<std::string>(argv + 1, argv + argc));
}
