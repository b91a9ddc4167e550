#include "scene_builder.h"

#include <optional>
#include <utility>

#include <ros/console.h>
#include <ros/master.h>
#include <ros/this_node.h>

#include "collision_pairs/input_error.h"
#include "collision_pairs/mesh_loader.h"
#include "parameters.h"
#include "scene_loader.h"
#include "scene_message.h"
#include "user_text.h"

namespace collision_pairs {
namespace {

constexpr std::uint32_t SCENES_IN_QUEUE = 100;  // none is to be missing in a recording
constexpr int MOST_BUILDS = 20;                 // of one restriction, while others change the scene
const char* const HAS_OBJECTS = "has_objects";  // parameter, for the next node of this name

}  // namespace

SceneBuilder::SceneBuilder(const ros::NodeHandle& node, const ros::NodeHandle& private_node,
                           LiveMonitor& monitor, CloudThreads& clouds)
    : node_(node),
      private_node_(private_node),
      monitor_(monitor),
      clouds_(clouds),
      publisher_(private_node_.advertise<Scene>("scene", SCENES_IN_QUEUE, true)) {
  XmlRpc::XmlRpcValue noted;
  are_objects_noted_ =
      readParameter(private_node_, HAS_OBJECTS, noted) && !(noted == XmlRpc::XmlRpcValue(false));
  monitor_.with([this](Monitor& of) { of.scenes().setObjectsLost(are_objects_noted_); });
}

template <class HandOut>
ActiveScenePtr SceneBuilder::build(const HandOut& hand_out) {
  SceneJob job = monitor_.with([&](Monitor& monitor) { return hand_out(monitor.scenes()); });
  const ros::WallTime start = ros::WallTime::now();
  job.run([start](std::size_t done, std::size_t total) {
    if ((ros::WallTime::now() - start).toSec() < 1.0) return;  // not worth a line
    ROS_INFO_STREAM_THROTTLE(1.0, "prepared " << done << " of " << total << " meshes");
  });
  const ActiveScenePtr scene = job.scene();
  for (const std::string& line : scene->missing()) {
    if (told_.insert(line).second) ROS_ERROR_STREAM(line);
  }
  for (const std::string& line : scene->scene->openMeshes()) {
    if (told_.insert(line).second) ROS_WARN_STREAM(line);
  }
  const bool is_taken = monitor_.with([&](Monitor& monitor) { return monitor.scenes().take(job); });
  if (!is_taken) throw InputError("the scene has changed meanwhile");  // only one builds at a time
  publishScene();
  return scene;
}

/// Each change once, in their order, since one is built at a time.
void SceneBuilder::publishScene() {
  const StoredScene scene =
      monitor_.with([](const Monitor& monitor) { return monitor.scenes().stored(); });
  if (scene.revision == published_revision_) return;  // nothing was changed
  published_revision_ = scene.revision;
  noteObjects(!scene.objects->empty() || scene.are_objects_lost);
  try {
    publisher_.publish(toMessage(scene));
  } catch (const std::exception& error) {  // the scene is checked nevertheless
    ROS_ERROR_STREAM("revision " << scene.revision << " of the scene is not on "
                                 << publisher_.getTopic() << ": " << error.what());
  }
}

/// On the parameter server, where the node is found to have had some when it is started anew. False
/// if the master does not answer.
bool SceneBuilder::noteObjects(bool are_some) {
  if (are_some == are_objects_noted_) return true;
  XmlRpc::XmlRpcValue request, response, payload;
  request[0] = ros::this_node::getName();
  request[1] = private_node_.resolveName(HAS_OBJECTS);
  request[2] = XmlRpc::XmlRpcValue(are_some);
  const bool waits_for_master = false;  // unlike NodeHandle::setParam()
  if (!ros::master::execute("setParam", request, response, payload, waits_for_master)) return false;
  are_objects_noted_ = are_some;
  return true;
}

void SceneBuilder::load() {
  const std::lock_guard<std::mutex> lock(building_);
  const ros::WallTime start = ros::WallTime::now();
  if (std::exchange(is_loaded_, false)) told_.clear();
  const PoseLimits limits =
      monitor_.with([](const Monitor& monitor) { return monitor.transforms().limits(); });
  SceneParameters parameters =
      readSceneParameters(node_, private_node_, limits, [this](const std::string& line) {
        if (told_.insert(line).second) ROS_WARN_STREAM(line);
      });
  const ActiveScenePtr active =
      build([&](const SceneStore& scenes) { return scenes.load(std::move(parameters)); });
  is_loaded_ = true;
  clouds_.follow();
  const CollisionScene& scene = *active->scene;
  ROS_INFO_STREAM("robot '" << scene.robot().name() << "': " << scene.models().size()
                            << " links with geometry to check, " << scene.elements().size()
                            << " elements, " << scene.bodies().size()
                            << " moving bodies, ready after "
                            << (ros::WallTime::now() - start).toSec() << " s");
  if (scene.unchecked().empty()) return;
  ROS_WARN_STREAM(scene.unchecked() << (scene.mayBeFree() ? ": the verdict can be FREE because of "
                                                            "~allow_empty_scene"
                                                          : ": the verdict is never FREE unless "
                                                            "~allow_empty_scene permits it"));
}

void SceneBuilder::update(const std::vector<SceneChange>& changes) {
  const AddedObjects added = readAdded(changes, makeMeshLoader());
  const std::lock_guard<std::mutex> lock(building_);
  // Before the node has them: it may be killed at once.
  const bool had_some = are_objects_noted_;
  if (!added.empty() && !noteObjects(true)) {
    throw InputError(
        "the ROS master does not answer, so " + private_node_.resolveName(HAS_OBJECTS) +
        " cannot be set, without which a node that is started anew would check without "
        "these objects; try again");
  }
  try {
    build([&](const SceneStore& scenes) { return scenes.update(changes, added); });
  } catch (...) {
    noteObjects(had_some);
    throw;
  }
  clouds_.follow();
}

Snapshot SceneBuilder::snapshot(const Restriction& restriction, const TakeSnapshot& take) {
  const auto hand_out = [&](SceneStore& scenes) { return scenes.restrictedTo(restriction); };
  for (int i = 0; i < MOST_BUILDS; ++i) {
    std::optional<Snapshot> snapshot;
    monitor_.with([&](Monitor& monitor) {
      const ActiveScenePtr scene = hand_out(monitor.scenes()).scene();
      if (scene) snapshot.emplace(take(monitor, scene));
    });
    if (snapshot) return std::move(*snapshot);
    const std::lock_guard<std::mutex> lock(building_);
    build(hand_out);
  }
  throw InputError("the scene changes faster than it can be restricted");
}

std::vector<std::string> SceneBuilder::changedDescriptions() {
  const auto parameters =
      monitor_.with([](Monitor& monitor) { return monitor.scenes().parameters(); });
  if (!parameters) return {};
  return collision_pairs::changedDescriptions(private_node_, parameters->descriptions);
}

}  // namespace collision_pairs
