// check_motion: waypoints in, whether the straight motions between them are free. Needs no roscore.
#include <cmath>
#include <ostream>
#include <string>

#include "collision_pairs/input_error.h"
#include "collision_pairs/motion_check.h"
#include "csv.h"
#include "progress_bar.h"
#include "scene_files.h"
#include "text_files.h"
#include "user_text.h"

namespace collision_pairs {
namespace {

struct Options {
  std::string waypoints, out;
  SceneOptions scene;
  MotionSettings settings;
  unsigned threads = 0;
};

void declare(CommandLine& command_line, Options& options) {
  declareRobot(command_line, options.scene);
  command_line.requiredOption("waypoints", options.waypoints, "WAYPOINTS.csv",
                              "header with joint names, one row per waypoint; consecutive rows are "
                              "joined by straight lines in joint space");
  command_line.metres("clearance", options.settings.clearance,
                      "free means that no pair comes nearer than this");
  command_line.option("resolution", options.settings.resolution, "METRES",
                      "pairs that remain undecided down to motions of this size are unresolved");
  declareBatch(command_line, options.threads, options.out);
}

const char* verdictName(Verdict verdict) {
  if (verdict == Verdict::FREE) return "free";
  return verdict == Verdict::COLLISION ? "collision" : "unresolved";
}

void writeRow(std::size_t segment, const MotionReport& report, const CollisionScene& scene,
              std::ostream& out) {
  const bool has_clearance = report.verdict == Verdict::FREE && std::isfinite(report.clearance);
  std::vector<std::string> pairs;
  for (const auto& [first, second] : report.pairs) {
    pairs.push_back(listedPair(scene, first, second));
  }
  out << segment << ',' << verdictName(report.verdict) << ','
      << (has_clearance ? allDigits(report.clearance) : "") << ','
      << (report.verdict == Verdict::COLLISION ? allDigits(report.contact_at) : "") << ','
      << allDigits(report.free_until) << ',' << csvField(joined(pairs, ";")) << ','
      << report.nb_checks << ',' << formatted("%.1f", 1e6 * report.seconds) << '\n';
}

void checkAll(Options options) {
  if (!(options.settings.resolution > 0.0) || !std::isfinite(options.settings.resolution)) {
    throw InputError("--resolution must be a finite number of metres, more than 0");
  }
  options.settings.fidelity = parseFidelity(options.scene.fidelity);
  options.settings.from_start = true;
  const auto scene = buildScene(options.scene, options.settings.fidelity);
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
  using namespace collision_pairs;
  return runTool(
      argc, argv,
      {"check_motion",
       "Certifies the straight motions between waypoints of a robot, or finds a contact."},
      declare, checkAll);
}
