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

/// Thread safe. Getting the active scene never waits for one that is being built. A call that
/// throws changes nothing.
class SceneStore {
 public:
  /// The transforms must outlive it.
  /// Topics of clouds are names relative to `node`.
  SceneStore(const ros::NodeHandle& node, const ros::NodeHandle& private_node,
             TransformInput& transforms);

  /// Null while there is none.
  ActiveScenePtr active() const;

  /// Reads the parameters again and keeps the objects. Throws InputError, also if there are static
  /// objects and the frame of the reports would change.
  void load();

  /// Applies the changes. Throws InputError.
  void update(const std::vector<SceneChange>& changes);

  /// The parameters with descriptions that have changed since they were read; none while there is
  /// no scene. Asks the parameter server. Throws InputError.
  std::vector<std::string> changedDescriptions();

  /// All current objects.
  std::vector<SceneObject> list();

  /// The active scene with this restriction in place of that of the parameters; with an empty one,
  /// the active scene itself. The last few are cached. Null while there is none. Throws InputError.
  ActiveScenePtr restrictedTo(const Restriction& restriction);

 private:
  struct Built {
    std::shared_ptr<ActiveScene> scene;
    CloudSources::FollowedRobots filters;  ///< of its clouds
  };
  Built build(SceneParameters& parameters, const SceneObjects& objects,
              const Restriction& restriction);
  /// Null if the scene has to be built anew.
  std::shared_ptr<ActiveScene> withAlike(const ObjectEdits& edits);
  std::shared_ptr<const TfPoses> posesOf(const CollisionScene& scene, const std::string& frame,
                                         const std::vector<std::string>& static_joints) const;
  /// Logs each broken element once.
  void noteBroken(const std::vector<BrokenElement>& broken, ActiveScene& active);
  std::shared_ptr<CloudSources> cloudsOf(const std::vector<CloudConfig>& configs,
                                         const std::string& frame);
  void replace(Built built);
  void requireFrameOfObjects(const std::string& frame) const;

  ros::NodeHandle node_, private_node_;
  TransformInput& transforms_;

  std::mutex building_;  // guards all but scene_
  SceneCache cache_;
  SceneParameters parameters_;
  SceneObjects objects_;
  MeshLoader load_mesh_;
  std::set<std::string> told_;  // broken elements logged since the last load()
  std::vector<std::pair<Restriction, ActiveScenePtr>> restricted_;  // of scene_; the newest last

  mutable std::mutex reading_;  // guards scene_
  ActiveScenePtr scene_;
};

}  // namespace collision_pairs
