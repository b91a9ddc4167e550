#include "bag_checker.h"

#include <algorithm>
#include <optional>

#include "collision_pairs/input_error.h"
#include "collision_pairs/mesh_loader.h"
#include "csv.h"
#include "progress_bar.h"
#include "scene_message.h"
#include "user_text.h"

namespace collision_pairs {
namespace {

BagRow toRow(const CollisionReport& report, const CollisionScene& scene) {
  BagRow row;
  for (const PairReport& pair : report.pairs) {
    row.pairs.push_back(
        {listedPair(scene, pair.first, pair.second), pair.distance, pair.state != PairState::NEAR});
  }
  const bool is_measured = !report.ended_early && !report.min_distance_is_bound;
  if (is_measured) row.min_distance = report.min_distance;
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

template <class Topics>
bool isAmong(const Topics& topics, const std::string& topic) {
  return std::any_of(topics.begin(), topics.end(), [&](const std::string& other) {
    return withoutLeadingSlash(other) == withoutLeadingSlash(topic);
  });
}

/// Throws InputError unless each topic of --clouds has clouds.
void requireClouds(const std::vector<std::string>& topics, const BagIndex& index) {
  for (const std::string& topic : topics) {
    if (topic.find_first_not_of('/') == std::string::npos) {
      throw InputError("--clouds: '" + topic + "' is not a valid topic name");
    }
    if (isAmong(index.cloud_topics, topic)) continue;
    if (isAmong(index.topics, topic)) {
      throw InputError("--clouds: topic '" + topic + "' is not of type sensor_msgs/PointCloud2");
    }
    const auto& found = index.cloud_topics;
    throw InputError("--clouds: the bag has no messages on topic '" + topic +
                     "'; topics with clouds: " +
                     (found.empty() ? "none" : joined({found.begin(), found.end()})));
  }
}

/// Leaves the scene's clouds of these topics, or all if there is none. Throws InputError if a topic
/// is not that of a cloud.
void chooseClouds(const std::vector<std::string>& topics, SceneParameters& parameters,
                  const Warn& tell) {
  if (topics.empty()) return;
  for (const std::string& topic : topics) {
    if (isAmong(parameters.cloud_topics, topic)) continue;
    throw InputError("--clouds: topic '" + topic +
                     "' is no cloud of the recorded scene; its are: " +
                     (parameters.cloud_topics.empty() ? "none" : joined(parameters.cloud_topics)));
  }
  SceneSources& sources = parameters.sources;
  std::vector<CloudConfig> clouds;
  std::vector<std::string> resolved;
  for (std::size_t i = 0; i < parameters.cloud_topics.size(); ++i) {
    if (!isAmong(topics, parameters.cloud_topics[i])) continue;
    clouds.push_back(sources.config.clouds[i]);
    resolved.push_back(parameters.cloud_topics[i]);
  }
  const std::string ignored = warningOfIgnored(sources.config, clouds, sources.world != nullptr);
  if (!ignored.empty()) tell(ignored);
  sources.setClouds(std::move(clouds));
  parameters.cloud_topics = std::move(resolved);
}

bool givesScene(const SceneOptions& options) {
  return !options.urdf.empty() || !options.srdf.empty() || !options.world.empty() ||
         !options.settings.empty();
}

}  // namespace

void BagChecker::check(std::size_t number) {
  const std::string& path = options_.bags[number];
  RecordedScenes scenes;
  const RawMessageFilter wants = [](const RawMessage& raw) {
    const BagTopic kind = kindOf(raw);
    return kind == BagTopic::TRANSFORMS || kind == BagTopic::STATIC_TRANSFORMS ||
           kind == BagTopic::JOINT_STATES || kind == BagTopic::CLOUDS ||
           RecordedScenes::isScene(raw);
  };
  BagIndex index = indexBag(path, [&](const RawMessage& raw) {
    scenes.take(raw);
    return wants(raw);
  });
  scenes.finish(index.records);
  for (const BagLoss& loss : index.records.losses) warn(path + ": " + loss.what);
  naming(path, [&] {
    requireClouds(options_.scene.cloud_topics, index);
    const bool has_scenes = scenes.choose(options_.scene_topic);
    const bool are_checked = has_scenes && !givesScene(options_.scene);
    const std::vector<std::string> unused = index.chooseTransforms(are_checked);
    if (!unused.empty()) {
      warn(path + ": transforms on " + joined(unused) + " are not used" +
           (are_checked ? "; the node of the scenes heard /tf" : ""));
    }
    if (are_checked) {
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

void BagChecker::checkOneScene(std::size_t number, const BagIndex& index,
                               const RawMessageFilter& wants) {
  const BagRobot robot = robotOf(index, options_.scene);
  // Of consecutive bags with the same robot, all is read and said once.
  const bool is_same = robot.urdf.content == urdf_ && robot.srdf.content == srdf_;
  const Warn tell = is_same ? [](const std::string&) {} : Warn(warn);
  if (!is_same) parameters_.sources = sourcesOf(robot, options_.scene, tell);
  urdf_ = robot.urdf.content;
  srdf_ = robot.srdf.content;
  SceneSource source;
  source.review = [&](const CollisionScene& scene) {
    requireWhole(scene.description(), robot.urdf.origin, options_.scene.world);
    reviewScene(scene, options_.scene, tell);
  };
  BagReplay replay(options_.bags[number], index, wants, options_.replay, source,
                   std::move(parameters_), cache_);
  checkReports(number, index.times.size(), replay);
  parameters_ = replay.takeParameters();
}

void BagChecker::checkRecordedScenes(std::size_t number, const BagIndex& index,
                                     const RawMessageFilter& wants, const RecordedScenes& scenes) {
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
    chooseClouds(options_.scene.cloud_topics, parameters, tell);
    apply(options_.scene, parameters.sources);
    return parameters;
  };
  source.objects_of = [&](const Scene& message) { return objectsOf(message, load_mesh); };
  source.review = [&](const CollisionScene& scene) {
    requireWhole(scene.description(), scenes.topic(), scenes.topic());
    reviewScene(scene, options_.scene, tell);
  };
  SceneParameters parameters = source.parameters_of(scenes.first());
  BagReplayOptions replay_options = options_.replay;
  if (!options_.has_limits) replay_options.limits = parameters.sources.config.pose_limits;
  for (const std::string& topic : parameters.cloud_topics) {
    if (index.cloud_topics.count(topic) > 0) continue;
    warn(options_.bags[number] + ": it has no clouds on " + topic +
         ", so nothing is free; --clouds chooses others");
  }
  BagReplay replay(options_.bags[number], index, wants, replay_options, source,
                   std::move(parameters), cache_);
  checkReports(number, index.times.size(), replay);
}

void BagChecker::checkReports(std::size_t number, std::size_t nb_messages, BagReplay& replay) {
  const std::string& path = options_.bags[number];
  ProgressBar progress(path, nb_messages);
  std::size_t nb_rows = 0;
  replay.run([&](const Snapshot& snapshot, std::size_t nb_taken) {
    const std::size_t state = nb_rows++;
    progress.show(nb_taken);
    if (!options_.shard.owns(number, state)) return;
    const auto& scene = snapshot.scene->scene;
    if (!detector_ || &detector_->scene() != scene.get()) {
      detector_ = std::make_unique<CollisionDetector>(scene);
    }
    write(number, state, snapshot, replay);
  });
  if (nb_rows == 0) throw InputError("there is no stamp to check");
  if (options_.shard.count > 1) sink_(bagLine(path, nb_rows), nullptr);
  for (const std::string& note : replay.notes()) warn(path + ": " + note);
}

void BagChecker::write(std::size_t number, std::size_t state, const Snapshot& snapshot,
                       const BagReplay& replay) {
  const CollisionReport& report = detector_->detect(snapshot.poses, options_.settings);
  BagRow row = toRow(report, *snapshot.scene->scene);
  for (const std::string& cloud : snapshot.suspect_clouds) {
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

}  // namespace collision_pairs
