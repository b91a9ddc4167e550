// Poses for a given joint state instead of the robot's current one.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <ros/time.h>

#include "collision_pairs/body_poses.h"
#include "collision_pairs/collision_scene.h"
#include "collision_pairs/joint_columns.h"
#include "collision_pairs/motion_check.h"
#include "tf_poses.h"

namespace collision_pairs {

/// TF lookup settings of a JointQuery.
struct JointQueryTf {
  const TransformInput& transforms;
  std::string frame;  ///< of the poses
  ros::Time stamp;    ///< time of the positions of joints not named; 0: the latest in TF
  ros::Time now;      ///< for messages
  /// Of the scene's robot: for links that TF does not place. Null: none.
  const TfPoses* poses = nullptr;
  /// At stamp 0, what is older than this by more than max_transform_age is suspect.
  ros::Time heard = {};
  /// At stamp 0: the newest instant that all transforms have reached, or else the newest of each.
  bool is_of_one_instant = true;
  /// Of the names, the joints that are about to move from where TF has them; null: all.
  const std::vector<std::string>* moved = nullptr;
};

/// Forward kinematics for named joints: mimic joints follow, joints not named keep their positions
/// in TF at a stamp, or else are at zero (or their nearer limit). The root link's pose is from TF.
/// TF is queried by the constructor alone; afterwards it may be used from several threads.
class JointQuery {
 public:
  /// Throws InputError that names the joint if it is unknown, repeated or without a position to
  /// set, or mimics one that is not named; also if TF does not have the root link of a robot of
  /// which something is checked.
  JointQuery(const std::vector<std::string>& names, const CollisionScene& scene,
             const JointQueryTf& tf);

  /// One position for each name. Throws InputError that names the joint if its position is not
  /// finite or contradicts the joint it mimics, or if there are too few or too many.
  void posesAt(const std::vector<double>& positions, BodyPoses& poses) const;
  /// The same for all RobotModel::bodies().
  void bodyPosesAt(const std::vector<double>& positions,
                   std::vector<Eigen::Isometry3d>& X_WB) const;

  const JointColumns& columns() const { return columns_; }

  /// The same state for MotionCheck: a position for each of RobotModel::joints(), and the bodies
  /// with poses not given by the positions.
  std::vector<double> jointPositionsAt(const std::vector<double>& positions) const;
  const PlacedBodies& placedBodies() const { return placed_; }

  /// Movable joints not named: those with positions from TF, and those at zero because TF does not
  /// have them.
  const std::vector<std::string>& jointsFromTf() const { return joints_from_tf_; }
  const std::vector<std::string>& jointsAtZero() const { return joints_at_zero_; }
  /// Reasons why the checked state may differ from the requested one: joints at zero because their
  /// positions are unknown, poses from TF that are too old. With any of these, no verdict is FREE.
  const std::vector<std::string>& unknownBecause() const { return unknown_because_; }
  /// Of what came from TF; 0: nothing but static transforms did, or all that is newest.
  const ros::Time& stamp() const { return stamp_; }

 private:
  /// Notes placed bodies and reasons. At stamp 0 returns the newest instant that all transforms
  /// have reached which may be used; 0: there is none.
  ros::Time place(const JointQueryTf& tf);
  /// Its pose in its parent's frame (of a root: in the frame); none: its joint has a column.
  std::optional<Eigen::Isometry3d> poseOf(const Body& body, bool is_needed, const JointQueryTf& tf,
                                          std::string& problem, ros::Time& stamp);
  /// What TF places by a joint that is about to move is elsewhere then. Empty: nothing does.
  std::string whyCarried(int body, const JointQueryTf& tf) const;
  void refuseOtherCount(const std::vector<double>& positions) const;

  const CollisionScene& scene_;
  const JointColumns columns_;
  const std::vector<double> zeros_;  ///< RobotModel::zeroPositions()
  PlacedBodies placed_;
  std::vector<std::string> joints_from_tf_;
  std::vector<std::string> joints_at_zero_;
  std::vector<std::string> unknown_because_;
  ros::Time stamp_;
};

}  // namespace collision_pairs
