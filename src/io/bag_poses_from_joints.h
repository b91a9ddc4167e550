// Poses of the bodies from a bag's joint states, by forward kinematics.
#pragma once

#include "bag_poses.h"

namespace collision_pairs {

class BagPosesFromJoints : public BagPoses {
 public:
  BagPosesFromJoints(const BagContents& bag, const CollisionScene& scene,
                     const BagPosesOptions& options);
  void at(StampNs stamp, BodyPoses& poses) const override;
  /// Moving bodies of the robot below a joint that the bag names.
  std::size_t nbKnown() const { return nb_known_; }

 private:
  using Samples = std::vector<JointTracks::Sample>;
  void chooseTracks(const JointTracks& tracks, const std::string& prefix);
  void countKnown();
  void noteJointsAtZero();
  void collectStamps();

  const CollisionScene& scene_;
  StampNs max_gap_;
  std::vector<const Samples*> tracks_;  ///< by joint; null: it stands at zero, or mimics
  std::vector<double> zero_;
  std::size_t nb_known_ = 0;
};

}  // namespace collision_pairs
