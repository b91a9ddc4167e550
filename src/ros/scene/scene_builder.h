// Builds the scenes of the monitor.
#pragma once

#include <cstdint>
#include <functional>
#include <mutex>
#include <set>
#include <string>
#include <vector>

#include <ros/node_handle.h>
#include <ros/publisher.h>

#include "cloud_threads.h"
#include "live_monitor.h"

namespace collision_pairs {

/// Thread safe; one scene is built at a time, on the thread that asks for it. Nothing else waits
/// for that. A call that throws changes nothing.
class SceneBuilder {
 public:
  /// The monitor must outlive it. Topics of clouds are names relative to `node`. Each change is
  /// published on ~scene before the call that made it returns.
  SceneBuilder(const ros::NodeHandle& node, const ros::NodeHandle& private_node,
               LiveMonitor& monitor, CloudThreads& clouds);

  /// Reads the parameters again and keeps the objects. Throws InputError.
  void load();
  /// Applies the changes. Throws InputError.
  void update(const std::vector<SceneChange>& changes);
  /// What take(monitor, scene) returns for the active scene with this restriction in place of that
  /// of the parameters; with an empty one, for the active scene itself: of one instant, so that the
  /// scene is the one of the snapshot. The last few are kept. Throws InputError, also while there
  /// is none.
  using TakeSnapshot = std::function<Snapshot(const Monitor& monitor, const ActiveScenePtr& scene)>;
  Snapshot snapshot(const Restriction& restriction, const TakeSnapshot& take);

  /// The parameters with descriptions that have changed since they were read; none while there is
  /// no scene. Asks the parameter server. Throws InputError.
  std::vector<std::string> changedDescriptions();

 private:
  /// Runs the job that hand_out(scenes of the monitor) returns.
  template <class HandOut>
  ActiveScenePtr build(const HandOut& hand_out);
  void publishScene();
  bool noteObjects(bool are_some);

  ros::NodeHandle node_, private_node_;
  LiveMonitor& monitor_;
  CloudThreads& clouds_;
  std::mutex building_;         // guards what follows, and held while a scene is built
  std::set<std::string> told_;  // what was logged since the load() before succeeded
  bool is_loaded_ = false;
  ros::Publisher publisher_;
  std::uint64_t published_revision_ = 0;
  bool are_objects_noted_ = false;
};

}  // namespace collision_pairs
