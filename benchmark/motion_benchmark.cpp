// What certifying a motion costs, beside loops over the exact check.
//
//   COLLISION_PAIRS_SHARED=DATA motion_benchmark SEGMENTS > ROWS.csv
//
// Random motions whose ends are free, as a planner asks for them, of each robot: alone, among
// clutter, and in its world. A row a motion; times are the least of PASSES, taken in turns. "yes":
// MotionSettings::only_free, after WARM_UP other motions.
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <iostream>
#include <limits>
#include <stdexcept>

#include "demo_motion.h"
#include "motion_scenes.h"

namespace collision_pairs {
namespace {

constexpr int PASSES = 5;
constexpr std::uint64_t WARM_UP = 10000;
constexpr double COARSE_STEP = 0.05, FINE_STEP = 0.01;  // rad or m
const char* const VERDICTS[] = {"free", "collision", "unresolved"};

/// Keeps the least time of several calls, µs.
class Stopwatch {
 public:
  template <class Work>
  void time(const Work& work) {
    const auto start = std::chrono::steady_clock::now();
    work();
    const std::chrono::duration<double, std::micro> took = std::chrono::steady_clock::now() - start;
    least_ = std::min(least_, took.count());
  }
  double least() const { return least_; }

 private:
  double least_ = std::numeric_limits<double>::infinity();
};

/// In steps of COARSE_STEP.
double smallestDistance(StateLoop& loop, const JointMotion& motion) {
  CheckSettings settings;
  settings.min_distance = true;
  const int nb_steps = std::max(1, static_cast<int>(std::ceil(lengthOf(motion) / COARSE_STEP)));
  double smallest = std::numeric_limits<double>::infinity();
  for (int i = 0; i <= nb_steps; ++i) {
    const double fraction = static_cast<double>(i) / nb_steps;
    smallest = std::min(smallest, loop.at(motion, fraction, settings).min_distance);
  }
  return smallest;
}

class Bench {
 public:
  Bench(const std::string& robot, const std::string& scene_name,
        std::shared_ptr<const CollisionScene> scene)
      : robot_(robot),
        scene_name_(scene_name),
        scene_(scene),
        check_(scene),
        yes_(scene),
        loop_(scene) {
    only_free_.only_free = true;
  }

  void run(int nb_segments) {
    const std::shared_ptr<const RobotModel> model(scene_, &scene_->robot());
    for (std::uint64_t i = 0; i < WARM_UP; ++i) {
      yes_.check(randomMotion(model, 1'000'000 + i, lengthNumber(i)), only_free_);
    }
    CheckSettings settings;
    settings.verdict_only = true;
    int done = 0;
    for (std::uint64_t i = 0; done < nb_segments; ++i) {
      const JointMotion motion = randomMotion(model, i, lengthNumber(i));
      if (loop_.at(motion, 0.0, settings).in_collision) continue;
      if (loop_.at(motion, 1.0, settings).in_collision) continue;
      measure(motion);
      ++done;
    }
  }

 private:
  void measure(const JointMotion& motion) {
    Stopwatch certified, yes, coarse, fine;
    bool is_certified = false, found_by_coarse = false, found_by_fine = false;
    MotionReport report;
    for (int pass = 0; pass < PASSES; ++pass) {
      certified.time([&] { report = check_.check(motion, {}); });
      yes.time([&] { is_certified = yes_.check(motion, only_free_).verdict == Verdict::FREE; });
      coarse.time([&] { found_by_coarse = loop_.findsContact(motion, COARSE_STEP); });
      fine.time([&] { found_by_fine = loop_.findsContact(motion, FINE_STEP); });
    }
    const bool is_free = report.verdict == Verdict::FREE;
    if (is_certified != is_free) {
      throw std::logic_error("with only_free a motion of " + robot_ + " is judged otherwise");
    }
    std::cout << robot_ << ',' << scene_name_ << ',' << lengthOf(motion) << ','
              << (is_free ? smallestDistance(loop_, motion) : 0.0) << ','
              << VERDICTS[static_cast<int>(report.verdict)] << ',' << report.clearance << ','
              << report.nb_checks << ',' << report.nb_queries << ',' << certified.least() << ','
              << yes.least() << ',' << coarse.least() << ',' << fine.least() << ','
              << found_by_coarse << ',' << found_by_fine << '\n';
  }

  std::string robot_, scene_name_;
  std::shared_ptr<const CollisionScene> scene_;
  MotionCheck check_, yes_;
  MotionSettings only_free_;
  StateLoop loop_;
};

void run(const BenchmarkRobot& robot, int nb_segments) {
  Bench(robot.name, "alone", CollisionScene::build(robot.robot, robot.srdf, nullptr))
      .run(nb_segments);
  Bench(robot.name, "clutter", clutteredScene(robot, 0)).run(nb_segments);
  if (!robot.world) return;
  Bench(robot.name, "world", CollisionScene::build(robot.robot, robot.srdf, robot.world))
      .run(nb_segments);
}

}  // namespace
}  // namespace collision_pairs

int main(int argc, char** argv) {
  using namespace collision_pairs;
  const int nb_segments = argc == 2 ? std::atoi(argv[1]) : 0;
  if (nb_segments < 1) {
    std::cerr << "usage: motion_benchmark SEGMENTS > ROWS.csv\n";
    return 2;
  }
  std::cout
      << "robot,scene,length,distance,verdict,clearance,checks,queries,us,us_yes,us_coarse,us_fine,"
         "coarse_finds,fine_finds\n";
  run(demoRobot(), nb_segments);
  for (const BenchmarkRobot& robot : benchmarkRobots()) run(robot, nb_segments);
  return 0;
}
