// The whole check against MoveIt's loop, on real robots in recorded states; forward kinematics is
// not counted. BM_<Who>/<robot>/<query>; the counters median_us and p99_us are over the states,
// each state's time being the least of its repetitions, so that what the machine does besides is
// left out.
//
//   COLLISION_PAIRS_SHARED=DATA detector_benchmark --benchmark_format=json
#include <algorithm>
#include <chrono>
#include <functional>
#include <limits>
#include <map>
#include <numeric>

#include <benchmark/benchmark.h>

#include "benchmark_robots.h"
#include "collision_pairs/collision_detector.h"
#include "moveit_loop.h"

namespace collision_pairs {
namespace {

constexpr int PASSES = 5;
const char* const QUERIES[] = {"self",           "self_contacts", "self_distance", "world",
                               "world_distance", "self_apart",    "self_hulls",    "way_hulls",
                               "self_asked",     "self_selected"};

using Check = std::function<double(std::size_t state)>;

double quantile(std::vector<double> values, double share) {
  std::sort(values.begin(), values.end());
  return values[std::min(values.size() - 1, static_cast<std::size_t>(share * values.size()))];
}

void run(benchmark::State& state, std::size_t nb_states, const Check& check) {
  std::vector<double> least(nb_states, std::numeric_limits<double>::infinity());
  double sum = 0.0;
  for (auto _ : state) {
    for (int pass = 0; pass < PASSES; ++pass) {
      for (std::size_t i = 0; i < nb_states; ++i) {
        const auto start = std::chrono::steady_clock::now();
        const double answer = check(i);
        const std::chrono::duration<double, std::micro> took =
            std::chrono::steady_clock::now() - start;
        benchmark::DoNotOptimize(sum += answer);
        least[i] = std::min(least[i], took.count());
      }
    }
  }
  state.counters["median_us"] = quantile(least, 0.5);
  state.counters["p99_us"] = quantile(least, 0.99);
  state.counters["mean_us"] = std::accumulate(least.begin(), least.end(), 0.0) / nb_states;
}

/// Ten straight motions in joint space, each between two of the states, in 50 steps.
std::vector<std::vector<Eigen::Isometry3d>> motionsOf(const BenchmarkRobot& robot) {
  std::vector<std::vector<Eigen::Isometry3d>> states;
  for (std::size_t k = 0; k < 10; ++k) {
    const auto &from = robot.positions[2 * k], &to = robot.positions[2 * k + 1];
    for (int step = 0; step < 50; ++step) {
      std::vector<double> q(from);
      for (std::size_t j = 0; j < q.size(); ++j) q[j] += step / 49.0 * (to[j] - from[j]);
      states.emplace_back();
      robot.robot->forwardKinematics(q, states.back());
    }
  }
  return states;
}

/// self_apart: the links where nothing is near another, so that what is left is what any check
/// costs.
const std::vector<std::vector<Eigen::Isometry3d>>& statesOf(const BenchmarkRobot& robot,
                                                            const std::string& query) {
  static std::map<std::string, std::vector<std::vector<Eigen::Isometry3d>>> made;
  if (query != "self_apart" && query != "way_hulls") return robot.states;
  auto& states = made[robot.name + query];
  if (!states.empty()) return states;
  if (query == "way_hulls") return states = motionsOf(robot);
  states = robot.states;
  for (auto& X_RB : states) {
    for (std::size_t i = 0; i < X_RB.size(); ++i) {
      X_RB[i].translation() += 10.0 * static_cast<double>(i) * Eigen::Vector3d(1.0, 0.7, 0.3);
    }
  }
  return states;
}

Check ofMoveItLoop(const BenchmarkRobot& robot, const std::string& query) {
  const auto loop = std::make_shared<MoveItLoop>(robot);
  const auto& states = statesOf(robot, query);
  const bool is_yes_or_no =
      query == "self" || query == "self_asked" || query == "self_selected" || query == "self_apart" || query == "self_hulls" || query == "way_hulls";
  if (is_yes_or_no) return [=, &states](std::size_t i) { return loop->selfCollides(states[i]); };
  if (query == "self_contacts") {
    return
        [=, &states](std::size_t i) { return static_cast<double>(loop->selfContacts(states[i])); };
  }
  if (query == "self_distance") {
    return [=, &states](std::size_t i) { return loop->selfDistance(states[i]); };
  }
  if (query == "world") return [=, &states](std::size_t i) { return loop->collides(states[i]); };
  return [=, &states](std::size_t i) { return loop->worldDistance(states[i]); };
}

Check withNarrowPhase(const BenchmarkRobot& robot, const std::string& query,
                      NarrowPhaseMethod narrow_phase) {
  bool with_world = query == "world" || query == "world_distance";
  SceneDescription description;
  description.robots.push_back({robot.robot, robot.srdf, ""});
  const bool asks = query == "self_asked";  // the SRDF as a predicate
  const auto matrix = asks ? CollisionScene::build(description) : nullptr;
  if (asks) description.robots[0].srdf = Srdf{};
  if (query == "self_selected") with_world = true;
  if (with_world) description.world = robot.world;
  description.check_self = query != "world_distance";
  description.settings.narrow_phase = narrow_phase;
  const auto scene = CollisionScene::build(description);
  const auto detector = std::make_shared<CollisionDetector>(scene);
  const auto& states = statesOf(robot, query);
  auto poses = std::make_shared<std::vector<BodyPoses>>(states.size());
  for (std::size_t i = 0; i < states.size(); ++i) scene->gatherPoses(states[i], (*poses)[i]);
  CheckSettings settings;
  settings.alarm_distance = 0.0;
  settings.min_distance = query == "self_distance" || query == "world_distance";
  const bool by_hulls = query == "self_hulls" || query == "way_hulls";
  if (by_hulls) settings.fidelity = Fidelity::CONVEX;
  settings.verdict_only = by_hulls || query == "self" || asks || query == "self_selected" || query == "world" || query == "self_apart";
  if (query == "self_selected") {
    settings.selection =
        std::make_shared<PairSelection>(scene, Restriction{}, PairSelection::Among::SELF);
  }
  if (asks) {
    auto rules = std::make_shared<std::vector<std::vector<char>>>();
    for (const CollisionModel& a : scene->models()) {
      rules->emplace_back();
      for (const CollisionModel& b : scene->models()) {
        const int first = matrix->findModel(a.name), second = matrix->findModel(b.name);
        rules->back().push_back(first < 0 || second < 0 || !matrix->filter().allowed(first, second));
      }
    }
    settings.may_ignore = [rules](std::uint32_t a, std::uint32_t b) { return (*rules)[a][b] != 0; };
  }
  return [=](std::size_t i) { return detector->detect((*poses)[i], settings).min_distance; };
}

Check ofCollisionPairs(const BenchmarkRobot& robot, const std::string& query) {
  return withNarrowPhase(robot, query, NarrowPhaseMethod::NATIVE);
}

Check ofCollisionPairsWithFcl(const BenchmarkRobot& robot, const std::string& query) {
  return withNarrowPhase(robot, query, NarrowPhaseMethod::FCL);
}

void registerAll() {
  for (const BenchmarkRobot& robot : benchmarkRobots()) {
    for (const std::string query : QUERIES) {
      for (const auto& [who, make] : {std::pair{"CollisionPairs", &ofCollisionPairs},
                                      std::pair{"CollisionPairsWithFcl", &ofCollisionPairsWithFcl},
                                      std::pair{"MoveItLoop", &ofMoveItLoop}}) {
        const std::string name = std::string("BM_") + who + "/" + robot.name + "/" + query;
        benchmark::RegisterBenchmark(name.c_str(),
                                     [&robot, query, make = make](auto& state) {
                                       run(state, statesOf(robot, query).size(),
                                           make(robot, query));
                                     })
            ->Unit(benchmark::kMillisecond)
            ->Iterations(1);
      }
    }
  }
}

}  // namespace
}  // namespace collision_pairs

int main(int argc, char** argv) {
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 1;
  collision_pairs::registerAll();
  benchmark::RunSpecifiedBenchmarks();
  return 0;
}
