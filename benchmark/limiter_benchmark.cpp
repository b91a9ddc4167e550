// The velocity limiter in the simulator, beside no limiter and MoveIt Servo's formula; what a
// decision costs with a cloud; and how often it stops a robot that nothing is in the way of. Prints
// CSV; scripts/measure_limiter makes the tables of it.
//
// usage: limiter_benchmark runs SECONDS | decisions NUMBER | alone NUMBER | retreats NUMBER | wall
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <iostream>
#include <string>

#include <time.h>

#include "collision_pairs/occupied_voxels.h"
#include "demo_motion.h"
#include "motion_fixtures.h"
#include "simulated_limiters.h"

namespace collision_pairs {
namespace {

std::vector<BenchmarkRobot> allRobots() {
  std::vector<BenchmarkRobot> robots = {demoRobot()};
  for (const BenchmarkRobot& robot : benchmarkRobots()) robots.push_back(robot);
  return robots;
}

std::shared_ptr<CertifiedSurroundings> surroundingsOf(const LimiterScene& scene) {
  return std::make_shared<CertifiedSurroundings>(scene.seen(), scene.joints(), Fidelity::MESH);
}

void runs(double seconds) {
  constexpr double RUN = 10.0;
  std::cout
      << "robot,limiter,seconds,contacts,nearest,nearest_links,passed,retreats,retreats_slowed\n";
  for (const BenchmarkRobot& robot : allRobots()) {
    for (const std::string limiter : {"none", "Servo", "this"}) {
      RandomInputs random;
      SimulationResult all;
      for (int i = 0; i * RUN < seconds; ++i) {
        LimiterScene scene(robot, limitedJoints(robot), static_cast<std::uint64_t>(i), {});
        Limiter of = [](const LimiterView& view) { return view.command; };
        if (limiter == "Servo") of = servoLimiter(surroundingsOf(scene));
        if (limiter == "this") {
          of = lawLimiter(std::make_shared<LimiterLaw>(scene.settings()), surroundingsOf(scene));
        }
        all.add(scene.run(of, random, RUN));
      }
      std::cout << robot.name << ',' << limiter << ',' << all.seconds << ',' << all.nb_contacts
                << ',' << all.nearest << ',' << all.nearest_links << ',' << all.passed / all.asked
                << ',' << all.nb_retreats << ',' << all.nb_retreats_slowed << std::endl;
    }
  }
}

/// Of the surface of a sphere of 2 m around the robot, and of a table top.
std::shared_ptr<const OccupiedVoxels> manyVoxels(double size) {
  std::vector<VoxelCell> cells;
  const int reach = static_cast<int>(2.0 / size);
  for (int x = -reach; x <= reach; ++x) {
    for (int y = -reach; y <= reach; ++y) {
      cells.emplace_back(x, y, static_cast<int>(-0.5 / size));
      const double left = 4.0 - size * size * (x * x + y * y);
      if (left < 0.0) continue;
      cells.emplace_back(x, y, static_cast<int>(std::sqrt(left) / size));
    }
  }
  return std::make_shared<const OccupiedVoxels>(size, cells);
}

double processSeconds() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

void decisions(int nb_decisions) {
  std::cout << "robot,voxels,median_ms,p99_ms\n";
  constexpr double VOXEL_SIZE = 0.016;
  const auto voxels = manyVoxels(VOXEL_SIZE);
  for (const BenchmarkRobot& robot : allRobots()) {
    LimiterScene scene(robot, limitedJoints(robot), 0, {});
    SceneDescription description;
    description.robots.push_back({robot.robot, robot.srdf, ""});
    description.clouds.push_back(cloudOf("camera", VOXEL_SIZE, {}));
    CertifiedSurroundings surroundings(CollisionScene::build(description), scene.joints(),
                                       Fidelity::MESH);
    RandomInputs random;
    std::vector<double> took;
    LimiterLaw law(scene.settings());
    std::vector<double> q = scene.freeState(random, 0.0135), command(q.size());
    for (int i = 0; i < nb_decisions; ++i) {
      if (i % 50 == 0) {
        q = scene.freeState(random, 0.0135);
        for (double& x : command) x = random.uniform(-1.0, 1.0);
      }
      for (std::size_t j = 0; j < q.size(); ++j) q[j] += 0.004 * command[j];
      RobotState state;
      state.positions = scene.allPositions(q);
      state.voxels = {voxels};
      const double before = processSeconds();
      surroundings.setState(std::move(state));
      const double now = 0.004 * i;
      law.published(now, law.decide({now, now - 0.004, 0.03, command}, surroundings));
      took.push_back(1e3 * (processSeconds() - before));
    }
    std::sort(took.begin(), took.end());
    std::cout << robot.name << ',' << voxels->size() << ',' << took[took.size() / 2] << ','
              << took[took.size() * 99 / 100] << std::endl;
  }
}

LimiterDecision firstDecision(const LimiterScene& scene, const std::vector<double>& q,
                              const std::vector<double>& command,
                              CertifiedSurroundings& surroundings) {
  RobotState state;
  state.positions = scene.allPositions(q);
  surroundings.setState(std::move(state));
  return LimiterLaw(scene.settings()).decide({100.0, 100.0, 0.0, command}, surroundings);
}

/// What is in the way of any limiter: the largest of eight scales at which the robot keeps
/// self_stop_distance at 33 places of a straight stopping path, as if it never left that.
double straightScale(const LimiterScene& scene, const std::vector<double>& from,
                     const std::vector<double>& command, CertifiedSurroundings& surroundings) {
  const LimiterSettings settings = scene.settings();
  double fastest = 0.0;
  for (const double x : command) fastest = std::max(fastest, std::abs(x));
  const auto keeps = [&](double scale) {
    const double seconds = settings.reaction_time + settings.command_timeout +
                           0.5 * scale * fastest / settings.deceleration.front();
    for (int i = 0; i <= 32; ++i) {
      std::vector<double> q = from;
      for (std::size_t j = 0; j < q.size(); ++j) q[j] += seconds * i / 32.0 * scale * command[j];
      RobotState state;
      state.positions = scene.allPositions(q);
      surroundings.setState(std::move(state));
      std::vector<NearPair> near;
      std::string why;
      surroundings.nearPairs(settings.self_stop_distance, command, near, why);
      if (!near.empty()) return false;
    }
    return true;
  };
  for (int eighths = 8; eighths > 0; --eighths) {
    if (keeps(eighths / 8.0)) return eighths / 8.0;
  }
  return 0.0;
}

Limiter straightLimiter(const LimiterScene& scene,
                        const std::shared_ptr<CertifiedSurroundings>& surroundings) {
  return [&scene, surroundings](const LimiterView& view) {
    std::vector<double> command = view.command, q;
    if (command.empty()) return command;
    const RobotModel& robot = scene.seen()->robot();
    for (const std::string& joint : scene.joints()) {
      q.push_back(view.state.positions[robot.findJoint(joint)]);
    }
    const double scale = straightScale(scene, q, command, *surroundings);
    for (double& x : command) x *= scale;
    return command;
  };
}

void aloneAt(double deceleration, const BenchmarkRobot& robot, int nb_decisions) {
  SimulationOptions options;
  options.nb_things = 0;
  options.deceleration = deceleration;
  RandomInputs random;
  LimiterScene scene(robot, limitedJoints(robot), 0, options);
  const auto surroundings = surroundingsOf(scene);
  int nb_whole = 0, nb_straight = 0;
  double sum = 0.0, straight_sum = 0.0;
  for (int i = 0; i < nb_decisions; ++i) {
    const std::vector<double> q = scene.freeState(random, 0.005);
    std::vector<double> command(q.size());
    for (double& x : command) x = random.uniform(-1.0, 1.0);
    const double scale = firstDecision(scene, q, command, *surroundings).scale;
    nb_whole += scale == 1.0 ? 1 : 0;
    sum += scale;
    const double straight = straightScale(scene, q, command, *surroundings);
    nb_straight += straight == 1.0 ? 1 : 0;
    straight_sum += straight;
  }
  SimulationResult all, straight;
  for (int i = 0; i < nb_decisions / 100; ++i) {
    RandomInputs same = random;
    all.add(scene.run(lawLimiter(std::make_shared<LimiterLaw>(scene.settings()), surroundings),
                      random, 10.0));
    straight.add(scene.run(straightLimiter(scene, surroundings), same, 10.0));
  }
  std::cout << robot.name << ',' << deceleration << ',' << nb_decisions << ','
            << 1.0 * nb_whole / nb_decisions << ',' << sum / nb_decisions << ','
            << all.passed / all.asked << ',' << 1.0 * nb_straight / nb_decisions << ','
            << straight_sum / nb_decisions << ',' << straight.passed / straight.asked << std::endl;
}

/// Robots in empty space: decisions from rest at random states that keep 5 mm, and random commands
/// in closed loop, 10 s each; beside them what straightScale() would pass.
void alone(int nb_decisions) {
  std::cout << "robot,deceleration,decisions,whole,mean_scale,passed_in_runs,straight_whole,"
               "straight_mean,straight_in_runs\n";
  for (const BenchmarkRobot& robot : allRobots()) {
    for (const double deceleration : {5.0, 50.0}) aloneAt(deceleration, robot, nb_decisions);
  }
}

/// The reversed command from where a command was stopped, among objects.
void retreats(int nb_stops) {
  std::cout << "robot,stops,moved,median_of_retreat_scale\n";
  for (const BenchmarkRobot& robot : allRobots()) {
    RandomInputs random;
    std::vector<double> scales;
    for (std::uint64_t index = 0; static_cast<int>(scales.size()) < nb_stops; ++index) {
      LimiterScene scene(robot, limitedJoints(robot), index, {});
      const auto surroundings = surroundingsOf(scene);
      for (int i = 0; i < 10 && static_cast<int>(scales.size()) < nb_stops; ++i) {
        std::vector<double> stop, asked;
        const auto limiter =
            lawLimiter(std::make_shared<LimiterLaw>(scene.settings()), surroundings);
        const auto noting = [&](const LimiterView& view) {
          asked = view.command;
          return limiter(view);
        };
        if (!scene.driveToAStop(random, noting, stop)) continue;
        for (double& x : asked) x = -x;
        scales.push_back(firstDecision(scene, stop, asked, *surroundings).scale);
      }
    }
    const auto nb_moved =
        std::count_if(scales.begin(), scales.end(), [](double x) { return x > 0; });
    std::sort(scales.begin(), scales.end());
    std::cout << robot.name << ',' << scales.size() << ',' << nb_moved << ','
              << scales[scales.size() / 2] / LimiterSettings().retreat_scale << std::endl;
  }
}

/// A box of 1 m that slides along a wall, 2 cm to its side.
void wall() {
  std::cout << "speed,scale\n";
  CertifiedSurroundings surroundings(
      sceneOf(slidingBox(), {boxAt("wall", {0.0, 1.02, 0.0}, {9.0, 1.0, 1.0})}), {"slide_a"},
      Fidelity::MESH);
  LimiterSettings settings;
  settings.deceleration = {2.0};
  for (const double speed : {0.1, 0.25, 0.5, 1.0}) {
    RobotState state;
    state.positions = {0.0};
    surroundings.setState(std::move(state));
    const LimiterDecision decision =
        LimiterLaw(settings).decide({100.0, 100.0, 0.0, {speed}}, surroundings);
    std::cout << speed << ',' << decision.scale << std::endl;
  }
}

}  // namespace
}  // namespace collision_pairs

int main(int argc, char** argv) {
  const std::string what = argc > 1 ? argv[1] : "";
  const double number = argc > 2 ? std::atof(argv[2]) : 0.0;
  if (what == "runs" && number > 0.0) {
    collision_pairs::runs(number);
  } else if (what == "decisions" && number >= 1.0) {
    collision_pairs::decisions(static_cast<int>(number));
  } else if (what == "alone" && number >= 1.0) {
    collision_pairs::alone(static_cast<int>(number));
  } else if (what == "retreats" && number >= 1.0) {
    collision_pairs::retreats(static_cast<int>(number));
  } else if (what == "wall") {
    collision_pairs::wall();
  } else {
    std::cerr << "usage: limiter_benchmark runs SECONDS | decisions NUMBER | alone NUMBER | "
                 "retreats NUMBER | wall\n";
    return 1;
  }
  return 0;
}
