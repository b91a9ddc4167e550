// Holds the active scene, and replaces it.
#pragma once

#include <memory>
#include <mutex>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <ros/node_handle.h>

#include "cloud_sources.h"
#include "collision_pairs/collision_scene.h"
#include "scene_loader.h"
#include "scene_updates.h"
#include "tf_poses.h"
#include "transform_input.h"

namespace collision_pairs {

/// A scene with the node's data about it. Replaced as a whole; holders of the old one can continue.
struct ActiveScene {
  std::shared_ptr<const CollisionScene> scene;
  /// Links with geometry that could not be read: listed as left out in every report.
  std::vector<std::string> broken_links;
  /// Their errors, one line each.
  std::vector<std::string> broken;
  /// Of its parameters; they concern no pair.
  std::vector<std::string> warnings;
  /// CollisionScene::openMeshes().
  std::vector<std::string> open_meshes;
  std::string frame;                        ///< of reports and markers
  std::shared_ptr<const TfPoses> tf_poses;  ///< of its bodies
  /// Sources of its clouds, which the next scene continues to use. Null if there are none.
  std::shared_ptr<CloudSources> clouds;
};

using ActiveScenePtr = std::shared_ptr<const ActiveScene>;

/// Fills in the voxels of the scene's clouds at `now`; returns why a report cannot be FREE.
std::vector<std::string> addVoxels(const ActiveScene& scene, const ros::Time& now,
                                   BodyPoses& poses);
/// The same for a request at a stamp (0: now). Its clouds are unknown: only the newest are kept.
std::vector<std::string> addVoxels(const ActiveScene& scene, const ros::Time& stamp,
                                   const ros::Time& now, BodyPoses& poses);

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
    bool may_keep_more = true;             ///< they, of the points: see CloudSource::follow()
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
  std::set<std::string> told_;  // broken elements logged since the last load()
  std::vector<std::pair<Restriction, ActiveScenePtr>> restricted_;  // of scene_; the newest last

  mutable std::mutex reading_;  // guards scene_
  ActiveScenePtr scene_;
};

}  // namespace collision_pairs
