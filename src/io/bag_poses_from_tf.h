// Poses of the bodies from a bag's transforms.
#pragma once

#include "bag_poses.h"

namespace collision_pairs {

class BagPosesFromTf : public BagPoses {
 public:
  BagPosesFromTf(const BagContents& bag, const CollisionScene& scene,
                 const BagPosesOptions& options);
  void at(StampNs stamp, BodyPoses& poses) const override;
  /// Moving bodies of the robot of which TF has a frame.
  std::size_t nbKnown() const { return nb_known_; }

 private:
  /// A frame of the bag that is a link of the body, and the pose of the link in the body's frame.
  struct Frame {
    int frame;
    Eigen::Isometry3d X_BL;
  };
  std::vector<Frame> framesOf(const RobotModel& robot, int body) const;
  int frameOf(const std::string& link) const;
  void noteMissing();
  void collectStamps();
  bool find(FramePoses& frames, int body, Eigen::Isometry3d& X_RB) const;

  const TransformTracks& tracks_;
  const CollisionScene& scene_;
  std::string prefix_;
  StampNs max_gap_;
  std::vector<std::vector<Frame>> bodies_;  ///< by body of the robot
  std::size_t nb_known_ = 0;
};

}  // namespace collision_pairs
