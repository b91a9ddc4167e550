// check_bag: recorded bags in, a verdict for each stamp out. Needs no roscore.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "bag_outputs.h"
#include "bag_poses.h"
#include "bag_recorder.h"
#include "cloud_replay.h"
#include "collision_pairs/collision_detector.h"
#include "collision_pairs/input_error.h"
#include "csv.h"
#include "scene_files.h"
#include "tool.h"

namespace collision_pairs {
namespace {

struct Options {
  std::vector<std::string> bags;
  std::string urdf, srdf, record, shard_text;
  std::string fidelity = "mesh";
  bool min_distance = false, verdict_only = false;
  SceneOptions scene;
  BagPosesOptions poses;
  BagOutputOptions output;
  // Made of the above.
  Shard shard;
  CheckSettings settings;
};

void declare(CLI::App& app, Options& options) {
  app.add_option("bags", options.bags, "the bags to check")->required()->type_name("BAG...");
  app.add_option("--urdf", options.urdf, "the robot (default: robot_description in the bag)")
      ->type_name("ROBOT.urdf");
  app.add_option("--srdf", options.srdf, "switches off its pairs (default: in the bag, if there)")
      ->type_name("ROBOT.srdf");
  declareScene(app, options.scene);
  app.add_option("--clouds", options.scene.cloud_topics,
                 "recorded sensor_msgs/PointCloud2 that are obstacles; --settings may say how")
      ->type_name("TOPIC...");
  app.add_option("--prefix", options.poses.prefix, "what the bag puts before this robot's names");
  app.add_option("--fidelity", options.fidelity, "aabb, spheres, obb, convex or mesh")
      ->capture_default_str();
  app.add_option("--alarm-distance", options.output.alarm_distance,
                 "pairs up to this far apart are reported")
      ->type_name("METRES")
      ->capture_default_str();
  app.add_option("--tolerance", options.settings.tolerance,
                 "distances may be too small by this; contact or not stays exact")
      ->type_name("METRES")
      ->capture_default_str();
  app.add_flag("--min-distance", options.min_distance,
               "find the smallest distance also where it is beyond the alarm distance");
  app.add_flag("--verdict-only", options.verdict_only,
               "only free, collision or unknown: ends at the first contact, the only pair named");
  app.add_option("--max-gap", options.poses.max_gap, "nothing is assumed over longer gaps")
      ->type_name("SECONDS")
      ->capture_default_str();
  app.add_option("--out", options.output.out, "where to write the table (default: standard output)")
      ->type_name("OUT.csv");
  app.add_option("--report", options.output.report, "write a page for a browser there: index.html")
      ->type_name("DIR");
  app.add_option("--record", options.record, "write reports and markers for rviz")
      ->type_name("OUT.bag");
  app.add_option("--shard", options.shard_text,
                 "check only the I-th of N parts (1 to N); merge_bag_checks puts them together")
      ->type_name("I/N");
}

double finiteNumber(double value, double least, const std::string& option) {
  if (!(value >= least) || !std::isfinite(value)) {
    throw InputError(option + " must be a finite number, " +
                     (least > 0.0 ? "above 0" : "0 or more"));
  }
  return value;
}

Shard parseShard(const std::string& text) {
  if (text.empty()) return {};
  unsigned long long index = 0, count = 0;
  char rest = 0;
  if (text.find('-') != std::string::npos ||
      std::sscanf(text.c_str(), "%llu/%llu%c", &index, &count, &rest) != 2 || index < 1 ||
      index > count) {
    throw InputError("--shard " + text + ": must be I/N with I from 1 to N, such as 2/4");
  }
  return {index - 1, count};
}

void complete(Options& options) {
  options.settings.fidelity = parseFidelity(options.fidelity);
  options.settings.alarm_distance =
      finiteNumber(options.output.alarm_distance, 0.0, "--alarm-distance");
  finiteNumber(options.settings.tolerance, 0.0, "--tolerance");
  options.settings.min_distance = options.min_distance;
  options.settings.verdict_only = options.verdict_only;
  options.settings.list_boxes = true;  // for nb_pairs
  options.settings.stage_times = !options.record.empty();
  options.output.max_gap = finiteNumber(options.poses.max_gap, 1e-9, "--max-gap");
  options.shard = parseShard(options.shard_text);
  options.output.quiet = !options.record.empty();
  if (options.shard.count > 1 && !(options.record.empty() && options.output.report.empty())) {
    throw InputError("--shard checks a part only: no --record, and --report when merged");
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

class BagChecker {
 public:
  BagChecker(const Options& options, const BagLineSink& sink, BagRecorder* recorder)
      : options_(options),
        sink_(sink),
        recorder_(recorder),
        scenes_(options.urdf, options.srdf, options.scene) {}

  void check(std::size_t number) {
    const std::string& path = options_.bags[number];
    BagCloudIndex clouds(options_.scene.cloud_topics);
    const BagContents bag = readBag(path, [&](const RawMessage& raw) { clouds.take(raw); });
    for (const std::string& loss : bag.losses) warn(path + ": " + loss);
    try {
      const BuiltScene& built = scenes_.sceneFor(bag);
      clouds.requireAllSources();
      const auto poses = makeBagPoses(bag, *built.scene, options_.poses);
      for (const std::string& note : poses->notes()) warn(path + ": " + note);
      CloudReplay replay(clouds, built.clouds, built.description, *built.scene, *poses);
      checkStamps(number, built.scene, *poses, replay);
      for (const std::string& refusal : replay.refusals()) warn(path + ": " + refusal);
    } catch (const InputError& error) {
      throw InputError(path + ": " + error.what());
    }
  }

 private:
  void checkStamps(std::size_t number, const std::shared_ptr<const CollisionScene>& scene,
                   const BagPoses& source, CloudReplay& clouds) {
    const std::string& path = options_.bags[number];
    const auto& stamps = source.stamps();
    if (options_.shard.count > 1) sink_(bagLine(path, stamps.size()), nullptr);
    std::vector<std::string> doubts;
    for (const std::string& joint : source.jointsAtZero()) {
      doubts.push_back("joint '" + joint + "' is not in the bag: it was taken at zero");
    }
    ProgressBar progress(path, stamps.size());
    CollisionDetector detector(scene);
    BodyPoses poses;
    std::size_t state = 0;
    const auto checkReady = [&] {
      for (; state < stamps.size() && clouds.isReady(stamps[state]); ++state) {
        if (!options_.shard.owns(number, state)) continue;
        source.at(stamps[state], poses);
        const auto cloud_doubts = clouds.addVoxels(stamps[state], poses);
        const CollisionReport& report = detector.detect(poses, options_.settings);
        writeRow(number, state, stamps[state], report, *scene, doubts, cloud_doubts);
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
                const CollisionScene& scene, std::vector<std::string> doubts,
                const std::vector<CloudDoubt>& cloud_doubts) {
    BagRow row = toRow(report, scene);
    for (const auto& [cloud, why] : cloud_doubts) {
      const std::string name = listedName(cloud);
      doubts.push_back(why);
      const bool is_listed = std::count(row.left_out.begin(), row.left_out.end(), name) > 0;
      if (!is_listed) row.left_out.push_back(name);
    }
    if (row.verdict == Verdict::FREE && !doubts.empty()) row.verdict = Verdict::UNKNOWN;
    row.bag = options_.bags[number];
    row.state = state;
    row.stamp = stamp;
    sink_(toLine(row), &row);
    if (!recorder_) return;
    recorder_->write(report, scene, options_.settings, frameOf(scene), row.stamp, doubts);
  }

  std::string frameOf(const CollisionScene& scene) const {
    return withPrefix(options_.poses.prefix, scene.robot().links().front().name);
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
    if (is_part) sink(partLine(options.shard), nullptr);
    BagChecker checker(options, sink, recorder.get());
    for (std::size_t i = 0; i < options.bags.size(); ++i) checker.check(i);
    if (is_part) sink(BAG_TABLE_END, nullptr);
  });
  if (recorder) recorder->finish();
}

}  // namespace
}  // namespace collision_pairs

int main(int argc, char** argv) {
  collision_pairs::Options options;
  CLI::App app("Checks what a robot did in recorded bags for collisions.", "check_bag");
  collision_pairs::declare(app, options);
  return collision_pairs::runTool(app, argc, argv, [&] { collision_pairs::checkAll(options); });
}
