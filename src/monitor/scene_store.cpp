#include "scene_store.h"

#include <algorithm>
#include <set>

#include "collision_pairs/input_error.h"
#include "user_text.h"

namespace collision_pairs {
namespace {

constexpr std::size_t KEPT_RESTRICTIONS = 8;
const char* const NO_ROBOT = "there is no robot yet; see the node's log and diagnostics";

/// TF may have frames that are not links, and gives no hint for a misspelt one.
void requireLink(const RobotModel& robot, const std::string& name) {
  if (robot.findLink(name) >= 0) return;
  throw InputError("'" + name + "' is not a link to attach it to" +
                   didYouMean(name, namesOf(robot.links())));
}

/// A request is about what there is now; of parameters, they may be for objects to come.
void requireAllFound(const Restriction& restriction, const CollisionScene& scene,
                     const std::vector<RigidObject>& objects) {
  if (scene.models().empty()) return;  // CollisionScene::unchecked() says so
  for (const NamePattern& name : restriction.names) {
    const auto isMeant = [&](const CollisionModel& model) { return matches(name, model.name); };
    const auto isOnOne = [&](const RigidObject& object) {
      return matches(name, object.attached_link);
    };
    const auto isMissing = [&](const auto& entry) { return matches(name, entry.first); };
    const auto& models = scene.models();
    if (std::any_of(models.begin(), models.end(), isMeant)) continue;
    if (std::any_of(scene.missing().begin(), scene.missing().end(), isMissing)) continue;
    if (std::any_of(objects.begin(), objects.end(), isOnOne)) continue;
    throw InputError("links: '" + name + "' is nothing that is checked");
  }
}

}  // namespace

std::vector<std::string> ActiveScene::missing() const {
  std::vector<std::string> lines;
  for (const auto& [link, reasons] : scene->missing()) {
    for (const std::string& why : reasons) {
      lines.push_back("link '" + link + "' is left out: " + why);
    }
  }
  return lines;
}

void SceneJob::run(const Progress& progress) {
  if (built_) return;
  const auto before = objects_;
  auto objects = std::make_shared<SceneObjects>(*before);
  collision_pairs::apply(edits_, *objects);
  objects_ = std::move(objects);
  if (kind_ == Kind::UPDATE && changeBefore(*before)) return;
  auto built = build(progress);
  if (kind_ == Kind::LOAD && !replaces_objects_) requireFrameOfObjects(built->frame);
  built_ = std::move(built);
}

/// False: the scene has to be built anew.
bool SceneJob::changeBefore(const SceneObjects& objects) {
  const SceneConfig& config = parameters_->sources.config;
  if (!config.clouds.empty()) return false;  // their filters know the objects
  const auto isOfParameters = [&](const auto& edit) {
    return config.floor && edit.first == config.floor->name;
  };
  if (std::any_of(edits_.begin(), edits_.end(), isOfParameters)) return false;
  const auto scene = before_->scene->withAlike(sceneChanges(edits_, objects), cache_.get());
  if (!scene) return false;
  auto active = std::make_shared<ActiveScene>(*before_);
  active->scene = scene;
  active->revision = revisionOfResult();
  const auto isSame = [](const SceneBody& a, const SceneBody& b) { return a.body == b.body; };
  const auto &bodies = scene->bodies(), &before = before_->scene->bodies();
  const bool are_same =
      std::equal(bodies.begin(), bodies.end(), before.begin(), before.end(), isSame);
  if (!are_same) active->tf_poses = posesOf(*scene, active->frame);
  built_ = std::move(active);
  return true;
}

std::shared_ptr<ActiveScene> SceneJob::build(const Progress& progress) {
  auto active = std::make_shared<ActiveScene>();
  std::vector<RigidObject> present;
  for (const auto& entry : *objects_) present.push_back(entry.second.object);
  SceneDescription description =
      describeScene(parameters_->sources, std::move(present), restriction_);
  description.settings.progress = progress;
  active->scene = CollisionScene::build(description, cache_.get());
  const CollisionScene& scene = *active->scene;
  active->warnings = parameters_->warnings;
  active->frame = parameters_->fixed_frame.empty() ? scene.robot().links().front().name
                                                   : parameters_->fixed_frame;
  active->tf_poses = posesOf(scene, active->frame);
  active->revision = revisionOfResult();
  if (kind_ == Kind::RESTRICT) {
    requireAllFound(restriction_, scene, description.objects);
    active->clouds = before_->clouds;
    active->not_followed = onlyCheckedBy(scene, *before_->scene);
    return active;
  }
  const SceneConfig& config = parameters_->sources.config;
  for (const CloudConfig& cloud : config.clouds) {
    RobotFilter filter(description, scene, cloud, cache_.get());
    TfPoses poses(*transforms_, scene.robot(), filter.own.bodies(), active->frame,
                  config.static_joints);
    followed_.push_back(
        std::make_shared<FollowedRobot>(FollowedRobot{std::move(filter), std::move(poses)}));
  }
  return active;
}

/// Of objects that stand: their poses would silently change.
void SceneJob::requireFrameOfObjects(const std::string& frame) const {
  if (!before_ || frame == before_->frame) return;
  for (const auto& [name, stored] : *objects_) {
    if (!stored.object.attached_link.empty()) continue;
    throw InputError("object '" + name + "' is fixed in frame '" + before_->frame +
                     "', but reports would be in '" + frame +
                     "': the root link or fixed_frame has changed; remove the object, and add it "
                     "again afterwards");
  }
}

std::shared_ptr<const TfPoses> SceneJob::posesOf(const CollisionScene& scene,
                                                 const std::string& frame) const {
  return std::make_shared<TfPoses>(*transforms_, scene.robot(), scene.bodies(), frame,
                                   parameters_->sources.config.static_joints);
}

SceneJob SceneStore::job(SceneJob::Kind kind) const {
  SceneJob job(kind);
  job.revision_ = revision_;
  job.transforms_ = &transforms_;
  job.parameters_ = parameters_;
  job.cache_ = cache_;
  job.before_ = scene_;
  job.objects_ = objects_;
  return job;
}

StoredScene SceneStore::stored() const {
  return {parameters_, objects_, scene_ ? scene_->frame : std::string(),
          revision_,   since_,   are_objects_lost_};
}

SceneJob SceneStore::load(SceneParameters parameters, std::optional<SceneObjects> objects) const {
  SceneJob made = job(SceneJob::Kind::LOAD);
  made.parameters_ = std::make_shared<SceneParameters>(std::move(parameters));
  made.replaces_objects_ = objects.has_value();
  if (objects) made.objects_ = std::make_shared<const SceneObjects>(std::move(*objects));
  return made;
}

SceneJob SceneStore::update(const std::vector<SceneChange>& changes,
                            const AddedObjects& added) const {
  if (!scene_) throw InputError(NO_ROBOT);
  UpdateContext context;
  context.world_frame = scene_->frame;
  context.look_up = [this](const auto& target, const auto& source, const ros::Time& stamp) {
    return lookUp(target, source, stamp);
  };
  context.require_link = [this](const std::string& link) {
    requireLink(scene_->scene->robot(), link);
  };
  SceneJob made = change(editsBy(changes, added, *objects_, context));
  if (changes.empty()) made.built_ = scene_;
  made.clears_objects_ = std::any_of(changes.begin(), changes.end(), [](const auto& change) {
    return change.operation == SceneChange::CLEAR;
  });
  return made;
}

SceneJob SceneStore::change(ObjectEdits edits) const {
  SceneJob made = job(SceneJob::Kind::UPDATE);
  made.edits_ = std::move(edits);
  made.may_keep_more_ = std::any_of(made.edits_.begin(), made.edits_.end(), [&](const auto& edit) {
    const auto before = objects_->find(edit.first);
    return before != objects_->end() && !before->second.object.attached_link.empty();
  });
  return made;
}

Eigen::Isometry3d SceneStore::lookUp(const std::string& target, const std::string& source,
                                     const ros::Time& stamp) const {
  if (target != scene_->frame) requireLink(scene_->scene->robot(), target);
  const auto fail = [&](const std::string& why) {
    throw InputError("TF does not know '" + source + "' in '" + target +
                     "': " + (transforms_.now().stamp.isZero() ? NO_CLOCK : why));
  };
  TransformInput::Found found;
  try {
    found = scene_->tf_poses->lookUp(target, source, stamp);
  } catch (const InputError& error) {
    fail(error.what());
  }
  const std::string still = transforms_.clockProblem();
  if (stamp.isZero() && !found.stamp.isZero() && !still.empty()) fail(still);
  return found.X_TS;
}

SceneJob SceneStore::restrictedTo(const Restriction& restriction) {
  if (!scene_) throw InputError(NO_ROBOT);
  SceneJob made = job(SceneJob::Kind::RESTRICT);
  made.restriction_ = restriction;
  const auto known = std::find_if(restricted_.begin(), restricted_.end(),
                                  [&](const auto& kept) { return kept.first == restriction; });
  if (restriction.empty()) {
    made.built_ = scene_;
  } else if (known != restricted_.end()) {
    std::rotate(known, known + 1, restricted_.end());
    made.built_ = restricted_.back().second;
  }
  return made;
}

bool SceneStore::take(SceneJob& job) {
  if (!job.built_ || job.revision_ != revision_) return false;
  if (job.kind_ == SceneJob::Kind::RESTRICT) {
    const bool is_known =
        job.built_ == scene_ || std::any_of(restricted_.begin(), restricted_.end(),
                                            [&](auto& kept) { return kept.second == job.built_; });
    if (is_known) return true;
    restricted_.emplace_back(job.restriction_, job.built_);
    if (restricted_.size() <= KEPT_RESTRICTIONS) return true;
    job.replaced_.push_back(std::move(restricted_.front()));
    restricted_.erase(restricted_.begin());
    return true;
  }
  if (job.built_ == scene_) return true;  // without changes
  if (job.clears_objects_) are_objects_lost_ = false;
  ++revision_;
  since_ = transforms_.now().stamp;
  since_jumps_ = transforms_.nbClockJumps();
  std::swap(job.replaced_, restricted_);
  follow(job);
  std::swap(job.parameters_, parameters_);
  std::swap(job.objects_, objects_);
  scene_ = job.built_;  // job.before_ is the old one
  return true;
}

/// The sources of the scene before, but for those whose settings have changed.
void SceneStore::follow(SceneJob& job) {
  const auto& configs = job.parameters_->sources.config.clouds;
  const auto& topics = job.parameters_->cloud_topics;
  const std::string& frame = job.built_->frame;
  for (std::size_t i = 0; i < configs.size(); ++i) {
    std::shared_ptr<CloudSource> before, source;
    for (std::size_t j = 0; scene_ && j < scene_->clouds.size(); ++j) {
      if (scene_->clouds[j]->config().name() == configs[i].name()) before = scene_->clouds[j];
    }
    if (before && before->config() == configs[i] && before->frame() == frame) {
      source = before;
    } else {
      const std::string& topic = i < topics.size() ? topics[i] : configs[i].topic;
      source = std::make_shared<CloudSource>(configs[i], topic, frame, transforms_);
      if (before) source->replace(*before);
    }
    if (i < job.followed_.size()) {
      job.followed_[i] = source->follow(std::move(job.followed_[i]), job.may_keep_more_);
    }
    job.built_->clouds.push_back(std::move(source));
  }
}

}  // namespace collision_pairs
