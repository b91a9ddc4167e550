// check_bag: recorded bags in, a verdict for each stamp out. Needs no roscore.
#include <memory>
#include <string>

#include "bag_checker.h"
#include "bag_index.h"
#include "bag_outputs.h"
#include "bag_recorder.h"
#include "collision_pairs/input_error.h"
#include "scene_config.h"
#include "scene_files.h"
#include "user_text.h"

namespace collision_pairs {
namespace {

struct Options {
  BagCheckOptions check;
  std::string record, shard_text, max_gap, given;
  BagOutputOptions output;
};

void declare(CommandLine& command_line, Options& options) {
  command_line.operands(options.check.bags, "BAG...", "the bags to check");
  command_line.input("urdf", options.check.scene.urdf, "ROBOT.urdf",
                     "the robot (default: the scenes of a node in the bag, or robot_description)");
  command_line.input("srdf", options.check.scene.srdf, "ROBOT.srdf",
                     "pairs that it disables are not checked (default: robot_description_semantic "
                     "in the bag, if any)");
  declareScene(command_line, options.check.scene);
  command_line.option(
      "clouds", options.check.scene.cloud_topics, "TOPIC...",
      "topics of sensor_msgs/PointCloud2 in the bag that are obstacles; parameters in --settings");
  command_line.option("scene", options.check.scene_topic, "TOPIC",
                      "of several topics of collision_pairs/Scene in the bag, the one to check");
  command_line.option("prefix", options.check.replay.prefix, "PREFIX",
                      "prefix of this robot's names in the bag");
  declareFidelity(command_line, options.check.scene);
  declareBroadPhase(command_line, options.check.scene);
  command_line.metres("alarm-distance", options.output.alarm_distance,
                      "pairs within this distance are reported");
  command_line.metres("tolerance", options.check.settings.tolerance,
                      "distances may be too small by up to this; contact or not stays exact");
  command_line.flag("min-distance", options.check.settings.min_distance,
                    "find the smallest distance even beyond the alarm distance");
  command_line.flag(
      "verdict-only", options.check.settings.verdict_only,
      "only free, collision or unknown; stops at the first contact, the only pair listed");
  command_line.option("max-gap", options.max_gap, "SECONDS",
                      "poses are unknown in longer gaps (default: 1, or as in --settings)");
  command_line.output("out", options.output.out, "OUT.csv",
                      "output table (default: standard output)");
  command_line.output("report", options.output.report, "DIR",
                      "write a report page to this folder: index.html", "/index.html");
  command_line.output("record", options.record, "OUT.bag",
                      "write reports and markers for rviz to a bag");
  command_line.option("shard", options.shard_text, "I/N",
                      "check only part I of N (1 to N); merge_bag_checks merges the parts");
  command_line.givenOptions(options.given, "shard");
}

/// --max-gap stands for both ages.
void takeLimits(Options& options) {
  if (!options.check.scene.settings.empty()) {
    const SceneConfig config = readSceneConfigFile(options.check.scene.settings);
    options.check.replay.limits = config.pose_limits;
  }
  if (!options.max_gap.empty()) {
    double seconds = 0.0;
    requireGap(parseNumber(options.max_gap, seconds) ? seconds : 0.0);
    options.check.has_limits = true;
    options.check.replay.limits.max_pose_age = options.check.replay.limits.max_transform_age =
        seconds;
  }
  options.output.max_gap = options.check.replay.limits.max_transform_age;
}

void complete(Options& options) {
  options.check.settings.fidelity = parseFidelity(options.check.scene.fidelity);
  options.check.settings.broad_phase = parseBroadPhase(options.check.scene.broad_phase);
  options.check.settings.alarm_distance = options.output.alarm_distance;
  options.check.settings.list_boxes = true;  // for nb_pairs
  options.check.settings.stage_times = !options.record.empty();
  takeLimits(options);
  if (!options.shard_text.empty()) {
    const auto shard = shardFrom(options.shard_text);
    if (!shard) {
      throw InputError("--shard " + options.shard_text +
                       ": must be I/N with I from 1 to N, such as 2/4");
    }
    options.check.shard = *shard;
  }
  options.output.quiet = !options.record.empty();
  if (options.check.shard.count > 1 && !(options.record.empty() && options.output.report.empty())) {
    throw InputError(
        "--shard cannot be combined with --record or --report; give --report to merge_bag_checks");
  }
  for (const std::string& bag : options.check.bags) {
    if (bag.find_first_of("\n\r") != std::string::npos) {
      throw InputError("'" + bag + "': rename it; a line break in its name would break the table");
    }
    requireFile(bag);  // before hours are spent on those before it
  }
}

void checkAll(Options& options) {
  complete(options);
  std::unique_ptr<BagRecorder> recorder;
  if (!options.record.empty()) recorder = std::make_unique<BagRecorder>(options.record);
  writeBagOutputs(options.output, [&](const BagLineSink& sink) {
    const bool is_part = options.check.shard.count > 1;
    if (is_part) sink(partLine(options.check.shard, options.given), nullptr);
    BagChecker checker(options.check, sink, recorder.get());
    for (std::size_t i = 0; i < options.check.bags.size(); ++i) checker.check(i);
    if (is_part) sink(BAG_TABLE_END, nullptr);
  });
  if (recorder) recorder->finish();
}

}  // namespace
}  // namespace collision_pairs

int main(int argc, char** argv) {
  using namespace collision_pairs;
  return runTool(argc, argv,
                 {"check_bag", "Checks the motion of a robot in recorded bags for collisions."},
                 declare, checkAll);
}
