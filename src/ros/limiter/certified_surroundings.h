// Answers the limiter's law from a scene: certificates, distances and their gradients.
#pragma once

#include <chrono>
#include <memory>
#include <string>
#include <vector>

#include "collision_pairs/collision_detector.h"
#include "collision_pairs/distance_gradient.h"
#include "collision_pairs/motion_check.h"
#include "limiter_law.h"

namespace collision_pairs {

/// State of the robot and its surroundings at one instant.
struct RobotState {
  std::vector<double> positions;  ///< one per joint of the robot; mimic joints follow
  PlacedBodies placed;
  CloudVoxels voxels;
};

/// Holds scratch memory only: use one per thread and scene. Links move with the joints of the
/// command; all others keep their positions. The constructor makes what a first answer needs, which
/// takes seconds for large scenes, and at SPHERES for large meshes.
class CertifiedSurroundings : public Surroundings {
 public:
  /// Joints of the command, by name. Throws InputError as JointColumns does.
  CertifiedSurroundings(std::shared_ptr<const CollisionScene> scene,
                        const std::vector<std::string>& joints, Fidelity fidelity);

  /// Throws InputError as MotionCheck::check() does.
  void setState(RobotState state);
  /// From then on nothing more is certified or found: the answers are "not", with this reason.
  void setDeadline(std::chrono::steady_clock::time_point deadline) { deadline_ = deadline; }

  Certificate certify(const StoppingTube& tube, double clearance, double growth,
                      const std::vector<NearPair>& nearer) override;
  double travel(const StoppingTube& tube) override;
  bool leadsApart(const StoppingTube& tube, const NearPair& pair) override;
  bool nearPairs(double reach, const std::vector<double>& direction, std::vector<NearPair>& pairs,
                 std::string& why) override;  // pairs that the direction moves

  const std::shared_ptr<const CollisionScene>& scene() const { return scene_; }

 private:
  /// Seconds until the deadline.
  double secondsLeft() const;
  void place(const std::vector<double>& positions);
  bool moves(const PairReport& pair, const std::vector<double>& direction) const;

  std::shared_ptr<const CollisionScene> scene_;
  JointColumns columns_;
  std::vector<int> joint_ids_;
  Fidelity fidelity_;
  MotionCheck motions_;
  CollisionDetector detector_;
  DistanceGradient gradient_;
  RobotState state_;
  std::chrono::steady_clock::time_point deadline_ = std::chrono::steady_clock::time_point::max();
  std::vector<Eigen::Isometry3d> X_WB_;
  BodyPoses poses_;
  std::vector<double> rates_;
};

}  // namespace collision_pairs
