// What is known at one instant.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <ros/time.h>

#include "collision_pairs/body_poses.h"
#include "joint_query.h"
#include "scene_store.h"

namespace collision_pairs {

/// The input of every check that the node makes. A Monitor makes it, and only a Monitor, so that no
/// reason is left out why the answer cannot be FREE: `poses.unknown_because`.
struct Snapshot {
  ActiveScenePtr scene;
  /// The instant of the poses; the time at which it was made, if all that are known are static.
  ros::Time stamp;
  bool is_static = false;  ///< all known poses are
  /// With the voxels of the scene's clouds, and with every reason why the answer cannot be FREE.
  /// With `joints`, without poses.
  BodyPoses poses;
  /// Poses for positions of joints that were asked for.
  std::optional<JointQuery> joints;
  /// Bodies looked up in TF, and those of them that are known.
  std::size_t nb_asked = 0, nb_found = 0;
  std::vector<std::string> suspect_clouds;  ///< names of those that poses.unknown_because are about
  /// Of poses.unknown_because: why a link has no pose; empty: all have one.
  std::string first_left_out;
  /// Seconds, of the oldest cloud; the stamp's own if there is none.
  double oldest_cloud = 0.0;

  bool isKnown() const { return nb_found > 0 || nb_asked == 0; }
};

}  // namespace collision_pairs
