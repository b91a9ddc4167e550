// Poses of a robot's bodies from the contents of a bag.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "bag_reader.h"
#include "collision_pairs/body_poses.h"
#include "collision_pairs/collision_scene.h"
#include "robot_poses.h"

namespace collision_pairs {

struct BagPosesOptions {
  /// Prefix of this robot's names in the bag: frames P/link, joints P/joint or the topic
  /// P/joint_states. Empty: nothing.
  std::string prefix;
  /// Joints that are not fixed, but may be static on TF.
  std::vector<std::string> static_joints;
};

/// Poses of a scene's bodies at the stamps of the bag's samples.
class BagPoses {
 public:
  /// By the bag's transforms.
  BagPoses(const BagContents& bag, const CollisionScene& scene, const BagPosesOptions& options);
  virtual ~BagPoses() = default;

  /// Sorted, each once: the stamps of all samples that move a body of the robot, or would if they
  /// were not refused.
  const std::vector<StampNs>& stamps() const { return stamps_; }
  /// In the frame of the robot's root link. A body without a pose at that stamp stays unknown;
  /// returns the reasons. O(bodies * log samples).
  std::vector<std::string> at(StampNs stamp, BodyPoses& poses) const {
    return at(stamp, scene_.bodies(), poses);
  }
  /// The same for other bodies of the robot.
  std::vector<std::string> at(StampNs stamp, const std::vector<SceneBody>& bodies,
                              BodyPoses& poses) const;
  /// Pose of any frame in that of the root link: a link, or a frame that the bag's transforms
  /// connect to one. False if unknown. `frame`: its name in the bag.
  bool frameAt(StampNs stamp, const std::string& frame, Eigen::Isometry3d& X_RF) const {
    return robot_->frameAt({Instant::AT, stamp}, frame, X_RF);
  }
  /// Where the poses come from: "TF" or "joint states of TOPIC".
  const std::string& source() const { return source_; }
  /// Assumptions made and data missing, one sentence each.
  const std::vector<std::string>& notes() const { return notes_; }
  /// Number of moving bodies of the robot for which the bag has poses; 0 without any stamp.
  std::size_t nbKnown() const { return nb_known_; }
  /// Joints that move a body of the scene, but that the bag does not name: taken as zero, so
  /// that no verdict is FREE.
  const std::vector<std::string>& jointsAtZero() const { return joints_at_zero_; }

  /// Why there is no stamp, if there might have been; empty if the bag does not mention the robot.
  const std::string& whyNone() const { return why_none_; }

 protected:
  /// From these transforms, which must outlive it.
  void place(const TransformBuffer& transforms, const std::vector<std::string>& static_joints);

  const BagContents& bag_;
  const CollisionScene& scene_;
  std::string prefix_;  ///< without slashes
  std::unique_ptr<const RobotPoses> robot_;
  std::vector<StampNs> stamps_;
  std::string source_, why_none_;
  std::vector<std::string> notes_, joints_at_zero_;
  std::size_t nb_known_ = 0;

 private:
  std::vector<char> all_;  ///< bodies of the robot
};

/// Sorts, and removes repetitions.
void finishStamps(std::vector<StampNs>& stamps);

/// From the transforms that robot_state_publisher would have made of the bag's joint states, and
/// the bag's own for other frames. All references must outlive the result.
std::unique_ptr<const BagPoses> bagPosesFromJoints(const BagContents& bag,
                                                   const CollisionScene& scene,
                                                   const BagPosesOptions& options);

/// By the bag's transforms if they have as many bodies of the robot as the joint states, else by
/// those. All references must outlive the result. Throws InputError, with a remedy
/// (for example a prefix), if the bag has none.
std::unique_ptr<const BagPoses> makeBagPoses(const BagContents& bag, const CollisionScene& scene,
                                             const BagPosesOptions& options);

}  // namespace collision_pairs
