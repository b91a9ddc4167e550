// Poses for a joint state that the robot is not in.
#pragma once

#include <string>
#include <vector>

#include <ros/time.h>
#include <sensor_msgs/JointState.h>
#include <tf2/buffer_core.h>

#include "collision_pairs/body_poses.h"
#include "collision_pairs/collision_scene.h"

namespace collision_pairs {

struct HypotheticalPoses {
  BodyPoses poses;
  std::vector<std::string> joints_from_tf;  ///< moving joints not named, left where TF has them
  std::vector<std::string> joints_at_zero;  ///< … and those TF does not know: at zero
};

/// Forward kinematics from `joint_state`, in `frame`: joints that mimic follow, joints not named
/// stay where TF has them at `stamp`, or else at zero (or their nearer limit). The root link
/// stands where TF has it in `frame`.
/// Throws InputError that names the joint for one that is unknown, fixed, repeated, without a
/// finite position, or at odds with the joint it mimics; and if TF does not know the root link.
HypotheticalPoses posesFor(const sensor_msgs::JointState& joint_state, const CollisionScene& scene,
                           const tf2::BufferCore& buffer, const std::string& frame,
                           const ros::Time& stamp);

}  // namespace collision_pairs
