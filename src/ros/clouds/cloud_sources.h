// All sources of ~clouds.
#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include <diagnostic_updater/diagnostic_updater.h>

#include "cloud_source.h"
#include "collision_pairs/scene_description.h"

namespace collision_pairs {

/// May be used from several threads.
class CloudSources {
 public:
  /// Throws InputError for an invalid topic name. Topics are resolved like those of `node`.
  CloudSources(const ros::NodeHandle& node, const std::vector<CloudConfig>& configs,
               const CloudSource::Context& context);

  /// True if these sources match the parameter and the frame.
  bool areOf(const std::vector<CloudConfig>& configs, const std::string& frame) const;

  /// Filters for this scene's robot, one per source, and their activation. Creating them may take
  /// as long as the scene, and throws InputError.
  using FollowedRobots = std::vector<std::shared_ptr<FollowedRobot>>;
  FollowedRobots filtersFor(const SceneDescription& description, const CollisionScene& scene,
                            const std::vector<std::string>& static_joints,
                            SceneCache* cache) const;
  void follow(FollowedRobots filters);

  /// Fills in the voxels of the scene's clouds at `now`; returns why a report cannot be FREE.
  std::vector<std::string> addVoxels(const CollisionScene& scene, const ros::Time& now,
                                     BodyPoses& poses) const;

  /// The views of all sources by name; null if unknown.
  std::map<std::string, CloudView> views(const ros::Time& now) const;

  void clear();
  void diagnose(diagnostic_updater::DiagnosticStatusWrapper& status) const;

 private:
  const CloudSource::Context context_;
  std::vector<std::unique_ptr<CloudSource>> sources_;
};

}  // namespace collision_pairs
