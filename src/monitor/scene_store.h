// The scene that is checked, and what replaces it.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "cloud_source.h"
#include "collision_pairs/collision_scene.h"
#include "scene_sources.h"
#include "scene_updates.h"
#include "tf_poses.h"

namespace collision_pairs {

/// What the parameters say of the scene.
struct SceneParameters {
  SceneSources sources;
  /// By name, before it is resolved: a hash of each description; of one that is not there too.
  std::map<std::string, std::size_t> descriptions;
  std::string fixed_frame;  ///< empty: the robot's root link
  /// Parameters in the node's namespace that are none of its own, and leave no pair out.
  std::vector<std::string> warnings;
  std::vector<std::string> cloud_topics;  ///< of sources.config.clouds, resolved: for messages
};

/// A scene with what belongs to it. Replaced as a whole; holders of the old one can continue.
struct ActiveScene {
  std::shared_ptr<const CollisionScene> scene;
  /// Of its parameters; they concern no pair.
  std::vector<std::string> warnings;
  std::string frame;                        ///< of reports and markers
  std::shared_ptr<const TfPoses> tf_poses;  ///< of its bodies
  /// Sources of its clouds, in the order of the parameters; the next scene continues to use them.
  std::vector<std::shared_ptr<CloudSource>> clouds;
  /// What it checks against clouds and the store's scene does not: what clouds show beside these is
  /// not followed.
  std::vector<std::string> not_followed;
  std::uint64_t revision = 0;  ///< of the store's scene, of which it is one

  /// CollisionScene::missing(), one line for each reason.
  std::vector<std::string> missing() const;
};

using ActiveScenePtr = std::shared_ptr<const ActiveScene>;

/// All that makes the scene of a store, as of one instant. Large parts are shared.
struct StoredScene {
  std::shared_ptr<const SceneParameters> parameters;  ///< null: there is none
  std::shared_ptr<const SceneObjects> objects;
  std::string frame;              ///< of the reports
  std::uint64_t revision = 0;     ///< number of scenes so far
  ros::Time since;                ///< when it was taken
  bool are_objects_lost = false;  ///< see SceneStore::setObjectsLost()
};

/// A scene that is being built. The store hands it out, anyone runs it on any thread, one at a
/// time, and the store takes it back.
class SceneJob {
 public:
  using Progress = std::function<void(std::size_t done, std::size_t total)>;
  /// Takes as long as its new meshes are large. `progress` counts these. Throws InputError: then
  /// there is nothing to take back.
  void run(const Progress& progress = nullptr);

  /// Null before run().
  ActiveScenePtr scene() const { return built_; }

 private:
  friend class SceneStore;
  enum class Kind { LOAD, UPDATE, RESTRICT };

  explicit SceneJob(Kind kind) : kind_(kind) {}
  bool changeBefore(const SceneObjects& objects);
  std::shared_ptr<ActiveScene> build(const Progress& progress);
  void requireFrameOfObjects(const std::string& frame) const;
  std::shared_ptr<const TfPoses> posesOf(const CollisionScene& scene,
                                         const std::string& frame) const;
  std::uint64_t revisionOfResult() const { return revision_ + (kind_ == Kind::RESTRICT ? 0 : 1); }

  Kind kind_;
  std::uint64_t revision_ = 0;
  const TransformInput* transforms_ = nullptr;
  std::shared_ptr<SceneParameters> parameters_;
  std::shared_ptr<SceneCache> cache_;
  ActiveScenePtr before_;
  std::shared_ptr<const SceneObjects> objects_;  ///< before the edits; by run() after them
  ObjectEdits edits_;
  Restriction restriction_;
  bool replaces_objects_ = false;
  bool clears_objects_ = false;
  bool may_keep_more_ = true;  ///< filters of clouds, of the points: see CloudSource::follow()
  std::shared_ptr<ActiveScene> built_;
  std::vector<std::shared_ptr<FollowedRobot>> followed_;  ///< of each cloud
  std::vector<std::pair<Restriction, std::shared_ptr<ActiveScene>>> replaced_;
};

/// Not thread safe. A job changes nothing until it is taken back.
class SceneStore {
 public:
  /// The transforms must outlive it. `cache`: null for a new one.
  explicit SceneStore(const TransformInput& transforms, std::shared_ptr<SceneCache> cache = nullptr)
      : transforms_(transforms), cache_(cache ? cache : std::make_shared<SceneCache>()) {}

  /// Null while there is none.
  ActiveScenePtr active() const { return scene_; }
  const std::shared_ptr<SceneParameters>& parameters() const { return parameters_; }
  /// All current objects.
  const std::shared_ptr<const SceneObjects>& objects() const { return objects_; }
  /// False: it was replaced since.
  bool isCurrent(const ActiveScene& scene) const { return scene.revision == revision_; }

  StoredScene stored() const;

  /// When the newest scene was taken; 0: there is none, or the clock went back since.
  ros::Time since() const {
    return since_jumps_ == transforms_.nbClockJumps() ? since_ : ros::Time();
  }

  /// Objects that only a node before this one knew are lost: nothing is FREE until an update with
  /// CLEAR is taken.
  void setObjectsLost(bool are_lost) { are_objects_lost_ = are_lost; }
  bool areObjectsLost() const { return are_objects_lost_; }

  /// With new parameters. The objects are replaced by those given, or kept: then its run() throws
  /// InputError also if there are static ones and the frame of the reports would change.
  SceneJob load(SceneParameters parameters, std::optional<SceneObjects> objects = {}) const;
  /// Throws InputError. `added`: of the changes.
  SceneJob update(const std::vector<SceneChange>& changes, const AddedObjects& added) const;
  /// Of the scene that there is.
  SceneJob change(ObjectEdits edits) const;
  /// With this restriction in place of that of the parameters. If it is known, or empty, scene() is
  /// there at once. Throws InputError while there is no scene.
  SceneJob restrictedTo(const Restriction& restriction);

  /// False: the scene has changed since the job was handed out, and it is refused. What is replaced
  /// is freed with the job.
  bool take(SceneJob& job);

 private:
  SceneJob job(SceneJob::Kind kind) const;
  Eigen::Isometry3d lookUp(const std::string& target, const std::string& source,
                           const ros::Time& stamp) const;
  void follow(SceneJob& job);

  const TransformInput& transforms_;
  std::shared_ptr<ActiveScene> scene_;
  std::uint64_t revision_ = 0;
  ros::Time since_;
  unsigned since_jumps_ = 0;  // of the clock, then
  bool are_objects_lost_ = false;
  std::shared_ptr<SceneParameters> parameters_;
  std::shared_ptr<SceneCache> cache_;
  std::shared_ptr<const SceneObjects> objects_ = std::make_shared<const SceneObjects>();
  /// Of scene_; the newest last.
  std::vector<std::pair<Restriction, std::shared_ptr<ActiveScene>>> restricted_;
};

}  // namespace collision_pairs
