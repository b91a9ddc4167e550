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

  Certificate certify(const StoppingTube& tube, const KeptDistances& kept,
                      const std::vector<NearPair>& nearer) override;
  double travel(const StoppingTube& tube) override;
  bool leadsApart(const StoppingTube& tube, const NearPair& pair) override;
  double distance(const std::string& first, const std::string& second, double reach) override;
  bool nearPairs(double reach, const std::vector<double>& direction, std::vector<NearPair>& pairs,
                 std::string& why) override;  // pairs that the direction moves

  /// Of pairs of the robot that the joints of the command move: those that are too near in each of
  /// many random states, so that no command passes, as far as can be told. One sentence each, with
  /// the remedy. Cost: two or three checks, but 200 if there is such a pair. A state has to be set
  /// afterwards.
  std::vector<std::string> alwaysNear(const KeptDistances& kept);

  const std::shared_ptr<const CollisionScene>& scene() const { return scene_; }

 private:
  /// Seconds until the deadline.
  double secondsLeft() const;
  /// Without its derivative.
  NearPair nearPair(const PairReport& pair) const;
  bool areLinks(std::uint32_t first, std::uint32_t second) const;
  bool areOfRobot(std::uint32_t first, std::uint32_t second) const;
  void place(const std::vector<double>& positions);
  /// Where the bodies are placed now; null if the time is over before all is found.
  const CollisionReport* detect(CheckSettings& settings);
  /// Of two models, as distance().
  double placedDistance(std::uint32_t first, std::uint32_t second, double reach);
  Certificate certifyAtOnce(const StoppingTube& tube, double clearance, const ClearanceOf& of);
  Certificate certifyByHalves(const StoppingTube& tube, double clearance, const ClearanceOf& of,
                              const Certificate& refused);
  std::uint32_t idOf(const std::string& name) const;
  /// Of the command: those that move the two relative to each other.
  std::vector<int> columnsBetween(std::uint32_t first_model, std::uint32_t second_model) const;
  bool moves(const PairReport& pair, const std::vector<double>& direction) const;

  std::shared_ptr<const CollisionScene> scene_;
  JointColumns columns_;
  Fidelity fidelity_;
  MotionCheck motions_;
  CollisionDetector detector_;
  DistanceGradient gradient_;
  RobotState state_;
  std::vector<int> carriers_;  // by model: CollisionScene::carrierOf()
  std::chrono::steady_clock::time_point deadline_ = std::chrono::steady_clock::time_point::max();
  std::vector<Eigen::Isometry3d> X_WB_;
  BodyPoses poses_;
  std::vector<double> rates_;
};

}  // namespace collision_pairs
