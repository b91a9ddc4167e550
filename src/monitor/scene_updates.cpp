#include "scene_updates.h"

#include <algorithm>
#include <set>
#include <utility>

#include "collision_pairs/input_error.h"
#include "geometry_conversions.h"
#include "object_conversions.h"
#include "user_text.h"

namespace collision_pairs {
namespace {

using Eigen::Isometry3d;

RigidObject readObject(const SceneObject& message, const MeshLoader& load_mesh) {
  if (message.name.empty()) throw InputError("it has no name");
  return toObject(message, load_mesh);
}

StoredObject storedAs(const SceneObject& message, RigidObject object) {
  StoredObject stored;
  stored.message = std::make_shared<const SceneObject>(message);
  stored.object = std::move(object);
  return stored;
}

void place(const Isometry3d& X_PO, const geometry_msgs::Pose& pose, StoredObject& stored) {
  stored.X_PO = X_PO;
  stored.pose = pose;
  stored.object.X_PO = requiredIsometry(pose);
}

void place(const Isometry3d& X_PO, StoredObject& stored) { place(X_PO, toPose(X_PO), stored); }

const std::string& parentFrame(const RigidObject& object, const std::string& world_frame) {
  return object.attached_link.empty() ? world_frame : object.attached_link;
}

class Updater {
 public:
  Updater(const SceneObjects& objects, const UpdateContext& context)
      : objects_(objects), context_(context) {}

  ObjectEdits takeEdits() {
    forgetRemoved();
    return std::move(edits_);
  }

  /// `added`: the object that it adds.
  void apply(const SceneChange& change, const RigidObject* added) {
    if (!change.object.touch_links.empty()) forgetRemoved();  // these may name what comes anew
    switch (change.operation) {
      case SceneChange::ADD:
        return add(change.object, *added);
      case SceneChange::MOVE:
        return move(change.object);
      case SceneChange::REMOVE:
        return remove(change.object.name);
      case SceneChange::ATTACH:
        return attach(change.object);
      case SceneChange::DETACH:
        return detach(change.object);
      case SceneChange::CLEAR:
        return clear();
      default:
        throw InputError("operation " + std::to_string(change.operation) +
                         " is unknown; use ADD 0, MOVE 1, REMOVE 2, ATTACH 3, DETACH 4 or CLEAR 5");
    }
  }

 private:
  /// As it is after the changes so far; null: there is none.
  const StoredObject* find(const std::string& name) const {
    const auto edit = edits_.find(name);
    if (edit != edits_.end()) return edit->second ? &*edit->second : nullptr;
    const auto found = objects_.find(name);
    return found != objects_.end() ? &found->second : nullptr;
  }

  std::vector<std::string> names() const {
    std::vector<std::string> names;
    for (const auto& entry : objects_) {
      if (edits_.count(entry.first) == 0) names.push_back(entry.first);
    }
    for (const auto& [name, object] : edits_) {
      if (object) names.push_back(name);
    }
    return names;
  }

  /// To be changed.
  StoredObject& known(const std::string& name) {
    if (const StoredObject* found = find(name)) {
      return *edits_.try_emplace(name, *found).first->second;
    }
    const std::vector<std::string> names = this->names();
    throw InputError("there is no such object" +
                     (names.empty() ? "; the scene has none" : didYouMean(name, names)));
  }

  void add(const SceneObject& message, const RigidObject& object) {
    if (!message.attached_link.empty()) context_.require_link(message.attached_link);
    StoredObject stored = storedAs(message, object);
    place(poseOf(message, parentFrame(object)), stored);
    edits_[message.name] = std::move(stored);
  }

  void move(const SceneObject& message) {
    StoredObject& stored = known(message.name);
    place(poseOf(message, parentFrame(stored.object)), stored);
  }

  void remove(const std::string& name) {
    known(name);
    edits_[name].reset();
    removed_.insert(name);
  }

  /// Other objects' touch links must not apply to a new object of the same name. For all at once:
  /// the monitor waits, and a request may remove a hundred thousand.
  void forgetRemoved() {
    if (removed_.empty()) return;
    const auto isRemoved = [&](const std::string& name) { return removed_.count(name) > 0; };
    for (const auto& [other, stored] : objects_) {
      const auto& links = stored.object.touch_links;
      if (std::any_of(links.begin(), links.end(), isRemoved)) edits_.try_emplace(other, stored);
    }
    for (auto& [other, stored] : edits_) {
      if (!stored) continue;
      auto& links = stored->object.touch_links;
      links.erase(std::remove_if(links.begin(), links.end(), isRemoved), links.end());
    }
    removed_.clear();
  }

  void clear() {
    edits_.clear();
    for (const auto& entry : objects_) edits_[entry.first].reset();
  }

