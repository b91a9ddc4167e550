// The scene currently used by the node.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "cloud_sources.h"
#include "collision_pairs/collision_scene.h"
#include "tf_poses.h"

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
  std::string frame;  ///< of reports and markers
  std::shared_ptr<const TfPoses> tf_poses;  ///< of its bodies
  /// Sources of its clouds, which the next scene continues to use. Null if there are none.
  std::shared_ptr<CloudSources> clouds;
};

/// Fills in the voxels of the scene's clouds at `now`; returns why a report cannot be FREE.
inline std::vector<std::string> addVoxels(const ActiveScene& scene, const ros::Time& now,
                                          BodyPoses& poses) {
  if (!scene.clouds) return {};
  return scene.clouds->addVoxels(*scene.scene, now, poses);
}

/// The same for a request at a stamp (0: now). Its clouds are unknown: only the newest are kept.
inline std::vector<std::string> addVoxels(const ActiveScene& scene, const ros::Time& stamp,
                                          const ros::Time& now, BodyPoses& poses) {
  if (stamp.isZero()) return addVoxels(scene, now, poses);
  if (scene.scene->clouds().empty()) return {};
  return {"the request has a stamp, and only the newest clouds are kept: leave stamp at 0"};
}

using ActiveScenePtr = std::shared_ptr<const ActiveScene>;

}  // namespace collision_pairs
