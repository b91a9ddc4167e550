// check_motion: waypoints in, whether the straight motions between them are free. Needs no roscore.
#include <cmath>
#include <cstdio>
#include <ostream>
#include <string>

#include "collision_pairs/input_error.h"
#include "collision_pairs/motion_check.h"
#include "csv.h"
#include "progress_bar.h"
#include "scene_files.h"
#include "text_files.h"
#include "tool.h"

namespace collision_pairs {
namespace {

struct Options {
  std::string robot, waypoints, srdf, out;
  SceneOptions scene;
  std::string fidelity = "mesh";
  MotionSettings settings;
  unsigned threads = 0;
};

void declare(CommandLine& command_line, Options& options) {
  declareRobot(command_line, options.robot, options.srdf, options.scene, options.fidelity);
  command_line.requiredOption("waypoints", options.waypoints, "WAYPOINTS.csv",
                              "header with joint names, one row per waypoint; consecutive rows are "
                              "joined by straight lines in joint space");
  command_line.option("clearance", options.settings.clearance, "METRES",
                      "free means that no pair comes nearer than this");
  command_line.option("resolution", options.settings.resolution, "METRES",
                      "pairs that remain undecided down to motions of this size are unresolved");
  declareBatch(command_line, options.threads, options.out);
}

void refuseWrong(const MotionSettings& settings) {
  if (!(settings.clearance >= 0.0) || !std::isfinite(settings.clearance)) {
    throw InputError("--clearance must be a finite number of metres, 0 or more");
  }
  if (!(settings.resolution > 0.0) || !std::isfinite(settings.resolution)) {
    throw InputError("--resolution must be a finite number of metres, more than 0");
  }
}

const char* verdictName(Verdict verdict) {
  if (verdict == Verdict::FREE) return "free";
  return verdict == Verdict::COLLISION ? "collision" : "unresolved";
}

void writeRow(std::size_t segment, const MotionReport& report, const CollisionScene& scene,
              std::ostream& out) {
  char clearance[64] = "", contact_at[64] = "", free_until[64], microseconds[64];
  if (report.verdict == Verdict::FREE && std::isfinite(report.clearance)) {
    std::snprintf(clearance, sizeof clearance, "%.17g", report.clearance);
  }
  if (report.verdict == Verdict::COLLISION) {
    std::snprintf(contact_at, sizeof contact_at, "%.17g", report.contact_at);
  }
  std::snprintf(free_until, sizeof free_until, "%.17g", report.free_until);
  std::snprintf(microseconds, sizeof microseconds, "%.1f", 1e6 * report.seconds);
  out << segment << ',' << verdictName(report.verdict) << ',' << clearance << ',' << contact_at
      << ',' << free_until << ',';
  std::string pairs;
  for (const auto& [first, second] : report.pairs) {
    pairs += (pairs.empty() ? "" : ";") + listedPair(scene, first, second);
  }
  out << csvField(pairs) << ',' << report.nb_checks << ',' << microseconds << '\n';
}

void checkAll(Options options) {
  refuseWrong(options.settings);
  options.settings.fidelity = parseFidelity(options.fidelity);
  options.settings.from_start = true;
  const auto scene =
      buildScene(options.robot, options.srdf, options.scene, options.settings.fidelity, 0);
  const JointStates waypoints =
      readJointStates(readTextFile(options.waypoints), scene->robot(), options.waypoints);
  if (waypoints.positions.size() < 2) {
    throw InputError(options.waypoints + ": " + std::to_string(waypoints.positions.size()) +
                     " waypoints; a motion needs two or more (check_states checks one)");
  }
  warnOf(waypoints, scene->robot(), "waypoint");
  ProgressBar bar("segments", waypoints.positions.size() - 1);
  SegmentOptions how;
  how.threads = options.threads;
  how.voxels = readCloud(options.scene, *scene);
  how.done = [&](std::size_t nb_done) { bar.show(nb_done); };
  const auto reports = checkSegments(scene, waypoints.positions, options.settings, how);
  writeTextFile(options.out, [&](std::ostream& out) {
    out << "segment,verdict,clearance,contact_at,free_until,pairs,nb_checks,microseconds\n";
    for (std::size_t i = 0; i < reports.size(); ++i) writeRow(i, reports[i], *scene, out);
  });
}

}  // namespace
}  // namespace collision_pairs

int main(int argc, char** argv) {
  collision_pairs::Options options;
  collision_pairs::CommandLine command_line(
      "check_motion",
      "Certifies the straight motions between waypoints of a robot, or finds a contact.");
  collision_pairs::declare(command_line, options);
  return collision_pairs::runTool(command_line, argc, argv,
                                  [&] { collision_pairs::checkAll(options); });
}