  void attach(const SceneObject& message) {
    StoredObject& stored = known(message.name);
    if (message.attached_link.empty()) throw InputError("attached_link is empty");
    context_.require_link(message.attached_link);
    hangOn(message.attached_link, stored);
    stored.object.touch_links = message.touch_links;
  }

  // The touch links that applied while it was attached are replaced.
  void detach(const SceneObject& message) {
    StoredObject& stored = known(message.name);
    hangOn("", stored);
    stored.object.touch_links = message.touch_links;
  }

  // It keeps its current pose.
  void hangOn(const std::string& link, StoredObject& stored) {
    RigidObject& object = stored.object;
    if (object.attached_link.empty() && link.empty()) throw InputError("it is not attached");
    const std::string before = parentFrame(object);
    object.attached_link = link;
    place(pose(parentFrame(object), before, ros::Time()) * stored.X_PO, stored);
  }

  const std::string& parentFrame(const RigidObject& object) const {
    return collision_pairs::parentFrame(object, context_.world_frame);
  }

  Isometry3d poseOf(const SceneObject& message, const std::string& parent) const {
    const Isometry3d X_FO = requiredIsometry(message.pose);
    const std::string frame = withoutLeadingSlash(message.header.frame_id);
    return pose(parent, frame.empty() ? context_.world_frame : frame, message.header.stamp) * X_FO;
  }

  Isometry3d pose(const std::string& target, const std::string& source,
                  const ros::Time& stamp) const {
    return target == source ? Isometry3d::Identity() : context_.look_up(target, source, stamp);
  }

  const SceneObjects& objects_;
  const UpdateContext& context_;
  ObjectEdits edits_;
  std::set<std::string> removed_;  // that touch links may still name
};

/// Calls use(i); adds the change to errors.
template <class Use>
void forEachOf(const std::vector<SceneChange>& changes, const Use& use) {
  for (std::size_t i = 0; i < changes.size(); ++i) {
    try {
      use(i);
    } catch (const InputError& error) {
      throw InputError("changes[" + std::to_string(i) + "], object '" + changes[i].object.name +
                       "': " + error.what());
    }
  }
}

}  // namespace

AddedObjects readAdded(const std::vector<SceneChange>& changes, const MeshLoader& load_mesh) {
  AddedObjects added;
  forEachOf(changes, [&](std::size_t i) {
    if (changes[i].operation != SceneChange::ADD) return;
    added[i] = readObject(changes[i].object, load_mesh);
  });
  return added;
}

ObjectEdits editsBy(const std::vector<SceneChange>& changes, const AddedObjects& added,
                    const SceneObjects& objects, const UpdateContext& context) {
  Updater updater(objects, context);
  forEachOf(changes, [&](std::size_t i) {
    const auto object = added.find(i);
    updater.apply(changes[i], object == added.end() ? nullptr : &object->second);
  });
  return updater.takeEdits();
}

void apply(const ObjectEdits& edits, SceneObjects& objects) {
  for (const auto& [name, object] : edits) {
    if (object) {
      objects[name] = *object;
    } else {
      objects.erase(name);
    }
  }
}

SceneChanges sceneChanges(const ObjectEdits& edits, const SceneObjects& objects) {
  SceneChanges changes;
  for (const auto& [name, object] : edits) {
    if (object) {
      changes.objects.push_back(object->object);
    } else if (objects.count(name) > 0) {
      changes.removed.push_back(name);
    }
  }
  return changes;
}

std::vector<SceneObject> listed(const SceneObjects& objects, const std::string& world_frame) {
  std::vector<SceneObject> list;
  list.reserve(objects.size());
  for (const auto& [name, stored] : objects) {
    list.push_back(*stored.message);
    SceneObject& message = list.back();
    message.header = std_msgs::Header();
    message.header.frame_id = parentFrame(stored.object, world_frame);
    message.pose = stored.pose;
    message.attached_link = stored.object.attached_link;
    message.touch_links = stored.object.touch_links;
  }
  return list;
}

SceneObjects readListed(const std::vector<SceneObject>& list, const std::string& world_frame,
                        const MeshLoader& load_mesh) {
  SceneObjects objects;
  for (const SceneObject& message : list) {
    try {
      StoredObject stored = storedAs(message, readObject(message, load_mesh));
      place(requiredIsometry(message.pose), message.pose, stored);
      const std::string& parent = parentFrame(stored.object, world_frame);
      if (message.header.frame_id != parent) {
        throw InputError("its pose is in frame '" + message.header.frame_id +
                         "', but must be in '" + parent + "'");
      }
      if (!objects.emplace(message.name, std::move(stored)).second) {
        throw InputError("it is listed twice");
      }
    } catch (const InputError& error) {
      throw InputError("object '" + message.name + "': " + error.what());
    }
  }
  return objects;
}

}  // namespace collision_pairs
