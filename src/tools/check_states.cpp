// check_states: recorded joint states in, a verdict for each out. Needs no roscore.
#include <atomic>
#include <iostream>
#include <memory>
#include <optional>
#include <string>

#include "collision_pairs/batch_check.h"
#include "collision_pairs/input_error.h"
#include "csv.h"
#include "progress_bar.h"
#include "scene_files.h"
#include "text_files.h"
#include "user_text.h"

namespace collision_pairs {
namespace {

struct Options {
  std::string states, out;
  SceneOptions scene;
  CheckSettings settings;
  double time_budget = 0.0;  // µs
  unsigned threads = 0;
  Options() {
    settings.alarm_distance = 0.0;
    settings.stage_times = true;
  }
};

void declare(CommandLine& command_line, Options& options) {
  declareRobot(command_line, options.scene);
  declareBroadPhase(command_line, options.scene);
  command_line.requiredOption("states", options.states, "STATES.csv",
                              "header with joint names, one row per state");
  command_line.metres("alarm-distance", options.settings.alarm_distance,
                      "boxes closer than this are investigated");
  command_line.metres("tolerance", options.settings.tolerance,
                      "distances may be too small by up to this; contact or not stays exact");
  command_line.option("time-budget", options.time_budget, "MICROSECONDS",
                      "time limit per state; an unresolved pair counts as a contact unless its "
                      "lower bound is positive");
  command_line.option("max-hull-vertices", options.scene.max_hull_vertices, "COUNT",
                      "limit for the hulls of --fidelity convex; 0: as in --settings");
  command_line.flag("min-distance", options.settings.min_distance,
                    "find the smallest signed distance");
  command_line.flag("verdict-only", options.settings.verdict_only,
                    "only the verdict; stops at the first contact, the only pair listed");
  declareBatch(command_line, options.threads, options.out);
}

std::string contactPairs(const CollisionReport& report, const CollisionScene& scene) {
  std::vector<std::string> pairs;
  for (const PairReport& pair : report.pairs) {
    if (pair.distance > 0.0) continue;  // near, or unresolved and known to be apart
    pairs.push_back(listedPair(scene, pair.first, pair.second));
  }
  return csvField(joined(pairs, ";"));
}

std::string rowOf(std::size_t state, const CollisionReport& report, const CollisionScene& scene,
                  const CheckSettings& settings) {
  const bool is_bound =
      report.min_distance_is_bound || (settings.verdict_only && report.in_collision);
  const bool has_distance = settings.min_distance && !is_bound;
  const std::string nb_pairs =
      settings.verdict_only ? "" : std::to_string(report.candidates.size());  // not counted
  return std::to_string(state) + (report.in_collision ? ",1," : ",0,") +
         contactPairs(report, scene) + ',' + (has_distance ? allDigits(report.min_distance) : "") +
         ',' + nb_pairs + ',' + formatted("%.1f", 1e6 * report.times.total) + '\n';
}

void refuseLeftOut(std::size_t state, const CollisionReport& report, const CollisionScene& scene) {
  if (report.left_out.empty()) return;
  throw InputError("state " + std::to_string(state) + ": link " +
                   whyNoBox(scene.models()[report.left_out.front()].name));
}

/// One row per state, in order.
std::vector<std::string> check(const JointStates& states,
                               const std::shared_ptr<const CollisionScene>& scene,
                               const CheckSettings& settings, const CloudVoxels& voxels,
                               unsigned threads) {
  std::vector<std::string> rows(states.positions.size());
  std::atomic<std::uint64_t> nb_answered_natively{0};
  BatchCheck batch(scene, threads);
  ProgressBar bar("states", rows.size());
  batch.runJoints(
      rows.size(), settings,
      [&](std::size_t i, std::vector<double>& positions) { positions = states.positions[i]; },
      voxels,
      [&](std::size_t i, const CollisionReport& report) {
        refuseLeftOut(i, report, *scene);
        rows[i] = rowOf(i, report, *scene, settings);
        nb_answered_natively += report.nb_answered_natively;
        bar.countOne();
      });
  if (nb_answered_natively > 0) {
    warn(std::to_string(nb_answered_natively) +
         " queries of pairs of elements were answered natively, wholly or partly, because FCL does "
         "not support them");
  }
  return rows;
}

void checkAll(Options& options) {
  CheckSettings& settings = options.settings;
  settings.fidelity = parseFidelity(options.scene.fidelity);
  settings.broad_phase = parseBroadPhase(options.scene.broad_phase);
  if (!(options.time_budget >= 0.0)) {
    throw InputError("--time-budget must be a number of microseconds, 0 or more");
  }
  settings.time_budget = 1e-6 * options.time_budget;
  const auto scene = buildScene(options.scene, settings.fidelity);
  const JointStates states =
      readJointStates(readTextFile(options.states), scene->robot(), options.states);
  if (states.positions.empty()) throw InputError(options.states + ": it has no states");
  warnOf(states, scene->robot(), "state");
  const CloudVoxels voxels = readCloud(options.scene, *scene);
  const std::vector<std::string> rows = check(states, scene, settings, voxels, options.threads);
  writeTextFile(options.out, [&](std::ostream& out) {
    out << "state,in_collision,pairs,min_distance,nb_pairs,microseconds\n";
    for (const std::string& row : rows) out << row;
  });
}

}  // namespace
}  // namespace collision_pairs

int main(int argc, char** argv) {
  using namespace collision_pairs;
  return runTool(argc, argv,
                 {"check_states", "Checks recorded joint states of a robot for collisions."},
                 declare, checkAll);
}
