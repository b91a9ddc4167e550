// Transforms that robot_state_publisher would have made of a bag's joint states.
#pragma once

#include <map>
#include <set>
#include <string>
#include <vector>

#include <sensor_msgs/JointState.h>
#include <tf2_msgs/TFMessage.h>

#include "collision_pairs/collision_scene.h"

namespace collision_pairs {

class JointTransforms {
 public:
  /// `joints`: names by topic. With a prefix P, those of this robot are P/joint, Pjoint, or on the
  /// topic P/joint_states; without one they are on joint_states, or on the only topic. Of several
  /// choices, the one that names most joints is taken. The model must outlive this object.
  JointTransforms(const std::map<std::string, std::set<std::string>>& joints,
                  const RobotModel& robot, const std::string& prefix);

  /// Empty: no joint state is this robot's.
  const std::string& topic() const { return topic_; }
  /// How many of the bodies move with joints that are named.
  std::size_t nbMoved(const std::vector<SceneBody>& bodies) const;
  /// Joints that move one of the bodies, but are not named.
  std::vector<std::string> unnamedJoints(const std::vector<SceneBody>& bodies) const;

  /// Of the bodies below joints that are named in the message, with its stamp; between the first
  /// links of two bodies. Takes finitePositionsIn() it.
  tf2_msgs::TFMessage take(const sensor_msgs::JointState& state);
  /// Of the bodies below joints that are not named, at zero.
  tf2_msgs::TFMessage atZero() const;
  /// Frames of all bodies that joints move.
  std::set<std::string> frames() const;

 private:
  /// The joint above the body has its position from joint states.
  bool isNamed(std::size_t body) const;
  const std::string& frameOf(int body) const;
  geometry_msgs::TransformStamped transformOf(std::size_t body,
                                              const std::vector<double>& positions) const;

  const RobotModel& robot_;
  std::string topic_;
  std::map<std::string, int> joints_;            ///< by name in the messages
  std::vector<int> followers_;                   ///< joints with <mimic>, by name
  std::vector<char> is_named_;                   ///< by joint: in joints_, or follows one that is
  std::vector<double> positions_;                ///< by joint
  std::vector<std::vector<std::size_t>> moved_;  ///< by joint: bodies right below it
};

}  // namespace collision_pairs
