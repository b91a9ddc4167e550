// check_bag: recorded bags in, a verdict for each stamp out. Needs no roscore.
#include <algorithm>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "bag_outputs.h"
#include "bag_poses.h"
#include "bag_recorder.h"
#include "cloud_replay.h"
#include "collision_pairs/collision_detector.h"
#include "collision_pairs/input_error.h"
#include "csv.h"
#include "progress_bar.h"
#include "scene_config.h"
#include "scene_files.h"
#include "text_files.h"
#include "user_text.h"

namespace collision_pairs {
namespace {

struct Options {
  std::vector<std::string> bags;
  std::string record, shard_text, max_gap, given;
  SceneOptions scene;
  BagPosesOptions poses;
  BagOutputOptions output;
  // Made of the above.
  Shard shard;
  PoseLimits limits;
  CheckSettings settings;
};

void declare(CommandLine& command_line, Options& options) {
  command_line.operands(options.bags, "BAG...", "the bags to check");
  command_line.option("urdf", options.scene.urdf, "ROBOT.urdf",
                      "the robot (default: robot_description in the bag)");
  command_line.option("srdf", options.scene.srdf, "ROBOT.srdf",
                      "pairs that it disables are not checked (default: robot_description_semantic "
                      "in the bag, if any)");
  declareScene(command_line, options.scene);
  command_line.option(
      "clouds", options.scene.cloud_topics, "TOPIC...",
      "topics of sensor_msgs/PointCloud2 in the bag that are obstacles; parameters in --settings");
  command_line.option("prefix", options.poses.prefix, "PREFIX",
                      "prefix of this robot's names in the bag");
  declareFidelity(command_line, options.scene);
  declareBroadPhase(command_line, options.scene);
  command_line.metres("alarm-distance", options.output.alarm_distance,
                      "pairs within this distance are reported");
  command_line.metres("tolerance", options.settings.tolerance,
                      "distances may be too small by up to this; contact or not stays exact");
  command_line.flag("min-distance", options.settings.min_distance,
                    "find the smallest distance even beyond the alarm distance");
  command_line.flag(
      "verdict-only", options.settings.verdict_only,
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
  if (!options.scene.settings.empty()) {
    const SceneConfig config = readSceneConfigFile(options.scene.settings);
    options.limits = config.pose_limits;
    options.poses.static_joints = config.static_joints;
  }
  if (!options.max_gap.empty()) {
    double seconds = 0.0;
    requireGap(parseNumber(options.max_gap, seconds) ? seconds : 0.0);
    options.limits.max_pose_age = options.limits.max_transform_age = seconds;
  }
  options.output.max_gap = options.limits.max_transform_age;
}

void complete(Options& options) {
  options.settings.fidelity = parseFidelity(options.scene.fidelity);
  options.settings.broad_phase = parseBroadPhase(options.scene.broad_phase);
  options.settings.alarm_distance = options.output.alarm_distance;
  options.settings.list_boxes = true;  // for nb_pairs
  options.settings.stage_times = !options.record.empty();
  takeLimits(options);
  if (!options.shard_text.empty()) {
    const auto shard = shardFrom(options.shard_text);
    if (!shard) {
      throw InputError("--shard " + options.shard_text +
                       ": must be I/N with I from 1 to N, such as 2/4");
    }
    options.shard = *shard;
  }
  options.output.quiet = !options.record.empty();
  if (options.shard.count > 1 && !(options.record.empty() && options.output.report.empty())) {
    throw InputError(
        "--shard cannot be combined with --record or --report; give --report to merge_bag_checks");
  }
  for (const std::string& bag : options.bags) {
    if (bag.find_first_of("\n\r") != std::string::npos) {
      throw InputError("'" + bag + "': rename it; a line break in its name would break the table");
    }
  }
}

BagRow toRow(const CollisionReport& report, const CollisionScene& scene) {
  BagRow row;
  for (const PairReport& pair : report.pairs) {
    row.pairs.push_back(
        {listedPair(scene, pair.first, pair.second), pair.distance, pair.state != PairState::NEAR});
  }
  if (!report.min_distance_is_bound) row.min_distance = report.min_distance;
  row.nb_pairs = report.candidates.size();
  for (const std::uint32_t model : report.left_out) {
    row.left_out.push_back(listedName(scene.models()[model].name));
  }
  row.verdict = report.verdict;
  return row;
}

/// As a line of the table may list them.
std::string lineOf(std::vector<std::string> reasons) {
  constexpr std::size_t MAX_NAMED = 10;  // left_out names all links
  if (reasons.size() > MAX_NAMED) {
    reasons.resize(MAX_NAMED);
    reasons.push_back("and more");
  }
  std::string text = joined(reasons, "; ");
  std::replace(text.begin(), text.end(), '\n', ' ');
  return text;
}

class BagChecker {
 public:
  BagChecker(const Options& options, const BagLineSink& sink, BagRecorder* recorder)
      : options_(options), sink_(sink), recorder_(recorder), scenes_(options.scene) {}

  void check(std::size_t number) {
    const std::string& path = options_.bags[number];
    BagCloudIndex clouds(options_.scene.cloud_topics, options_.limits.clock_tolerance);
    const BagContents bag =
        readBag(path, options_.limits, [&](const RawMessage& raw) { clouds.take(raw); });
    for (const std::string& loss : bag.losses) warn(path + ": " + loss);
    naming(path, [&] {
      const BuiltScene& built = scenes_.sceneFor(bag);
      clouds.requireAllSources();
      const auto poses = makeBagPoses(bag, *built.scene, options_.poses);
      for (const std::string& note : poses->notes()) warn(path + ": " + note);
      CloudReplay replay(clouds, built.clouds, built.description, *built.scene, *poses);
      checkStamps(number, built.scene, *poses, replay);
      for (const std::string& refusal : replay.refusals()) warn(path + ": " + refusal);
    });
  }

 private:
  void checkStamps(std::size_t number, const std::shared_ptr<const CollisionScene>& scene,
                   const BagPoses& source, CloudReplay& clouds) {
    const std::string& path = options_.bags[number];
    const auto& stamps = source.stamps();
    if (options_.shard.count > 1) sink_(bagLine(path, stamps.size()), nullptr);
    std::vector<std::string> at_zero;
    for (const std::string& joint : source.jointsAtZero()) {
      at_zero.push_back("joint '" + joint + "' is not in the bag: it was taken as zero");
    }
    ProgressBar progress(path, stamps.size());
    CollisionDetector detector(scene);
    BodyPoses poses;
    std::size_t state = 0;
    const auto checkReady = [&] {
      for (; state < stamps.size() && clouds.isReady(stamps[state]); ++state) {
        if (!options_.shard.owns(number, state)) continue;
        poses.doubts = source.at(stamps[state], poses);
        poses.doubts.insert(poses.doubts.end(), at_zero.begin(), at_zero.end());
        const auto in_doubt = clouds.addVoxels(stamps[state], poses);
        const CollisionReport& report = detector.detect(poses, options_.settings);
        writeRow(number, state, stamps[state], report, *scene, in_doubt);
        progress.show(state);
      }
    };
    checkReady();
    if (state == stamps.size()) return;
    readBagRecords(path, [&](const RawMessage& raw) {
      if (state == stamps.size()) return;
      clouds.take(raw, stamps[state]);
      checkReady();
    });
    if (state < stamps.size()) throw InputError(BAG_CHANGED);
  }

  void writeRow(std::size_t number, std::size_t state, StampNs stamp, const CollisionReport& report,
                const CollisionScene& scene, const std::vector<CloudDoubt>& in_doubt) {
    BagRow row = toRow(report, scene);
    for (const CloudDoubt& doubt : in_doubt) {
      const std::string name = listedName(doubt.cloud);
      const bool is_listed = std::count(row.left_out.begin(), row.left_out.end(), name) > 0;
      if (!is_listed) row.left_out.push_back(name);
    }
    row.unknown_because = lineOf(report.unknown_because);
    row.bag = options_.bags[number];
    row.state = state;
    row.stamp = stamp;
    sink_(toLine(row), &row);
    if (!recorder_) return;
    recorder_->write(report, scene, options_.settings,
                     withPrefix(options_.poses.prefix, scene.robot().links().front().name),
                     row.stamp);
  }

  const Options& options_;
  const BagLineSink& sink_;
  BagRecorder* recorder_;
  BagScenes scenes_;
};

void checkAll(Options& options) {
  complete(options);
  std::unique_ptr<BagRecorder> recorder;
  if (!options.record.empty()) recorder = std::make_unique<BagRecorder>(options.record);
  writeBagOutputs(options.output, [&](const BagLineSink& sink) {
    const bool is_part = options.shard.count > 1;
    if (is_part) sink(partLine(options.shard, options.given), nullptr);
    BagChecker checker(options, sink, recorder.get());
    for (std::size_t i = 0; i < options.bags.size(); ++i) checker.check(i);
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
