// What a cheaper geometry costs in accuracy and saves in time, and what a time budget buys.
//
//   COLLISION_PAIRS_SHARED=DATA trade_off RUNGS.csv BUDGETS.csv
//
// A state's time is the least of its repetitions, forward kinematics not counted. All rows are of
// the detector at its default alarm distance, but for "triangles": every candidate straight at its
// triangles, without a coarser geometry asked first as ~fidelity mesh does ("mesh", and "mesh 1 mm"
// with that tolerance), and "spheres, many": a state's share of a batch of
// verdicts, forward kinematics counted.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <fstream>
#include <iostream>
#include <limits>
#include <map>
#include <numeric>

#include "collision_pairs/batch_check.h"
#include "collision_pairs/collision_detector.h"
#include "demo_motion.h"
#include "pair_ladder.h"

namespace collision_pairs {
namespace {

constexpr int PASSES = 7, BUDGET_PASSES = 20;
constexpr double ALL_NEAR = 0.5;  // m: within this the exact distances of all pairs are known
constexpr double SLACK = 200e-6;  // s: what a check may take beyond its budget and a narrow query

using Microseconds = std::chrono::duration<double, std::micro>;
using Distances = std::map<std::pair<std::uint32_t, std::uint32_t>, double>;

double quantile(std::vector<double> values, double share) {
  if (values.empty()) return 0.0;
  std::sort(values.begin(), values.end());
  return values[std::min(values.size() - 1,
                         static_cast<std::size_t>(share * static_cast<double>(values.size())))];
}

/// A robot in all its states, with a scene and what it is asked.
struct Question {
  const BenchmarkRobot& robot;
  std::string name;  ///< self, world (and self), self_distance, world_distance
  std::vector<BodyPoses> poses;

  bool withWorld() const { return name.rfind("world", 0) == 0; }
  bool ofDistance() const { return name.find("distance") != std::string::npos; }
  std::shared_ptr<const CollisionScene> scene(int max_hull_vertices) const {
    SceneSettings settings;
    settings.max_hull_vertices = max_hull_vertices;
    return CollisionScene::build(robot.robot, robot.srdf, withWorld() ? robot.world : nullptr,
                                 settings);
  }
  CheckSettings settings(Fidelity fidelity) const {
    CheckSettings settings;
    settings.fidelity = fidelity;
    settings.stage_times = true;
    settings.min_distance = ofDistance();
    if (ofDistance()) settings.alarm_distance = 0.0;
    return settings;
  }
};

Question ask(const BenchmarkRobot& robot, const std::string& name) {
  Question question{robot, name, {}};
  const auto scene = question.scene(0);
  for (const auto& X_RB : robot.states) {
    question.poses.emplace_back();
    scene->gatherPoses(X_RB, question.poses.back());
  }
  return question;
}

/// What is exact of each state.
struct Truth {
  bool in_collision;
  double min_distance;
  Distances distances;
};

Distances distancesOf(const CollisionReport& report) {
  Distances distances;
  for (const PairReport& pair : report.pairs) {
    distances[{pair.first, pair.second}] = pair.distance;
  }
  return distances;
}

std::vector<Truth> truthOf(const Question& question) {
  CollisionDetector detector(question.scene(0));
  CheckSettings settings;
  settings.alarm_distance = ALL_NEAR;
  settings.min_distance = true;
  std::vector<Truth> truth;
  for (const BodyPoses& poses : question.poses) {
    const CollisionReport& report = detector.detect(poses, settings);
    truth.push_back({report.in_collision, report.min_distance, distancesOf(report)});
  }
  return truth;
}

struct Row {
  std::vector<double> least, errors;
  int false_alarms = 0, misses = 0;

