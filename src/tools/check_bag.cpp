// check_bag: recorded bags in, a verdict for each stamp out. Needs no roscore.
#include <algorithm>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "bag_outputs.h"
#include "bag_recorder.h"
#include "bag_replay.h"
#include "collision_pairs/collision_detector.h"
#include "collision_pairs/input_error.h"
#include "csv.h"
#include "progress_bar.h"
#include "scene_config.h"
#include "scene_files.h"
#include "scene_message.h"
#include "text_files.h"
#include "user_text.h"

namespace collision_pairs {
namespace {

struct Options {
  std::vector<std::string> bags;
  std::string record, scene_topic, shard_text, max_gap, given;
  SceneOptions scene;
  BagReplayOptions replay;
  BagOutputOptions output;
  // Made of the above.
  Shard shard;
  CheckSettings settings;
};

void declare(CommandLine& command_line, Options& options) {
  command_line.operands(options.bags, "BAG...", "the bags to check");
  command_line.option("urdf", options.scene.urdf, "ROBOT.urdf",
                      "the robot (default: the scenes of a node in the bag, or robot_description)");
  command_line.option("srdf", options.scene.srdf, "ROBOT.srdf",
                      "pairs that it disables are not checked (default: robot_description_semantic "
                      "in the bag, if any)");
  declareScene(command_line, options.scene);
  command_line.option(
      "clouds", options.scene.cloud_topics, "TOPIC...",
      "topics of sensor_msgs/PointCloud2 in the bag that are obstacles; parameters in --settings");
  command_line.option("scene", options.scene_topic, "TOPIC",
                      "of several topics of collision_pairs/Scene in the bag, the one to check");
  command_line.option("prefix", options.replay.prefix, "PREFIX",
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
    options.replay.limits = config.pose_limits;
  }
  if (!options.max_gap.empty()) {
    double seconds = 0.0;
    requireGap(parseNumber(options.max_gap, seconds) ? seconds : 0.0);
    options.replay.limits.max_pose_age = options.replay.limits.max_transform_age = seconds;
  }
  options.output.max_gap = options.replay.limits.max_transform_age;
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

/// Throws InputError unless each topic of --clouds has clouds.
void requireClouds(const std::vector<std::string>& topics, const BagIndex& index) {
  const auto isIn = [](const std::set<std::string>& found, const std::string& topic) {
    return std::any_of(found.begin(), found.end(), [&](const std::string& other) {
      return withoutLeadingSlash(other) == withoutLeadingSlash(topic);
    });
  };
  for (const std::string& topic : topics) {
    if (isIn(index.cloud_topics, topic)) continue;
    if (isIn(index.topics, topic)) {
      throw InputError("--clouds: topic '" + topic + "' is not of type sensor_msgs/PointCloud2");
    }
    const auto& found = index.cloud_topics;
    throw InputError("--clouds: the bag has no messages on topic '" + topic +
                     "'; topics with clouds: " +
                     (found.empty() ? "none" : joined({found.begin(), found.end()})));
  }
}

/// Leaves the clouds of these topics, or all if there is none.
void chooseClouds(const std::vector<std::string>& topics, SceneParameters& parameters) {
  if (topics.empty()) return;
  SceneSources& sources = parameters.sources;
  std::vector<CloudConfig> clouds;
  std::vector<std::string> resolved;
  for (std::size_t i = 0; i < parameters.cloud_topics.size(); ++i) {
    const bool is_chosen = std::any_of(topics.begin(), topics.end(), [&](const auto& topic) {
      return withoutLeadingSlash(topic) == withoutLeadingSlash(parameters.cloud_topics[i]);
    });
    if (!is_chosen) continue;
    clouds.push_back(sources.config.clouds[i]);
    resolved.push_back(parameters.cloud_topics[i]);
  }
  const std::string ignored = warningOfIgnored(sources.config, clouds);
  if (!ignored.empty()) warn(ignored);
  sources.config.clouds = std::move(clouds);
  parameters.cloud_topics = std::move(resolved);
  sources.clouds.clear();
  for (const CloudConfig& cloud : sources.config.clouds) {
    sources.clouds.push_back(obstacleOf(cloud));
  }
}

class BagChecker {
 public:
  BagChecker(const Options& options, const BagLineSink& sink, BagRecorder* recorder)
      : options_(options), sink_(sink), recorder_(recorder) {}

  void check(std::size_t number) {
    const std::string& path = options_.bags[number];
    RecordedScenes scenes;
    const RawMessageFilter wants = [](const RawMessage& raw) {
      const BagTopic kind = kindOf(raw);
      return kind == BagTopic::TRANSFORMS || kind == BagTopic::STATIC_TRANSFORMS ||
             kind == BagTopic::JOINT_STATES || kind == BagTopic::CLOUDS ||
             RecordedScenes::isScene(raw);
    };
    const BagIndex index = indexBag(path, [&](const RawMessage& raw) {
      scenes.take(raw);
      return wants(raw);
    });
    for (const std::string& loss : index.losses) warn(path + ": " + loss);
    naming(path, [&] {
      requireClouds(options_.scene.cloud_topics, index);
      const bool has_scenes = scenes.choose(options_.scene_topic);
      if (has_scenes && !givesScene(options_.scene)) {
        checkRecordedScenes(number, index, wants, scenes);
      } else {
        if (has_scenes) {
          warn(path + ": the scenes on " + scenes.topic() +
               " are not checked, since a robot or settings are given; nor what was attached");
        }
        checkOneScene(number, index, wants);
      }
    });
  }

 private:
  static bool givesScene(const SceneOptions& options) {
    return !options.urdf.empty() || !options.srdf.empty() || !options.world.empty() ||
           !options.settings.empty();
  }

  void checkOneScene(std::size_t number, const BagIndex& index, const RawMessageFilter& wants) {
    const BagRobot robot = robotOf(index, options_.scene);
    // Of consecutive bags with the same robot, all is read and said once.
    const bool is_same = robot.urdf.content == urdf_ && robot.srdf.content == srdf_;
    const Warn tell = is_same ? [](const std::string&) {} : Warn(warn);
    if (!is_same) parameters_.sources = sourcesOf(robot, options_.scene, tell);
    urdf_ = robot.urdf.content;
    srdf_ = robot.srdf.content;
    SceneSource source;
    source.review = [&](const SceneSources& sources, const CollisionScene& scene) {
      requireWhole(sources, robot.urdf.origin, options_.scene.world);
      reviewScene(scene, options_.scene, tell);
    };
    BagReplay replay(options_.bags[number], index, wants, options_.replay, source,
                     std::move(parameters_), cache_);
    checkReports(number, index.times.size(), replay);
    parameters_ = replay.takeParameters();
  }

  void checkRecordedScenes(std::size_t number, const BagIndex& index, const RawMessageFilter& wants,
                           const RecordedScenes& scenes) {
    if (!options_.replay.prefix.empty()) {
      throw InputError("--prefix: the scenes on " + scenes.topic() +
                       " name the frames of their robots themselves");
    }
    const Warn tell = [this](const std::string& what) {
      if (told_.insert(what).second) warn(what);
    };
    const MeshLoader load_mesh = makeMeshLoader(tell);
    SceneSource source;
    source.recorded = &scenes;
    source.parameters_of = [&](const Scene& message) {
      SceneParameters parameters = parametersOf(message, load_mesh, tell);
      chooseClouds(options_.scene.cloud_topics, parameters);
      apply(options_.scene, parameters.sources);
      return parameters;
    };
    source.objects_of = [&](const Scene& message) { return objectsOf(message, load_mesh); };
    source.review = [&](const SceneSources& sources, const CollisionScene& scene) {
      requireWhole(sources, scenes.topic(), scenes.topic());
      reviewScene(scene, options_.scene, tell);
    };
    SceneParameters parameters = source.parameters_of(scenes.first());
    BagReplayOptions replay_options = options_.replay;
    if (options_.max_gap.empty()) replay_options.limits = parameters.sources.config.pose_limits;
    for (const std::string& topic : parameters.cloud_topics) {
      if (index.cloud_topics.count(topic) > 0) continue;
      warn(options_.bags[number] + ": it has no clouds on " + topic +
           ", so nothing is free; --clouds chooses others");
    }
    BagReplay replay(options_.bags[number], index, wants, replay_options, source,
                     std::move(parameters), cache_);
    checkReports(number, index.times.size(), replay);
  }

  void checkReports(std::size_t number, std::size_t nb_messages, BagReplay& replay) {
    const std::string& path = options_.bags[number];
    ProgressBar progress(path, nb_messages);
    std::size_t nb_rows = 0;
    replay.run([&](ReplayedReport& report, std::size_t nb_taken) {
      const std::size_t state = nb_rows++;
      progress.show(nb_taken);
      if (!options_.shard.owns(number, state)) return;
      const auto& scene = report.snapshot.scene->scene;
      if (!detector_ || &detector_->scene() != scene.get()) {
        detector_ = std::make_unique<CollisionDetector>(scene);
      }
      write(number, state, report, replay);
    });
    if (nb_rows == 0) throw InputError("there is no stamp to check");
    if (options_.shard.count > 1) sink_(bagLine(path, nb_rows), nullptr);
    for (const std::string& note : replay.notes()) warn(path + ": " + note);
  }

  void write(std::size_t number, std::size_t state, const ReplayedReport& replayed,
             const BagReplay& replay) {
    const Snapshot& snapshot = replayed.snapshot;
    const CollisionReport& report = detector_->detect(snapshot.poses, options_.settings);
    BagRow row = toRow(report, *snapshot.scene->scene);
    for (const std::string& cloud : replayed.doubtful_clouds) {
      const std::string name = listedName(cloud);
      if (!contains(row.left_out, name)) row.left_out.push_back(name);
    }
    row.unknown_because = lineOf(report.unknown_because);
    row.bag = options_.bags[number];
    row.state = state;
    row.stamp = toNs(snapshot.stamp);
    sink_(toLine(row), &row);
    if (recorder_) {
      recorder_->write(report, *snapshot.scene->scene, options_.settings, replay.frameInBag(),
                       row.stamp);
    }
  }

  const Options& options_;
  const BagLineSink& sink_;
  BagRecorder* recorder_;
  std::string urdf_, srdf_;  // of parameters_
  SceneParameters parameters_;
  std::set<std::string> told_;
  const std::shared_ptr<SceneCache> cache_ = std::make_shared<SceneCache>();
  std::unique_ptr<CollisionDetector> detector_;
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
