// Holds the active scene, and replaces it.
#pragma once

#include <mutex>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <ros/node_handle.h>

#include "active_scene.h"
#include "parameters.h"
#include "scene_loader.h"
#include "scene_updates.h"
#include "transform_input.h"

namespace collision_pairs {

/// May be used from several threads: whoever asks for the scene never waits for one that is being
/// built. What throws changes nothing.
class SceneStore {
 public:
  /// The transforms must outlive it. max_pose_age [s] holds for the frames that objects are placed
  /// in.
  SceneStore(const ros::NodeHandle& private_node, TransformInput& transforms, double max_pose_age);

  /// Null while there is none.
  ActiveScenePtr active() const;

  /// Reads the parameters anew; the objects stay. Throws InputError, also where some stand still
  /// and the frame of the reports would be another.
  void load();

  /// Applies the changes. Throws InputError.
  void update(const std::vector<SceneChange>& changes);

  /// The objects as they are.
  std::vector<SceneObject> list();

  /// The active scene with these pairs instead of those that the parameters restrict it to; with
  /// an empty restriction, as it is. The last few are kept. Null while there is none. Throws
  /// InputError.
  ActiveScenePtr restrictedTo(const Restriction& restriction);

 private:
  struct Built {
    std::shared_ptr<ActiveScene> scene;
    CloudSources::RobotFilters filters;  ///< of its clouds
  };
  Built build(SceneParameters& parameters, const SceneObjects& objects,
              const Restriction& restriction);
  /// Each goes to the log once.
  void noteBroken(const std::vector<BrokenElement>& broken, ActiveScene& active);
  std::shared_ptr<CloudSources> cloudsOf(const std::vector<CloudConfig>& configs,
                                         const std::string& frame);
  void replace(Built built);
  void requireFrameOfObjects(const std::string& frame) const;

  ros::NodeHandle private_node_;
  TransformInput& transforms_;
  const double max_pose_age_;

  std::mutex building_;  // guards all but scene_
  SceneCache cache_;
  SceneParameters parameters_;
  SceneObjects objects_;
  MeshLoader load_mesh_;
  std::set<std::string> told_;  // what is broken, since the last load()
  std::vector<std::pair<Restriction, ActiveScenePtr>> restricted_;  // of scene_; the newest last

  mutable std::mutex reading_;  // guards scene_
  ActiveScenePtr scene_;
};

}  // namespace collision_pairs
