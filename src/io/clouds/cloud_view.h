// The voxels of a cloud source at an instant, and whether they permit the verdict FREE.
#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "cloud_config.h"
#include "collision_pairs/collision_scene.h"
#include "collision_pairs/occupied_voxels.h"

namespace collision_pairs {

/// The state of a cloud source.
struct LatestCloud {
  std::shared_ptr<const OccupiedVoxels> voxels;  ///< of the last cloud used; null: none yet
  double stamp = 0.0;                            ///< of that cloud, in seconds
  std::string problem;    ///< why the last cloud was refused; empty: it was used
  std::string warning;    ///< about the last cloud, which was used
  std::string may_touch;  ///< CloudProcessor::mayTouch()
};

struct CloudView {
  /// Null: unknown or too old.
  std::shared_ptr<const OccupiedVoxels> voxels;
  double stamp = 0.0;  ///< of the cloud that they are of, in seconds
  /// Why the verdict cannot be FREE; empty if the source is up to date and complete.
  std::string problem;
  /// For people; it does not affect the verdict.
  std::string warning;
};

/// `now` in seconds, on the clock of the stamps. `topic`: as resolved, where clouds are awaited.
CloudView viewOf(const CloudConfig& config, const LatestCloud& latest, double now,
                 const std::string& topic);

struct SuspectCloud {
  std::string cloud, why;
};

/// Fills in the voxels of the scene's clouds, in its order, from views by name, and adds to the
/// reasons of `poses`, which it returns, too. A cloud without a view is unknown.
std::vector<SuspectCloud> addVoxels(const std::map<std::string, CloudView>& views,
                                    const CollisionScene& scene, BodyPoses& poses);

/// "; the last was refused: …", or empty.
std::string refusalOf(const LatestCloud& latest);

}  // namespace collision_pairs
