#include "scene_store.h"

#include <algorithm>
#include <set>

#include <ros/console.h>

#include "collision_pairs/input_error.h"
#include "collision_pairs/mesh_loader.h"
#include "frame_names.h"
#include "user_text.h"

namespace collision_pairs {
namespace {

constexpr std::size_t KEPT_RESTRICTIONS = 8;

/// TF may have frames that are not links, and gives no hint for a misspelt one.
void requireLink(const RobotModel& robot, const std::string& name) {
  if (robot.findLink(name) >= 0) return;
  std::vector<std::string> links;
  for (const Link& link : robot.links()) links.push_back(link.name);
  throw InputError("'" + name + "' is not a link to attach it to; did you mean '" +
                   nearestName(name, links) + "'?");
}

}  // namespace

std::vector<std::string> addVoxels(const ActiveScene& scene, const ros::Time& now,
                                   BodyPoses& poses) {
  std::vector<std::string> doubts;
  if (!scene.clouds) return doubts;
  for (CloudDoubt& doubt : addVoxels(scene.clouds->views(now), *scene.scene, poses)) {
    doubts.push_back(std::move(doubt.why));
  }
  return doubts;
}

std::vector<std::string> addVoxels(const ActiveScene& scene, const ros::Time& stamp,
                                   const ros::Time& now, BodyPoses& poses) {
  if (stamp.isZero()) return addVoxels(scene, now, poses);
  if (scene.scene->clouds().empty()) return {};
  return {"the request has a stamp, and only the newest clouds are kept: leave stamp at 0"};
}

SceneStore::SceneStore(const ros::NodeHandle& node, const ros::NodeHandle& private_node,
                       TransformInput& transforms)
    : node_(node), private_node_(private_node), transforms_(transforms) {}

ActiveScenePtr SceneStore::active() const {
  const std::lock_guard<std::mutex> lock(reading_);
  return scene_;
}

void SceneStore::replace(Built built) {
  restricted_.clear();
  if (built.scene->clouds) {
    built.scene->clouds->follow(std::move(built.filters), built.may_keep_more);
  }
  const std::lock_guard<std::mutex> lock(reading_);
  scene_ = std::move(built.scene);
}

void SceneStore::load() {
  const std::lock_guard<std::mutex> lock(building_);
  const ros::WallTime start = ros::WallTime::now();
  told_.clear();
  SceneParameters parameters = readSceneParameters(private_node_);
  Built built = build(parameters, objects_, {});
  requireFrameOfObjects(built.scene->frame);
  const CollisionScene& scene = *built.scene->scene;
  ROS_INFO_STREAM("robot '" << scene.robot().name() << "': " << scene.models().size()
                            << " links with geometry to check, " << scene.elements().size()
                            << " elements, " << scene.bodies().size()
                            << " moving bodies, ready after "
                            << (ros::WallTime::now() - start).toSec() << " s");
  const auto& open_meshes = built.scene->open_meshes;
  if (!open_meshes.empty()) ROS_WARN_STREAM(joined(open_meshes, "; "));
  if (!scene.unchecked().empty()) {
    ROS_WARN_STREAM(scene.unchecked()
                    << (scene.mayBeFree()
                            ? ": the verdict can be FREE because of ~allow_empty_scene"
                            : ": the verdict is never FREE unless "
                              "~allow_empty_scene permits it"));
  }
  parameters_ = std::move(parameters);
  replace(std::move(built));
}

// Their poses would silently change.
void SceneStore::requireFrameOfObjects(const std::string& frame) const {
  if (!scene_ || frame == scene_->frame) return;
  for (const auto& [name, stored] : objects_) {
    if (!stored.object.attached_link.empty()) continue;
    throw InputError("object '" + name + "' is fixed in frame '" + scene_->frame +
                     "', but reports would be in '" + frame +
                     "': the root link or fixed_frame has changed; remove the object, and add it "
                     "again afterwards");
  }
}

void SceneStore::update(const std::vector<SceneChange>& changes) {
  const std::lock_guard<std::mutex> lock(building_);
  if (!scene_) throw InputError("there is no robot yet; see the node's log and diagnostics");
  const std::string frame = scene_->frame;
  if (changes.empty()) return;
  const auto look_up = [&](const std::string& target, const std::string& source,
                           const ros::Time& stamp) {
    if (target != frame) requireLink(scene_->scene->robot(), target);
    const ros::Time now = transforms_.followClock();
    const auto fail = [&](const std::string& why) {
      throw InputError("TF does not know '" + source + "' in '" + target +
                       "': " + (now.isZero() ? NO_CLOCK : why));
    };
    TransformInput::Found found;
    try {
      found = scene_->tf_poses->lookUp(target, source, stamp);
    } catch (const InputError& error) {
      fail(error.what());
    }
    const std::string still = transforms_.clockDoubt();
    if (stamp.isZero() && !found.stamp.isZero() && !still.empty()) fail(still);
    return found.X_TS;
  };
  const auto require_link = [&](const std::string& link) {
    requireLink(scene_->scene->robot(), link);
  };
  const ObjectEdits edits =
      editsBy(changes, objects_, {frame, look_up, makeMeshLoader(), require_link});
  if (auto active = withAlike(edits)) {
    replace({std::move(active), {}, false});
    apply(edits, objects_);
    return;
  }
  SceneObjects objects = objects_;
  apply(edits, objects);
  Built built = build(parameters_, objects, {});
  built.may_keep_more = std::any_of(edits.begin(), edits.end(), [&](const auto& edit) {
    const auto before = objects_.find(edit.first);
    return before != objects_.end() && !before->second.object.attached_link.empty();
  });
  replace(std::move(built));
  objects_ = std::move(objects);
}

std::shared_ptr<ActiveScene> SceneStore::withAlike(const ObjectEdits& edits) {
  if (scene_->clouds) return nullptr;  // their filters know the objects
  const auto isOfParameters = [&](const auto& edit) {
    return parameters_.sources.config.floor && edit.first == parameters_.sources.config.floor->name;
  };
  if (std::any_of(edits.begin(), edits.end(), isOfParameters)) return nullptr;
  const auto scene = scene_->scene->withAlike(sceneChanges(edits, objects_), &cache_);
  if (!scene) return nullptr;
  auto active = std::make_shared<ActiveScene>(*scene_);
  active->scene = scene;
  active->open_meshes = scene->openMeshes();
  const auto isSame = [](const SceneBody& a, const SceneBody& b) { return a.body == b.body; };
  const auto &bodies = scene->bodies(), &before = scene_->scene->bodies();
  const bool are_same =
      std::equal(bodies.begin(), bodies.end(), before.begin(), before.end(), isSame);
  if (!are_same) {
    active->tf_poses = posesOf(*scene, active->frame, parameters_.sources.config.static_joints);
  }
  return active;
}

std::shared_ptr<const TfPoses> SceneStore::posesOf(
    const CollisionScene& scene, const std::string& frame,
    const std::vector<std::string>& static_joints) const {
  return std::make_shared<TfPoses>(transforms_, scene.robot(), scene.bodies(), frame,
                                   static_joints);
}

std::vector<std::string> SceneStore::changedDescriptions() {
  std::map<std::string, std::size_t> known;
  {
    const std::lock_guard<std::mutex> lock(building_);
    known = parameters_.descriptions;
  }
  return collision_pairs::changedDescriptions(private_node_, known);
}

std::vector<SceneObject> SceneStore::list() {
  const std::lock_guard<std::mutex> lock(building_);
  return listed(objects_, scene_ ? scene_->frame : std::string());
}

ActiveScenePtr SceneStore::restrictedTo(const Restriction& restriction) {
  if (restriction.empty()) return active();
  const std::lock_guard<std::mutex> lock(building_);
  if (!scene_) return nullptr;
  const auto known = std::find_if(restricted_.begin(), restricted_.end(),
                                  [&](const auto& kept) { return kept.first == restriction; });
  if (known != restricted_.end()) {
    std::rotate(known, known + 1, restricted_.end());
    return restricted_.back().second;
  }
  restricted_.emplace_back(restriction, build(parameters_, objects_, restriction).scene);
  if (restricted_.size() > KEPT_RESTRICTIONS) restricted_.erase(restricted_.begin());
  return restricted_.back().second;
}

void SceneStore::noteBroken(const std::vector<BrokenElement>& broken, ActiveScene& active) {
  std::set<std::string> links;
  for (const BrokenElement& element : broken) {
    links.insert(element.link);
    active.broken.push_back("link '" + element.link + "' is left out: " + element.reason);
    if (told_.insert(active.broken.back()).second) ROS_ERROR_STREAM(active.broken.back());
  }
  active.broken_links.assign(links.begin(), links.end());
}

std::shared_ptr<CloudSources> SceneStore::cloudsOf(const std::vector<CloudConfig>& configs,
                                                   const std::string& frame) {
  if (configs.empty()) return nullptr;
  if (scene_ && scene_->clouds && scene_->clouds->areOf(configs, frame)) return scene_->clouds;
  const auto filtered =
      private_node_.advertise<sensor_msgs::PointCloud2>("filtered_cloud", configs.size());
  return std::make_shared<CloudSources>(node_, configs,
                                        CloudSource::Context{transforms_, frame, filtered});
}

SceneStore::Built SceneStore::build(SceneParameters& parameters, const SceneObjects& objects,
                                    const Restriction& restriction) {
  auto active = std::make_shared<ActiveScene>();
  std::vector<RigidObject> present;
  for (const auto& entry : objects) present.push_back(entry.second.object);
  std::vector<BrokenElement> broken;
  SceneDescription description =
      describeScene(parameters.sources, std::move(present), restriction, broken);
  noteBroken(broken, *active);
  const ros::WallTime start = ros::WallTime::now();
  description.settings.progress = [start](std::size_t done, std::size_t total) {
    if ((ros::WallTime::now() - start).toSec() < 1.0) return;  // not worth a line
    ROS_INFO_STREAM_THROTTLE(1.0, "prepared " << done << " of " << total << " meshes");
  };
  active->scene = CollisionScene::build(description, &cache_);
  const CollisionScene& scene = *active->scene;
  active->warnings = parameters.warnings;
  active->open_meshes = scene.openMeshes();
  active->frame =
      parameters.fixed_frame.empty() ? scene.robot().links().front().name : parameters.fixed_frame;
  const auto& static_joints = parameters.sources.config.static_joints;
  active->tf_poses = posesOf(scene, active->frame, static_joints);
  active->clouds = cloudsOf(parameters.sources.config.clouds, active->frame);
  Built built;
  built.scene = active;
  if (active->clouds && restriction.empty()) {
    built.filters = active->clouds->filtersFor(description, scene, static_joints, &cache_);
  }
  return built;
}

}  // namespace collision_pairs
