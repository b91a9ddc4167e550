// Verdicts of many joint states: the batch stage beside the loop over the exact check.
//
//   COLLISION_PAIRS_SHARED=DATA verdict_benchmark STATES > ROWS.csv
//
// A row for each robot, alone and in its world, and for random states and motions of 8 neighbouring
// ones, after NB_OTHERS other states. One thread; forward kinematics included on both sides; times
// are the least of PASSES, taken in turns, ns a state.
#include <chrono>
#include <cstdlib>
#include <iostream>
#include <limits>

#include "batch_kernel.h"
#include "collision_pairs/batch_check.h"
#include "demo_motion.h"
#include "joint_sampler.h"

namespace collision_pairs {
namespace {

constexpr int PASSES = 5;
constexpr std::size_t NB_OTHERS = 300000;
constexpr int NEIGHBOURS = 8;
constexpr double MOTION = 0.2;  // rad or m, of the joint that moves most, over the 8 states
constexpr std::uint64_t SEED = 16;

using States = std::vector<std::vector<double>>;

States randomStates(const std::shared_ptr<const RobotModel>& robot, std::size_t count,
                    bool neighbouring, std::uint64_t seed = SEED) {
  const JointSampler sampler(robot, seed);
  States states(count);
  std::vector<double> to;
  for (std::size_t i = 0; i < count; ++i) {
    if (!neighbouring) {
      sampler.draw(i, states[i]);
      continue;
    }
    const std::size_t motion = i / NEIGHBOURS;
    sampler.draw(2 * motion, states[i]);
    sampler.draw(2 * motion + 1, to);
    double most = 0.0;
    for (std::size_t k = 0; k < to.size(); ++k) {
      most = std::max(most, std::abs(to[k] - states[i][k]));
    }
    const double share = static_cast<double>(i % NEIGHBOURS) / (NEIGHBOURS - 1) *
                         std::min(1.0, MOTION / std::max(most, 1e-9));
    for (std::size_t k = 0; k < to.size(); ++k) states[i][k] += share * (to[k] - states[i][k]);
    robot->applyMimics(states[i]);
  }
  return states;
}

double nanoseconds(const std::function<void()>& work, std::size_t count) {
  const auto start = std::chrono::steady_clock::now();
  work();
  const std::chrono::duration<double, std::nano> took = std::chrono::steady_clock::now() - start;
  return took.count() / static_cast<double>(std::max<std::size_t>(1, count));
}

class Bench {
 public:
  /// `others`: states that are checked before any that are measured, for the tables to learn.
  Bench(std::shared_ptr<const CollisionScene> scene, const States& others)
      : scene_(scene), detector_(scene), batch_(scene, 1) {
    settings_.verdict_only = true;
    const std::vector<double> zero = scene->robot().zeroPositions();
    const auto prepare = [&] {
      batch_.runJoints(
          BatchCheck::STATES_WORTH_A_STAGE, settings_,
          [&](std::size_t, std::vector<double>& q) { q = zero; }, {},
          [](std::size_t, const CollisionReport&) {});
    };
    prepared_ = 1e-9 * nanoseconds(prepare, 1);
    std::vector<Verdict> verdicts(others.size());
    check(others, verdicts);
  }

  void run(const std::string& robot, const std::string& where, const States& states,
           const std::string& kind) {
    std::vector<Verdict> exact(states.size()), batch(states.size());
    std::vector<char> was_sent(states.size());
    double ns_exact = std::numeric_limits<double>::infinity(), ns_batch = ns_exact,
           ns_free = ns_exact;
    for (int pass = 0; pass < PASSES; ++pass) {
      ns_exact =
          std::min(ns_exact, nanoseconds([&] { checkExactly(states, exact); }, states.size()));
      ns_batch = std::min(ns_batch, nanoseconds([&] { check(states, batch); }, states.size()));
    }
    States free;
    std::size_t nb_differ = 0;
    for (std::size_t i = 0; i < states.size(); ++i) {
      nb_differ += exact[i] != batch[i];
      if (exact[i] == Verdict::FREE) free.push_back(states[i]);
    }
    std::vector<Verdict> of_free(free.size());
    for (int pass = 0; pass < PASSES; ++pass) {
      ns_free = std::min(ns_free, nanoseconds([&] { check(free, of_free); }, free.size()));
    }
    std::cout << batchKernels().front().name << ',' << robot << ',' << where << ',' << kind << ','
              << states.size() << ',' << static_cast<double>(free.size()) / states.size() << ','
              << ns_exact << ',' << ns_batch << ',' << ns_exact / ns_batch << ',' << ns_free << ','
              << nb_differ << ',' << prepared_ << ',' << batch_.stageMemory() << std::endl;
  }

 private:
  void checkExactly(const States& states, std::vector<Verdict>& verdicts) {
    for (std::size_t i = 0; i < states.size(); ++i) {
      scene_->robot().forwardKinematics(states[i], X_RB_);
      scene_->gatherPoses(X_RB_, poses_);
      verdicts[i] = detector_.detect(poses_, settings_).verdict;
    }
  }
  void check(const States& states, std::vector<Verdict>& verdicts) {
    batch_.runJoints(
        states.size(), settings_, [&](std::size_t i, std::vector<double>& q) { q = states[i]; }, {},
        [&](std::size_t i, const CollisionReport& report) { verdicts[i] = report.verdict; });
  }

  std::shared_ptr<const CollisionScene> scene_;
  CollisionDetector detector_;
  BatchCheck batch_;
  CheckSettings settings_;
  std::vector<Eigen::Isometry3d> X_RB_;
  BodyPoses poses_;
  double prepared_ = 0.0;  // s, with STATES_WORTH_A_STAGE states at zero
};

void run(const BenchmarkRobot& robot, std::size_t count) {
  const States random = randomStates(robot.robot, count, false);
  const States neighbouring = randomStates(robot.robot, count, true);
  const States others = randomStates(robot.robot, NB_OTHERS, false, SEED + 1);
  for (const bool in_world : {false, true}) {
    if (in_world && !robot.world) continue;
    const auto world = in_world ? robot.world : nullptr;
    Bench bench(CollisionScene::build(robot.robot, robot.srdf, world), others);
    const std::string where = in_world ? "world" : "self";
    bench.run(robot.name, where, random, "random");
    bench.run(robot.name, where, neighbouring, "neighbouring");
  }
}

}  // namespace
}  // namespace collision_pairs

int main(int argc, char** argv) {
  using namespace collision_pairs;
  const int count = argc >= 2 ? std::atoi(argv[1]) : 0;
  const std::string only = argc == 3 ? argv[2] : "";
  if (count < 1) {
    std::cerr << "usage: verdict_benchmark STATES [ROBOT] > ROWS.csv\n";
    return 2;
  }
  std::cout
      << "kernel,robot,scene,kind,states,free,ns_exact,ns_batch,ratio,ns_free,differ,prepared,"
         "bytes\n";
  std::vector<BenchmarkRobot> robots = benchmarkRobots();
  robots.insert(robots.begin(), demoRobot());
  for (const BenchmarkRobot& robot : robots) {
    if (only.empty() || only == robot.name) run(robot, static_cast<std::size_t>(count));
  }
  return 0;
}
