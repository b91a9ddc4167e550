// The scene that the node works with at present.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "cloud_sources.h"
#include "collision_pairs/collision_scene.h"
#include "tf_poses.h"

namespace collision_pairs {

/// A scene with the node's data about it. Replaced as a whole; holders of the old one can go on.
struct ActiveScene {
  std::shared_ptr<const CollisionScene> scene;
  /// Links with geometry that could not be read: listed as left out in every report.
  std::vector<std::string> broken_links;
  /// What is wrong with them, a line each.
  std::vector<std::string> broken;
  /// Why no report of it is FREE, whatever the poses: a group or links that leave no pair, as a
  /// pattern with a slip of the pen does.
  std::vector<std::string> doubts;
  std::string frame;  ///< of reports and markers
  std::unique_ptr<TfPoses> tf_poses;
  /// What its clouds show; the next scene goes on with them. Null where it has none.
  std::shared_ptr<CloudSources> clouds;
};

/// Fills in the voxels of the scene's clouds at `now`; why they keep a report from being FREE.
inline std::vector<std::string> addVoxels(const ActiveScene& scene, const ros::Time& now,
                                          BodyPoses& poses) {
  if (!scene.clouds) return {};
  return scene.clouds->addVoxels(*scene.scene, now, poses);
}

using ActiveScenePtr = std::shared_ptr<const ActiveScene>;

}  // namespace collision_pairs
