// What was seen near the robot and no longer is: hidden, gone, or against the robot.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "collision_pairs/body_poses.h"
#include "collision_pairs/occupied_voxels.h"
#include "collision_pairs/self_filter.h"

namespace collision_pairs {

/// Follows the voxels of one sensor near the robot from cloud to cloud. Those that a cloud does not
/// show again are
///  - remembered, if something hides them, for as long as it does. An obstacle of which nothing
///    else is seen may have moved on before it was hidden, or be carried: it is suspect where no
///    link is within `padding` of its place, and has vanished where the robot moves away from it;
///  - explained, if the cloud shows anything within `reach` of them: a part of the same obstacle,
///    which is there or has moved;
///  - otherwise vanished: the obstacle may be where its points cannot be told from the robot's.
/// What vanished, or is hidden and suspect, is found again when something appears within
/// FOUND_AGAIN of where it was, in the world or on its link, and stays for two clouds. Something
/// appears where nothing was seen within `reach` when the obstacle was lost; where the link has
/// carried it further than that, in the cloud before.
///
/// Does not follow the shape of obstacles, nor what one leaves behind when it moves on. Single
/// points that only one cloud shows are noise. Cost: a few look-ups in trees per voxel near the
/// robot that is not seen again.
class OccludedObstacles {
 public:
  static constexpr double FOUND_AGAIN = 0.3;  ///< metres

  /// Metres. `reach`: also the distance from the robot within which voxels are followed. `padding`:
  /// links in whose padding a voxel is are in contact with it.
  OccludedObstacles(double reach, double padding) : reach_(reach), padding_(padding) {}

  struct Cloud {
    /// The voxels of this cloud alone, at least those within FOUND_AGAIN of near.bounds() and
    /// missed().
    std::shared_ptr<const OccupiedVoxels> now;
    std::vector<VoxelCell> unseen;  ///< of the cloud before, that this one does not occupy
    const BodyPoses& robot;         ///< poses of near.bodies() at its stamp
    SelfFilter& near;               ///< its padding is `reach`; of links that are checked alone
    std::function<bool(const Eigen::Vector3d& p_W)> isHidden;
    /// Whether the sensor saw anything within `reach` of the point that is left out of the voxels.
    std::function<bool(const Eigen::Vector3d& p_W)> isLeftOut;
    /// Whether what was seen there before is part of the robot now: it is not missed.
    std::function<bool(const Eigen::Vector3d& p_W)> isTakenUp;
    bool shows_more = false;  ///< less is part of the robot: what appears may have been that
  };
  void update(const Cloud& cloud);

  /// Voxels that are hidden since they were seen.
  std::vector<VoxelCell> hidden() const;
  /// A box in W of the places where what is hidden or vanished was last seen.
  Aabb missed() const;
  /// "vanished 2 cm from panda_link3: it may touch", or "hidden 6 cm …", or empty.
  std::string mayTouch() const;

  void clear();

 private:
  using Voxels = std::shared_ptr<const OccupiedVoxels>;
  struct Unseen {
    VoxelCell cell;
    bool is_hidden, is_beside;
    bool was_alone;  ///< remembered, with nothing of its obstacle seen
    bool was_seen;   ///< by the last cloud
  };
  struct Remembered {
    VoxelCell cell;
    bool is_alone;  ///< nothing of its obstacle is seen
  };
  struct Vanished {
    Eigen::Vector3d p_W, p_B;  ///< where it was last seen, and the same on the link's body
    std::string link_of_body, link;
    double distance;             ///< metres from the link
    Voxels around;               ///< what was seen about p_W when it was lost
    bool is_in_contact = false;  ///< its voxel, which is remembered, with the link
    std::optional<Eigen::Vector3d> appeared = {};  ///< what may be it, in the last cloud
  };

  void takeWhatStayed(const Cloud& cloud);
  std::vector<Unseen> unseenIn(const Cloud& cloud) const;
  void judge(const std::vector<Unseen>& obstacle, const Cloud& cloud);
  /// Where the obstacle is nearest to a link; none if it is near no link.
  std::optional<Vanished> placeOf(const std::vector<Unseen>& obstacle, const Cloud& cloud) const;
  static bool isPartOf(const Vanished& obstacle, const Remembered& one, const Cloud& cloud);
  void addVanished(const std::vector<Unseen>& obstacle, const Cloud& cloud);
  void followWhatIsHidden(const Cloud& cloud);
  void findWhatAppeared(const Cloud& cloud);
  /// What is seen about a place where something may be found again.
  Voxels aboutPlace(const Eigen::Vector3d& p_W, const Cloud& cloud) const;
  static Eigen::Vector3d placeOnLink(const Vanished& one, const Cloud& cloud);

  const double reach_, padding_;
  Voxels before_, earlier_;  ///< of the last cloud, and of the one before it; may be null
  std::vector<Remembered> remembered_;
  std::vector<Vanished> vanished_;
  std::vector<Vanished> hidden_;  ///< one of each obstacle that is remembered and not seen
};

}  // namespace collision_pairs
