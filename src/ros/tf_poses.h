// Poses of a scene's bodies from TF, all at the same stamp.
#pragma once

#include <atomic>
#include <string>
#include <vector>

#include <ros/time.h>

#include "collision_pairs/body_poses.h"
#include "collision_pairs/collision_scene.h"
#include "transform_input.h"

namespace collision_pairs {

struct StampedPoses {
  BodyPoses poses;
  /// The instant of all of them; 0 if all known poses are static.
  ros::Time stamp;
  /// Number of bodies looked up in TF (all but one that is the frame itself), and of those found.
  std::size_t nb_asked = 0;
  std::size_t nb_found = 0;
  /// For each body without a pose: its link and the reason. Empty if all are known.
  std::vector<std::string> problems;
};

/// Limits of the age of a pose, in seconds.
struct PoseLimits {
  /// Relative to now, in ROS time; 0: no limit.
  double max_pose_age = 1.0;
  /// Relative to the newest pose of all links.
  double max_transform_age = 1.0;
};

/// Why a pose of this stamp is too old at `now`; empty if it is not. A stamp of 0 is that of static
/// transforms, which do not age.
std::string whyTooOld(const ros::Time& stamp, const ros::Time& now, double max_pose_age);

/// Looks up transforms; keeps no poses. Poses that TF lacks stay unknown and are never identity.
class TfPoses {
 public:
  /// Of these bodies of the robot; `frame` is the report's frame W. The transforms must outlive
  /// this object.
  TfPoses(const TransformInput& transforms, const RobotModel& robot,
          const std::vector<SceneBody>& bodies, std::string frame);

  /// The newest instant for which all bodies are known, leaving out those that are older than the
  /// limits allow.
  StampedPoses latest(const ros::Time& now, const PoseLimits& limits) const;

  /// At the given instant (0: of static transforms only).
  StampedPoses at(const ros::Time& stamp) const;

  /// At the given instant, of the bodies with an entry in `wanted` only; the others stay unknown.
  BodyPoses at(const ros::Time& stamp, const std::vector<char>& wanted) const;

 private:
  /// A link to look up, and the body's pose in its frame.
  struct Source {
    std::string link;
    Eigen::Isometry3d X_LB;
  };

  /// Result of a look-up: the pose in W, and its stamp.
  struct Found {
    bool known = false;
    Eigen::Isometry3d X_WB;
    ros::Time stamp;      ///< 0: of static transforms only, or the frame itself
    std::string problem;  ///< why it is unknown
  };

  bool isFrame(const std::vector<Source>& sources) const;
  /// `stamp` 0: the newest.
  Found lookUp(std::size_t body, const ros::Time& stamp) const;
  Found lookUpLink(const Source& source, const ros::Time& stamp, bool expected) const;
  void leaveOut(std::size_t body, const std::string& why, Found& found) const;
  StampedPoses gather(std::vector<Found> found, const ros::Time& stamp) const;

  const TransformInput& transforms_;
  std::string frame_;
  /// By body: its first link, then the others with geometry, for when TF lacks the first.
  std::vector<std::vector<Source>> sources_;
  /// By body: whether TF had it last time. Only a hint: testing first doubles the work, but an
  /// exception costs a hundred times as much.
  mutable std::vector<std::atomic<bool>> expected_;
};

}  // namespace collision_pairs
