#include "bag_replay.h"

#include <algorithm>
#include <utility>

#include <boost/make_shared.hpp>

#include "collision_pairs/input_error.h"
#include "message_layout.h"
#include "user_text.h"

namespace collision_pairs {
namespace {

/// As CloudConfig::name().
std::string nameOf(const std::string& topic) {
  return topic.substr(std::min(topic.find_first_not_of('/'), topic.size()));
}

bool isChecked(const CollisionScene& scene, const std::string& name) {
  return std::any_of(scene.clouds().begin(), scene.clouds().end(), [&](const SceneCloud& cloud) {
    return scene.models()[cloud.model].name == name;
  });
}

bool haveSameParameters(const Scene& a, const Scene& b) {
  return a.header.frame_id == b.header.frame_id && a.robots == b.robots && a.world == b.world &&
         a.settings == b.settings && a.cloud_topics == b.cloud_topics;
}

/// Whether transforms connect the bodies, whatever they say: the bag's, each once.
FoundBodies connected(const BagIndex& index, const RobotFrames& frames, const ActiveScene& scene,
                      const std::vector<std::string>& static_joints) {
  std::map<std::string, const BagIndex::Edge*> by_child;
  for (const BagIndex::Edge& edge : index.transforms) {
    const auto& known = by_child.try_emplace(frames.ofRobot(edge.child), &edge).first->second;
    if (!edge.is_static && known->is_static) by_child[frames.ofRobot(edge.child)] = &edge;
  }
  constexpr StampNs ANY = 1000000000;
  TransformBuffer buffer;
  for (const auto& [child, edge] : by_child) {
    buffer.take({frames.ofRobot(edge->parent), child, ANY, Eigen::Vector3d::Zero(),
                 Eigen::Quaterniond::Identity()},
                edge->is_static, "", ANY);
  }
  const RobotModel& robot = scene.scene->robot();
  const RobotPoses poses(buffer, robot, scene.frame, static_joints);
  return poses.place({Instant::AT, ANY}, std::vector<char>(robot.bodies().size(), 1));
}

}  // namespace

BagReplay::BagReplay(std::string path, const BagIndex& index, const RawMessageFilter& wants,
                     const BagReplayOptions& options, const SceneSource& scenes,
                     SceneParameters parameters, std::shared_ptr<SceneCache> cache)
    : path_(std::move(path)),
      index_(index),
      wants_(wants),
      options_(options),
      scenes_(scenes),
      monitor_({options.limits}, std::move(cache)),
      frames_(index, namesOf(parameters.sources.robots.front().source->skeleton()->links()),
              options.prefix) {
  static_joints_ = parameters.sources.config.static_joints;
  std::optional<SceneObjects> objects;
  if (scenes_.recorded) {
    shown_ = scenes_.recorded->first();
    monitor_.scenes().setObjectsLost(shown_.objects_are_lost);
    objects = scenes_.objects_of(shown_);
  }
  load(std::move(parameters), std::move(objects));
}

void BagReplay::load(SceneParameters parameters, std::optional<SceneObjects> objects) {
  auto& static_joints = parameters.sources.config.static_joints;
  static_joints.insert(static_joints.end(), at_zero_.begin(), at_zero_.end());
  run(monitor_.scenes().load(std::move(parameters), std::move(objects)));
}

void BagReplay::run(SceneJob job) {
  job.run();
  monitor_.scenes().take(job);
  scene_ = monitor_.scenes().active();
  scenes_.review(*scene_->scene);
}

SceneParameters BagReplay::takeParameters() {
  SceneParameters parameters = std::move(*monitor_.scenes().parameters());
  parameters.sources.config.static_joints = static_joints_;
  return parameters;
}

void BagReplay::choosePoses() {
  const CollisionScene& scene = *scene_->scene;
  const RobotModel& robot = scene.robot();
  SceneParameters& parameters = *monitor_.scenes().parameters();
  const std::vector<std::string>& static_joints = parameters.sources.config.static_joints;
  const FoundBodies by_tf = connected(index_, frames_, *scene_, static_joints);
  const auto moves = [&](const SceneBody& body) { return robot.bodies()[body.body].joint >= 0; };
  std::size_t nb_by_tf = 0;
  std::vector<std::string> missing, problems;
  for (const SceneBody& body : scene.bodies()) {
    if (!moves(body)) continue;
    if (by_tf.known[body.body]) {
      ++nb_by_tf;
    } else if (by_tf.problems[body.body] == RobotPoses::NO_FRAME) {
      missing.push_back(body.link);
    } else {
      problems.push_back("link '" + body.link + "': " + by_tf.problems[body.body]);
    }
  }
  scene_of_joints_ = scene_;
  joints_.emplace(index_.joints, robot, options_.prefix);
  const std::size_t nb_by_joints = joints_->nbMoved(scene.bodies());
  if (nb_by_tf == 0 && nb_by_joints == 0) refuse(problems);
  if (nb_by_tf >= nb_by_joints) {
    joints_.reset();
    if (!missing.empty()) {
      notes_.push_back("left out, because TF has no frame for them: " + joined(missing));
    }
    return;
  }
  made_frames_ = joints_->frames();
  const std::vector<std::string> unnamed = joints_->unnamedJoints(scene.bodies());
  if (unnamed.empty()) return;
  notes_.push_back("joints that it does not name are taken as zero: " + joined(unnamed));
  for (const std::string& joint : unnamed) {
    unknown_because_.push_back("joint '" + joint + "' is not in the bag: it was taken as zero");
  }
  at_zero_ = namesOf(robot.joints());
  load(std::move(parameters));
}

void BagReplay::refuse(const std::vector<std::string>& problems) const {
  const RobotModel& robot = scene_->scene->robot();
  const auto& bodies = scene_->scene->bodies();
  if (std::none_of(bodies.begin(), bodies.end(),
                   [&](const SceneBody& body) { return robot.bodies()[body.body].joint >= 0; })) {
    throw InputError(
        "there is nothing to check: no link of robot '" + robot.name() +
        "' that moves is in a pair; links, group, pair_rules and the SRDF choose them");
  }
  if (!problems.empty()) {
    throw InputError("there is no stamp to check: of its " + std::to_string(problems.size()) +
                     " links on moving joints that TF names none is placed, and no joint states "
                     "move them; " +
                     problems.front());
  }
  const std::set<std::string> prefixes = possiblePrefixes(index_, namesOf(robot.links()));
  const std::string hint =
      prefixes.empty() ? ""
                       : "; try --prefix " + joined({prefixes.begin(), prefixes.end()}, " or ");
  throw InputError("neither its transforms nor its joint states mention robot '" + robot.name() +
                   "'" + hint);
}

void BagReplay::run(const Visit& visit) {
  choosePoses();
  visit_ = &visit;
  if (joints_) monitor_.take(joints_->atZero(), true, "");
  replayBag(path_, index_, wants_, [this](const RawMessage& raw) { take(raw); });
  if (!ahead_.empty()) advance(ros::Time(*ahead_.rbegin()));
  flush();
}

void BagReplay::take(const RawMessage& raw) {
  ++nb_taken_;
  advance(toTime(raw.received));
  const BagTopic kind = kindOf(raw);
  if (kind == BagTopic::TRANSFORMS || kind == BagTopic::STATIC_TRANSFORMS) {
    if (!index_.isChosen(raw)) return;
    auto message = readMessage<tf2_msgs::TFMessage>(raw.data, raw.size);
    if (!message) return;
    takeTransforms(std::move(*message), kind == BagTopic::STATIC_TRANSFORMS, raw.publisher);
  } else if (kind == BagTopic::JOINT_STATES && joints_ && raw.topic == joints_->topic()) {
    auto state = readMessage<sensor_msgs::JointState>(raw.data, raw.size);
    if (!state) return;
    const tf2_msgs::TFMessage made = joints_->take(*state);
    if (made.transforms.empty()) return;
    take(made, false, raw.publisher);
  } else if (scenes_.recorded && scenes_.recorded->isChosen(raw)) {
    return takeScene(raw);
  } else if (kind == BagTopic::CLOUDS) {
    takeCloud(raw);
    return filterClouds();
  } else {
    return;
  }
  filterClouds();
  report();
}

void BagReplay::advance(const ros::Time& now) {
  while (!ahead_.empty() && *ahead_.begin() <= now) {
    monitor_.advance(*ahead_.begin());
    ahead_.erase(ahead_.begin());
    filterClouds();
    report();
  }
  monitor_.advance(now);
}

void BagReplay::takeTransforms(tf2_msgs::TFMessage message, bool is_static,
                               const std::string& publisher) {
  auto& transforms = message.transforms;
  for (auto& transform : transforms) {
    transform.header.frame_id = frames_.ofRobot(transform.header.frame_id);
    transform.child_frame_id = frames_.ofRobot(transform.child_frame_id);
  }
  const auto isMade = [this](const auto& transform) {
    return made_frames_.count(transform.child_frame_id) > 0;
  };
  transforms.erase(std::remove_if(transforms.begin(), transforms.end(), isMade), transforms.end());
  take(message, is_static, publisher);
}

void BagReplay::take(const tf2_msgs::TFMessage& message, bool is_static,
                     const std::string& publisher) {
  const ros::Time& now = monitor_.transforms().now().stamp;
  for (const auto& transform : message.transforms) {
    const double ahead = secondsBetween(now, transform.header.stamp);
    if (is_static || ahead <= 0.0 || ahead > options_.limits.clock_tolerance) continue;
    ahead_.insert(transform.header.stamp);
  }
  monitor_.take(message, is_static, publisher);
}

void BagReplay::takeCloud(const RawMessage& raw) {
  const std::string name = nameOf(raw.topic);
  for (const auto& source : scene_->clouds) {
    if (nameOf(source->topic()) != name) continue;
    if (!isChecked(*scene_->scene, source->config().name())) return;
    ++clouds_[source->config().name()].nb_clouds;
    auto cloud = readMessage<sensor_msgs::PointCloud2>(raw.data, raw.size);
    if (!cloud) return source->refuse("it is truncated");
    cloud->header.frame_id = frames_.ofRobot(cloud->header.frame_id);
    source->take(boost::make_shared<sensor_msgs::PointCloud2>(std::move(*cloud)), raw.publisher);
  }
}

void BagReplay::takeScene(const RawMessage& raw) {
  auto message = readMessage<Scene>(raw.data, raw.size);
  if (!message) return;
  Scene old = std::exchange(shown_, std::move(*message));
  monitor_.scenes().setObjectsLost(shown_.objects_are_lost);
  const auto differing = [](const Scene& scene, const Scene& other) {
    std::map<std::string, const SceneObject*> objects;
    for (const SceneObject& object : other.objects) objects[object.name] = &object;
    std::vector<SceneObject> found;
    for (const SceneObject& object : scene.objects) {
      const auto same = objects.find(object.name);
      if (same == objects.end() || !(*same->second == object)) found.push_back(object);
    }
    return found;
  };
  Scene changed = shown_;
  changed.objects = differing(shown_, old);
  old.objects = differing(old, shown_);
  const bool has_edits = !old.objects.empty() || !changed.objects.empty();
  if (joints_ && shown_.robots != old.robots) {
    throw InputError("a robot changes in revision " + std::to_string(shown_.revision) +
                     ", but joint states place it: split the bag there");
  }
  // If nothing else differs, update_scene has changed the objects; ~reset reads all anew.
  if (!has_edits || !haveSameParameters(shown_, old)) {
    return load(scenes_.parameters_of(shown_), scenes_.objects_of(shown_));
  }
  ObjectEdits edits;
  for (const SceneObject& object : old.objects) edits[object.name] = std::nullopt;
  for (auto& [name, object] : scenes_.objects_of(changed)) edits[name] = std::move(object);
  run(monitor_.scenes().change(std::move(edits)));
}

void BagReplay::filterClouds() {
  for (const auto& source : scene_->clouds) {
    CloudNotes& notes = clouds_[source->config().name()];
    while (auto job = source->next()) {
      job->run();
      source->take(*job);
    }
    const CloudHealth health = source->health();
    notes.nb_dropped = health.dropped;
    const std::string note = source->takeNote();
    if (note.empty()) continue;
    const bool is_refusal = health.refused > notes.nb_refused;
    notes.nb_refused = health.refused;
    if (!is_refusal) ++notes.nb_warned;
    std::string& first = is_refusal ? notes.first_problem : notes.first_warning;
    if (first.empty()) first = note.substr(is_refusal ? CloudSource::REFUSED.size() : 0);
  }
}

void BagReplay::report() {
  Snapshot report = monitor_.at(scene_);
  auto& reasons = report.poses.unknown_because;
  reasons.insert(reasons.end(), unknown_because_.begin(), unknown_because_.end());
  if (scenes_.recorded) {
    const std::string problem =
        scenes_.recorded->whySuspectAt(toNs(monitor_.transforms().now().stamp));
    if (!problem.empty()) reasons.push_back(problem);
  }
  if (latest_ && latest_->stamp != report.stamp) flush();
  latest_.emplace(std::move(report));
}

void BagReplay::flush() {
  if (latest_) (*visit_)(*latest_, nb_taken_);
  latest_.reset();
}

std::vector<std::string> BagReplay::notes() const {
  std::vector<std::string> notes = notes_;
  const TransformInput& transforms = monitor_.transforms();
  if (transforms.nbRefused() > 0) {
    notes.push_back(
        std::to_string(transforms.nbRefused()) +
        " transforms are not used, or are suspect; the first: " + transforms.firstRefused());
  }
  for (const auto& [name, cloud] : clouds_) {
    const auto add = [&, &name = name, &cloud = cloud](std::size_t count, const std::string& what) {
      if (count == 0) return;
      notes.push_back("cloud '" + name + "': " + std::to_string(count) + " of " +
                      std::to_string(cloud.nb_clouds) + " messages " + what);
    };
    add(cloud.nb_refused, "were refused; the first: " + cloud.first_problem);
    add(cloud.nb_warned, "show nothing; the first: " + cloud.first_warning);
    add(cloud.nb_dropped, "were dropped: newer ones had the transforms at their stamps before");
  }
  return notes;
}

}  // namespace collision_pairs
