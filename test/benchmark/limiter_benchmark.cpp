// The velocity limiter in the simulator, beside no limiter and MoveIt Servo's formula; what a
// decision costs with a cloud. Prints CSV; scripts/measure_limiter makes the tables of it.
//
// usage: limiter_benchmark runs SECONDS | limiter_benchmark decisions NUMBER
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <iostream>
#include <string>

#include <time.h>

#include "collision_pairs/occupied_voxels.h"
#include "demo_motion.h"
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
  std::cout << "robot,limiter,seconds,contacts,nearest,passed,retreats,retreats_slowed\n";
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
                << ',' << all.nearest << ',' << all.passed / all.asked << ',' << all.nb_retreats
                << ',' << all.nb_retreats_slowed << std::endl;
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

}  // namespace
}  // namespace collision_pairs

int main(int argc, char** argv) {
  const std::string what = argc > 1 ? argv[1] : "";
  const double number = argc > 2 ? std::atof(argv[2]) : 0.0;
  if (what == "runs" && number > 0.0) {
    collision_pairs::runs(number);
  } else if (what == "decisions" && number >= 1.0) {
    collision_pairs::decisions(static_cast<int>(number));
  } else {
    std::cerr << "usage: limiter_benchmark runs SECONDS | limiter_benchmark decisions NUMBER\n";
    return 1;
  }
  return 0;
}