  void time(std::size_t state, double microseconds) {
    least[state] = std::min(least[state], microseconds);
  }
  /// Errors are of distances between bodies that are apart: by how much nearer they are said to
  /// be.
  void judge(const CollisionReport& report, const Truth& truth, bool of_distance) {
    false_alarms += report.in_collision && !truth.in_collision ? 1 : 0;
    misses += truth.in_collision && !report.in_collision ? 1 : 0;
    if (of_distance) {
      if (truth.min_distance > 0.0) addError(truth.min_distance, report.min_distance);
      return;
    }
    for (const auto& [pair, distance] : distancesOf(report)) {
      const auto exact = truth.distances.find(pair);
      const double known = exact == truth.distances.end() ? ALL_NEAR : exact->second;
      if (known > 0.0) addError(known, distance);
    }
  }
  void addError(double exact, double said) {
    errors.push_back(std::abs(exact - std::max(said, 0.0)));
  }
};

Row measure(const Question& question, const std::vector<Truth>& truth, Fidelity fidelity,
            int max_hull_vertices, double tolerance = 0.0) {
  CollisionDetector detector(question.scene(max_hull_vertices));
  CheckSettings settings = question.settings(fidelity);
  settings.tolerance = tolerance;
  Row row;
  row.least.assign(question.poses.size(), std::numeric_limits<double>::infinity());
  for (int pass = 0; pass < PASSES; ++pass) {
    for (std::size_t i = 0; i < question.poses.size(); ++i) {
      const auto start = std::chrono::steady_clock::now();
      const CollisionReport& report = detector.detect(question.poses[i], settings);
      row.time(i, Microseconds(std::chrono::steady_clock::now() - start).count());
      if (pass == 0) row.judge(report, truth[i], question.ofDistance());
    }
  }
  return row;
}

/// Verdicts at SPHERES of so many states that the batch stage is worth it; the states again and
/// again.
void writeBatch(const Question& question, const std::vector<Truth>& truth, std::ostream& out) {
  const auto& states = question.robot.positions;
  const std::size_t nb_rounds = BatchCheck::STATES_WORTH_A_STAGE / states.size() + 1;
  const std::size_t count = nb_rounds * states.size();
  BatchCheck batch(question.scene(0), 1);
  CheckSettings settings;
  settings.fidelity = Fidelity::SPHERES;
  settings.verdict_only = true;
  std::vector<char> in_collision(states.size());
  double least = std::numeric_limits<double>::infinity();
  for (int pass = 0; pass < PASSES + 1; ++pass) {  // the first makes it ready
    const auto start = std::chrono::steady_clock::now();
    batch.runJoints(
        count, settings,
        [&](std::size_t i, std::vector<double>& q) { q = states[i % states.size()]; }, {},
        [&](std::size_t i, const CollisionReport& report) {
          in_collision[i % states.size()] = report.in_collision;
        });
    const double took = Microseconds(std::chrono::steady_clock::now() - start).count();
    if (pass > 0) least = std::min(least, took / static_cast<double>(count));
  }
  double false_alarms = 0.0, misses = 0.0;
  for (std::size_t i = 0; i < states.size(); ++i) {
    false_alarms += in_collision[i] && !truth[i].in_collision ? 1.0 : 0.0;
    misses += truth[i].in_collision && !in_collision[i] ? 1.0 : 0.0;
  }
  const auto nb_states = static_cast<double>(states.size());
  out << question.robot.name << ',' << question.name << ",\"spheres, many\"," << least << ",,"
      << false_alarms / nb_states << ',' << misses / nb_states << ",," << std::endl;
}

/// The detector's candidates, each straight at its triangles.
class StraightToMesh {
 public:
  explicit StraightToMesh(const Question& question)
      : settings_(question.settings(Fidelity::AABB)),
        scene_(question.scene(0)),
        detector_(scene_),
        X_WE_(scene_->elements().size()) {
    settings_.list_boxes = true;
  }

  /// Boxes and sweep, without the queries: µs.
  double begin(const BodyPoses& poses) {
    const CollisionReport& report = detector_.detect(poses, settings_);
    for (std::size_t i = 0; i < X_WE_.size(); ++i) {
      const SceneElement& element = scene_->elements()[i];
      X_WE_[i] = element.body < 0 ? element.X_BE : poses.X_WB[element.body] * element.X_BE;
    }
    ladder_.begin(*scene_, X_WE_, report.boxes);
    return 1e6 * (report.times.total - report.times.narrow_phase);
  }

  /// µs of each query.
  const std::vector<double>& queries() {
    took_.clear();
    for (const BoxPair& pair : detector_.report().candidates) {
      const auto start = std::chrono::steady_clock::now();
      ladder_.measure(ladder_.byModel(pair), Fidelity::MESH, settings_.alarm_distance);
      took_.push_back(Microseconds(std::chrono::steady_clock::now() - start).count());
    }
    return took_;
  }

