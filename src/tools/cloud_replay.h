// Recorded point clouds as obstacles, for each row of the table.
#pragma once

#include <cstdint>
#include <deque>
#include <string>
#include <utility>
#include <vector>

#include "bag_clouds.h"
#include "bag_poses.h"
#include "cloud_gatherer.h"
#include "cloud_view.h"
#include "collision_pairs/collision_scene.h"

namespace collision_pairs {

/// Message: the bag has changed since it was indexed.
extern const char* const BAG_CHANGED;

/// Processes the clouds of a bag as the node does: each is placed, cropped,
/// filtered and gathered at its own stamp. Reads one at a time, in the order of the file; keeps
/// voxels that apply only from a later row on.
class CloudReplay {
 public:
  /// Index, scene and poses must outlive it. Clouds in no pair of the scene are not read. `configs`
  /// are those of the topics of the index.
  CloudReplay(const BagCloudIndex& index, const std::vector<CloudConfig>& configs,
              const SceneDescription& description, const CollisionScene& scene,
              const BagPoses& poses);

  /// Adds the bag's next message; views before `next_row` must no longer be needed. Throws
  /// InputError if it is not the bag of the index, or too many clouds are waiting for a row.
  void take(const RawMessage& raw, StampNs next_row);
  /// True if no message still to be added affects that instant.
  bool isReady(StampNs row) const { return least_since_[nb_taken_] > row; }

  /// Writes the clouds' voxels at that instant to poses.voxels, and adds to its doubts, which it
  /// returns, too.
  std::vector<CloudDoubt> addVoxels(StampNs row, BodyPoses& poses);

  /// Number of refused clouds of each source and the reason for the first, one sentence each; and
  /// of those that were used but showed nothing.
  std::vector<std::string> refusals() const;

 private:
  struct Source {
    CloudConfig config;
    CloudGatherer gatherer;
    RobotFilter filter;
    bool is_checked;
    LatestCloud latest = {};
    std::deque<std::pair<StampNs, LatestCloud>> later = {};  ///< each applies from its stamp on
    std::size_t nb_clouds = 0, nb_refused = 0, nb_warned = 0;
    std::string first_problem = {}, first_warning = {};
  };

  std::shared_ptr<const OccupiedVoxels> gather(const RawMessage& raw, StampNs stamp,
                                               Source& source);
  void advance(StampNs row);

  const BagCloudIndex& index_;
  const CollisionScene& scene_;
  const BagPoses& poses_;
  std::vector<Source> sources_;
  std::vector<StampNs> least_since_;  ///< by entry: minimum over it and all later ones
  std::size_t nb_taken_ = 0, nb_waiting_ = 0;
  std::vector<Eigen::Vector3d> points_;
};

}  // namespace collision_pairs
