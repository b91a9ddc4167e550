// What is known of robot and surroundings, from everything that was received.
#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <tf2_msgs/TFMessage.h>

#include "collision_pairs/closing_motion.h"
#include "scene_store.h"
#include "snapshot.h"
#include "transform_input.h"

namespace collision_pairs {

/// Takes in transforms, clouds and scenes as they arrive, and gives out snapshots. It owns no
/// thread, reads no clock and asks nobody: what it says depends on its calls alone, whose time is
/// that of the last advance(). Work that takes long is handed out as jobs, which come back as
/// events: SceneStore, CloudSource. Not thread safe.
class Monitor {
 public:
  /// With the prepared geometry of another one, if it is given.
  explicit Monitor(const TransformSettings& settings, std::shared_ptr<SceneCache> cache = nullptr)
      : transforms_(settings), scenes_(transforms_, std::move(cache)) {}
  Monitor(const Monitor&) = delete;  // its parts refer to each other

  /// It is that time now.
  void advance(const Now& now) { transforms_.followClock(now); }
  void take(const tf2_msgs::TFMessage& message, bool is_static, const std::string& publisher) {
    transforms_.take(message, is_static, transforms_.now(), publisher);
  }
  SceneStore& scenes() { return scenes_; }
  const SceneStore& scenes() const { return scenes_; }
  const TransformInput& transforms() const { return transforms_; }
  void clearClouds() {
    if (!scenes_.active()) return;
    for (const auto& cloud : scenes_.active()->clouds) cloud->clear();
  }

  /// Of `scene`, which is the active one or a restricted one; if it was replaced since, the
  /// answer is UNKNOWN: what is attached may have changed, and the clouds know. At the newest
  /// instant for which all poses are known, leaving out those that are too old; with a stamp other
  /// than 0, at that one, and UNKNOWN if the scene was another one then.
  Snapshot at(const ActiveScenePtr& scene, const ros::Time& stamp = ros::Time()) const;
  /// The same for positions of named joints; joints that are not named are where TF has them.
  /// Throws InputError as JointQuery does.
  Snapshot withJoints(const ActiveScenePtr& scene, const std::vector<std::string>& names,
                      const ros::Time& stamp) const;
  /// The same for positions that were measured now: all else is as new as it can be. `moved`: the
  /// joints among them that are about to move.
  Snapshot withMeasured(const ActiveScenePtr& scene, const std::vector<std::string>& names,
                        const std::vector<std::string>& moved) const;

  /// Where the bodies in the pairs of the report, which is of the snapshot, were a little earlier.
  EarlierPoses before(const Snapshot& snapshot, const CollisionReport& report) const;

 private:
  Snapshot begin(const ActiveScenePtr& scene, const ros::Time& stamp = ros::Time()) const;
  void addClock(Snapshot& snapshot) const;
  void addClouds(const ros::Time& stamp, Snapshot& snapshot) const;
  /// At stamp 0, those of one instant are at that of latest poses, others at the newest of each.
  /// `moved`: as withMeasured() has it; null: of a request, all that are named.
  void addJoints(const std::vector<std::string>& names, const ros::Time& stamp,
                 const std::vector<std::string>* moved, Snapshot& snapshot) const;
  void addProblems(const std::vector<std::string>& problems, Snapshot& snapshot) const;

  TransformInput transforms_;
  SceneStore scenes_;
};

}  // namespace collision_pairs
