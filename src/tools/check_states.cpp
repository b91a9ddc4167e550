// check_states: recorded joint states in, a verdict for each out. Needs no roscore.
#include <atomic>
#include <cstdio>
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
#include "tool.h"

namespace collision_pairs {
namespace {

struct Options {
  std::string robot, states, srdf, out;
  SceneOptions scene;
  std::string fidelity = "mesh";
  double alarm_distance = 0.0, tolerance = 0.0;
  double time_budget = 0.0;  // µs
  int max_hull_vertices = 0;
  bool min_distance = false, verdict_only = false;
  unsigned threads = 0;
};

void declare(CommandLine& command_line, Options& options) {
  declareRobot(command_line, options.robot, options.srdf, options.scene, options.fidelity);
  command_line.requiredOption("states", options.states, "STATES.csv",
                              "header with joint names, one row per state");
  command_line.option("alarm-distance", options.alarm_distance, "METRES",
                      "boxes closer than this are investigated");
  command_line.option("tolerance", options.tolerance, "METRES",
                      "distances may be too small by up to this; contact or not stays exact");
  command_line.option("time-budget", options.time_budget, "MICROSECONDS",
                      "time limit per state; an unresolved pair counts as a contact unless its "
                      "lower bound is positive");
  command_line.option("max-hull-vertices", options.max_hull_vertices, "COUNT",
                      "limit for the hulls of --fidelity convex; 0: as in --settings");
  command_line.flag("min-distance", options.min_distance, "find the smallest signed distance");
  command_line.flag("verdict-only", options.verdict_only,
                    "only the verdict; stops at the first contact, the only pair listed");
  declareBatch(command_line, options.threads, options.out);
}

CheckSettings settingsFrom(const Options& options) {
  CheckSettings settings;
  settings.fidelity = parseFidelity(options.fidelity);
  if (!(options.alarm_distance >= 0.0) || !std::isfinite(options.alarm_distance)) {
    throw InputError("--alarm-distance must be a finite number of metres, 0 or more");
  }
  settings.alarm_distance = options.alarm_distance;
  if (!(options.tolerance >= 0.0) || !std::isfinite(options.tolerance)) {
    throw InputError("--tolerance must be a finite number of metres, 0 or more");
  }
  settings.tolerance = options.tolerance;
  if (!(options.time_budget >= 0.0)) {
    throw InputError("--time-budget must be a number of microseconds, 0 or more");
  }
  settings.time_budget = 1e-6 * options.time_budget;
  settings.min_distance = options.min_distance;
  settings.verdict_only = options.verdict_only;
  settings.stage_times = true;
  return settings;
}

std::string contactPairs(const CollisionReport& report, const CollisionScene& scene) {
  std::string text;
  for (const PairReport& pair : report.pairs) {
    if (pair.distance > 0.0) continue;  // near, or unresolved and known to be apart
    if (!text.empty()) text += ';';
    text += listedPair(scene, pair.first, pair.second);
  }
  return csvField(text);
}

std::string rowOf(std::size_t state, const CollisionReport& report, const CollisionScene& scene,
                  const CheckSettings& settings) {
  char distance[64] = "", microseconds[64];
  if (settings.min_distance && !report.min_distance_is_bound) {
    std::snprintf(distance, sizeof distance, "%.17g", report.min_distance);
  }
  std::snprintf(microseconds, sizeof microseconds, "%.1f", 1e6 * report.times.total);
  const std::string nb_pairs =
      settings.verdict_only ? "" : std::to_string(report.candidates.size());  // not counted
  return std::to_string(state) + (report.in_collision ? ",1," : ",0,") +
         contactPairs(report, scene) + ',' + distance + ',' + nb_pairs + ',' + microseconds + '\n';
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

void checkAll(const Options& options) {
  const CheckSettings settings = settingsFrom(options);
  const auto scene = buildScene(options.robot, options.srdf, options.scene, settings.fidelity,
                                options.max_hull_vertices);
  const JointStates states =
      readJointStates(readTextFile(options.states), scene->robot(), options.states);
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
  collision_pairs::Options options;
  collision_pairs::CommandLine command_line(
      "check_states", "Checks recorded joint states of a robot for collisions.");
  collision_pairs::declare(command_line, options);
  return collision_pairs::runTool(command_line, argc, argv,
                                  [&] { collision_pairs::checkAll(options); });
}
