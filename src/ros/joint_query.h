// Poses for a joint state that the robot is not in.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <ros/time.h>

#include "collision_pairs/body_poses.h"
#include "collision_pairs/collision_scene.h"
#include "collision_pairs/joint_columns.h"
#include "transform_input.h"

namespace collision_pairs {

/// What a JointQuery asks TF, and when.
struct JointQueryTf {
  const TransformInput& transforms;
  std::string frame;    ///< of the poses
  ros::Time stamp;      ///< where joints that are not named stand; 0: the newest that TF has
  ros::Time now;        ///< what the age of the newest is counted from
  double max_pose_age;  ///< s; 0: never too old
};

/// Forward kinematics for named joints: joints that mimic follow, joints not named stay where TF
/// has them at a stamp, or else at zero (or their nearer limit). The root link stands where TF has
/// it. TF is asked once, when it is made; after that it may be used from several threads.
class JointQuery {
 public:
  /// Throws InputError that names the joint for one that is unknown, repeated or without a position
  /// to set, or that mimics one that is not named; and if TF does not know the root link.
  JointQuery(const std::vector<std::string>& names, const CollisionScene& scene,
             const JointQueryTf& tf);

  /// One position for each name. Throws InputError that names the joint for one that is not finite
  /// or at odds with the joint it mimics, or if there are too few or too many.
  void posesAt(const std::vector<double>& positions, BodyPoses& poses) const;
  /// The same of all RobotModel::bodies().
  void bodyPosesAt(const std::vector<double>& positions,
                   std::vector<Eigen::Isometry3d>& X_WB) const;

  const JointColumns& columns() const { return columns_; }

  /// The same state for MotionCheck: a position for each of RobotModel::joints(), and the bodies
  /// with poses not given by the positions.
  std::vector<double> jointPositionsAt(const std::vector<double>& positions) const;
  std::vector<std::optional<Eigen::Isometry3d>> placedBodies() const;

  /// Moving joints not named, left where TF has them; and those that TF does not know: at zero.
  const std::vector<std::string>& jointsFromTf() const { return joints_from_tf_; }
  const std::vector<std::string>& jointsAtZero() const { return joints_at_zero_; }
  /// Reasons why the checked state may differ from the requested one: joints at zero because it is
  /// unknown where they are, poses from TF that are too old. With any of these, no verdict is FREE.
  const std::vector<std::string>& doubts() const { return doubts_; }

 private:
  /// Source of the position of a body's joint.
  struct Source {
    JointColumns::Source joint;  ///< of no column: X_PB is the pose
    Eigen::Isometry3d X_PB;      ///< pose of the body in its parent's frame
  };

  Source sourceOf(const Body& body, const JointQueryTf& tf, std::string& doubt);
  void refuseOtherCount(const std::vector<double>& positions) const;

  const CollisionScene& scene_;
  const JointColumns columns_;
  std::vector<Source> sources_;  // one per body; that of the root holds its pose in the frame
  std::vector<std::string> joints_from_tf_;
  std::vector<std::string> joints_at_zero_;
  std::vector<std::string> doubts_;
};

}  // namespace collision_pairs