 private:
  CheckSettings settings_;
  std::shared_ptr<const CollisionScene> scene_;
  CollisionDetector detector_;
  PairLadder ladder_;
  std::vector<Eigen::Isometry3d> X_WE_;
  std::vector<double> took_;
};

/// The time of the candidates' triangles comes in place of the detector's narrow phase.
Row measureStraight(const Question& question, const std::vector<Truth>& truth) {
  Row row = measure(question, truth, Fidelity::MESH, 0);
  std::fill(row.least.begin(), row.least.end(), std::numeric_limits<double>::infinity());
  StraightToMesh straight(question);
  for (int pass = 0; pass < PASSES; ++pass) {
    for (std::size_t i = 0; i < question.poses.size(); ++i) {
      const double boxes = straight.begin(question.poses[i]);
      const auto& queries = straight.queries();
      row.time(i, std::accumulate(queries.begin(), queries.end(), boxes));
    }
  }
  return row;
}

void write(std::ostream& out, const Question& question, const std::string& rung, const Row& row) {
  const auto count = static_cast<double>(row.least.size());
  out << question.robot.name << ',' << question.name << ',' << rung << ','
      << quantile(row.least, 0.5) << ',' << quantile(row.least, 0.99) << ','
      << row.false_alarms / count << ',' << row.misses / count << ',' << quantile(row.errors, 0.5)
      << ',' << quantile(row.errors, 1.0) << std::endl;
}

void writeRungs(const BenchmarkRobot& robot, std::ostream& out) {
  for (const std::string name : {"self", "world", "self_distance", "world_distance"}) {
    const Question question = ask(robot, name);
    if (question.withWorld() && !robot.world) continue;
    const std::vector<Truth> truth = truthOf(question);
    if (!question.ofDistance()) writeBatch(question, truth, out);
    write(out, question, "spheres", measure(question, truth, Fidelity::SPHERES, 0));
    write(out, question, "aabb", measure(question, truth, Fidelity::AABB, 0));
    write(out, question, "obb", measure(question, truth, Fidelity::OBB, 0));
    for (const int vertices : {16, 32, 64}) {
      write(out, question, "convex" + std::to_string(vertices),
            measure(question, truth, Fidelity::CONVEX, vertices));
    }
    write(out, question, "convex", measure(question, truth, Fidelity::CONVEX, 0));
    write(out, question, "mesh", measure(question, truth, Fidelity::MESH, 0));
    for (const char* millimetres : {"0.1", "1", "5", "20"}) {
      write(out, question, std::string("mesh ") + millimetres + " mm",
            measure(question, truth, Fidelity::MESH, 0, 1e-3 * std::stod(millimetres)));
    }
    if (!question.ofDistance()) write(out, question, "triangles", measureStraight(question, truth));
  }
}

/// By state: µs of its longest narrow query, the least of its repetitions.
std::vector<double> longestQueries(const Question& question) {
  StraightToMesh straight(question);
  std::vector<double> longest;
  for (const BodyPoses& poses : question.poses) {
    straight.begin(poses);
    double least = std::numeric_limits<double>::infinity();
    for (int pass = 0; pass < PASSES; ++pass) {
      double of_pass = 0.0;
      for (const double took : straight.queries()) of_pass = std::max(of_pass, took);
      least = std::min(least, of_pass);
    }
    longest.push_back(least);
  }
  return longest;
}

void writeBudget(const Question& question, const std::vector<Truth>& truth,
                 const std::vector<double>& longest_query, double microseconds, std::ostream& out) {
  CollisionDetector detector(question.scene(0));
  CheckSettings settings = question.settings(Fidelity::MESH);
  settings.time_budget = 1e-6 * microseconds;
  int resolved = 0, false_alarms = 0, misses = 0, late = 0, count = 0;
  double open_pairs = 0.0;
  std::vector<double> took;
  for (int pass = 0; pass < BUDGET_PASSES; ++pass) {
    for (std::size_t i = 0; i < question.poses.size(); ++i, ++count) {
      const auto start = std::chrono::steady_clock::now();
      const CollisionReport& report = detector.detect(question.poses[i], settings);
      took.push_back(Microseconds(std::chrono::steady_clock::now() - start).count());
      resolved += report.budget_spent ? 0 : 1;
      open_pairs += report.nb_unresolved;
      false_alarms += report.in_collision && !truth[i].in_collision ? 1 : 0;
      misses += truth[i].in_collision && !report.in_collision ? 1 : 0;
      late += took.back() > microseconds + 1e6 * SLACK + longest_query[i] ? 1 : 0;
    }
  }
  const double all = count;
  out << microseconds << ',' << resolved / all << ',' << open_pairs / all << ','
      << false_alarms / all << ',' << misses / all << ',' << late / all << ','
      << quantile(took, 0.5) << ',' << quantile(took, 0.99) << ',' << quantile(took, 0.999)
      << std::endl;
}

void writeBudgets(const BenchmarkRobot& robot, std::ostream& out) {
  const Question question = ask(robot, "world");
  const std::vector<Truth> truth = truthOf(question);
  const std::vector<double> longest_query = longestQueries(question);
  for (const double microseconds : {20.0, 50.0, 100.0, 500.0}) {
    writeBudget(question, truth, longest_query, microseconds, out);
  }
}

}  // namespace
}  // namespace collision_pairs

int main(int argc, char** argv) {
  using namespace collision_pairs;
  if (argc != 3) {
    std::cerr << "usage: trade_off RUNGS.csv BUDGETS.csv\n";
    return 2;
  }
  std::ofstream rungs(argv[1]), budgets(argv[2]);
  rungs << "robot,query,rung,median_us,p99_us,false_alarm_share,miss_share,error_median,"
           "error_max\n";
  budgets << "budget_us,resolved_share,unresolved_pairs_mean,false_alarm_share,miss_share,"
             "late_share,median_us,p99_us,p999_us\n";
  writeRungs(demoRobot(), rungs);
  for (const BenchmarkRobot& robot : benchmarkRobots()) {
    writeRungs(robot, rungs);
    if (robot.name == "pr2") writeBudgets(robot, budgets);
  }
  return rungs && budgets ? 0 : 1;
}
