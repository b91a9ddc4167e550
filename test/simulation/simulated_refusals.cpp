// What a SimulatedNode must refuse, with words that name what is wrong: changes of the scene that
// cannot be made now, and scenes that cannot be loaded.
#include <functional>

#include "object_messages.h"
#include "scene_message.h"
#include "simulated_node.h"

namespace simulation {
namespace {

SceneChange changeOf(std::uint8_t operation, const std::string& name, const std::string& link) {
  SceneChange change;
  change.operation = operation;
  change.object.name = name;
  change.object.attached_link = link;
  change.object.pose = poseAt(1.0, 2.0, 3.0);
  change.object.primitives = {primitive(shape_msgs::SolidPrimitive::SPHERE, {0.1})};
  return change;
}

}  // namespace

void SimulatedNode::requireRefusal(const std::vector<std::string>& words,
                                   const std::function<void()>& attempt) {
  std::string said;
  try {
    attempt();
  } catch (const InputError& error) {
    said = error.what();
  }
  for (const std::string& word : words) {
    if (said.find(word) != std::string::npos) continue;
    fail("not refused because '" + word + "', but: '" + said + "'");
  }
}

void SimulatedNode::requestWrong() {
  const SceneChange add = changeOf(SceneChange::ADD, "x", "");
  const SceneChange remove = changeOf(SceneChange::REMOVE, "x", "");
  const SceneChange clear = changeOf(SceneChange::CLEAR, "", "");
  const SceneChange move = changeOf(SceneChange::MOVE, "x", "");
  const auto refuses = [&](const std::vector<SceneChange>& changes,
                           std::vector<std::string> words) {
    const std::size_t last = changes.size() - 1;
    words.push_back("changes[" + std::to_string(last) + "], object '" + changes[last].object.name);
    requireRefusal(words, [&] {
      monitor_.scenes().update(changes, readAdded(changes, noMeshLoader())).run();
    });
  };
  const std::string none = "there is no such object";
  refuses({move}, {none, objects_.empty() ? "the scene has none" : "did you mean"});
  refuses({add, remove, move}, {none});
  refuses({add, changeOf(SceneChange::MOVE, "xy", "")}, {none, "did you mean 'x'"});
  refuses({add, clear, move}, {none, "the scene has none"});
  for (const auto& [name, object] : objects_) {
    refuses({clear, changeOf(SceneChange::MOVE, name, "")}, {none, "the scene has none"});
    if (object.link < 0) refuses({changeOf(SceneChange::DETACH, name, "")}, {"it is not attached"});
  }
  refuses({add, changeOf(SceneChange::DETACH, "x", "")}, {"it is not attached"});
  refuses({add, changeOf(SceneChange::ATTACH, "x", "l99")}, {"'l99' is not a link"});
  refuses({changeOf(SceneChange::ADD, "x", "l99")}, {"'l99' is not a link"});
  SceneChange lost = add;
  lost.object.header.frame_id = "unheard";
  refuses({lost},
          {"TF does not know 'unheard' in '" + setup_.frame() + "'", ros_ == 0 ? NO_CLOCK : ""});
  // No change makes no other scene.
  SceneJob same = monitor_.scenes().update({}, {});
  same.run();
  if (!monitor_.scenes().take(same) || monitor_.scenes().active()->revision != revision_) {
    fail("no change makes another scene");
  }
  requestWrongScenes();
}

/// Where the root hangs on itself, nothing else has a place.
void SimulatedNode::requestInCycle() {
  if (setup_.fixed_frame >= 0 || !knowledge_.isCycle(ros_)) return;
  std::vector<std::string> frames;
  if (is_camera_told_) frames.push_back("camera");
  for (int i = 0; i < static_cast<int>(setup_.links.size()); ++i) frames.push_back(linkName(i));
  for (const std::string& frame : frames) {
    SceneChange change = changeOf(SceneChange::ADD, "x", "");
    change.object.header.frame_id = frame;
    requireRefusal({"TF does not know '" + frame + "'", "form a cycle"}, [&] {
      monitor_.scenes().update({change}, readAdded({change}, noMeshLoader()));
    });
  }
}

void SimulatedNode::requestWrongScenes() {
  Scene frameless = toMessage(monitor_.scenes().stored());
  frameless.header.frame_id.clear();
  requireRefusal({"scene of revision " + std::to_string(revision_), "header.frame_id is empty"},
                 [&] { objectsOf(frameless, noMeshLoader()); });
  SceneParameters strange = parameters(settings_);
  strange.sources.readSettings({"settings", "static_joints: [none]"});
  requireRefusal({"static_joints", "'none'"},
                 [&] { monitor_.scenes().load(std::move(strange)).run(); });
  // Objects that stand would be elsewhere in another frame.
  SceneParameters moved = parameters(settings_);
  moved.fixed_frame = "elsewhere";
  SceneJob job = monitor_.scenes().load(std::move(moved));
  const auto standing = std::find_if(objects_.begin(), objects_.end(),
                                     [](const auto& entry) { return entry.second.link < 0; });
  if (standing == objects_.end()) {
    job.run();
  } else {
    requireRefusal({"is fixed in frame '" + setup_.frame() + "'", "'elsewhere'"},
                   [&] { job.run(); });
  }
}

/// It says what is there.
void SimulatedNode::judgeListed(const Scene& message) {
  if (message.header.frame_id != setup_.frame()) fail("a scene's message has another frame");
  if (message.objects.size() != objects_.size()) return fail("a scene's message has others");
  for (const SceneObject& said : message.objects) {
    const auto known = objects_.find(said.name);
    if (known == objects_.end()) return fail("a scene's message has another object");
    const PlainObject& object = known->second;
    const std::string link = object.link < 0 ? "" : linkName(object.link);
    const Eigen::Vector3d p = inSpace(object.X_PO);
    const auto& at = said.pose.position;
    const bool is_there = (Eigen::Vector3d(at.x, at.y, at.z) - p).norm() < 1e-5;
    const bool is_in_frame = said.header.frame_id == (link.empty() ? setup_.frame() : link);
    if (said.attached_link != link || !is_in_frame || !is_there || said.primitives.size() != 1 ||
        said.touch_links.size() != object.touches.size() + object.touched_objects.size()) {
      fail("a scene's message has " + said.name + " elsewhere");
    }
  }
}

}  // namespace simulation
