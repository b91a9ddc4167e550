// Robots among thin plates, boxes and meshes, and random motions of theirs.
#pragma once

#include <memory>
#include <vector>

#include "benchmark_robots.h"
#include "collision_pairs/collision_detector.h"
#include "collision_pairs/motion_check.h"

namespace collision_pairs {

/// Of the scenes that a program builds here: the meshes of its robots are prepared once.
SceneCache& sceneCache();

/// Plates of 2 mm, boxes and meshes that are not convex, each at a random place where it does not
/// touch the robot in its zero state. Others for each index.
std::vector<RigidObject> clutter(const BenchmarkRobot& robot, std::uint64_t index, int nb_things,
                                 const SceneSettings& settings = {});

/// The robot with its SRDF among ten plates of 2 mm, ten boxes and ten meshes that are not convex,
/// each at a random place where it does not touch the robot in its zero state. Another clutter for
/// each index.
std::shared_ptr<const CollisionScene> clutteredScene(const BenchmarkRobot& robot,
                                                     std::uint64_t index,
                                                     const SceneSettings& settings = {});

/// Motion number `index`: from a random state straight towards another, until the joint that moves
/// most has moved by `length` rad or m, or to its end. Within the limits of the joints.
JointMotion randomMotion(const std::shared_ptr<const RobotModel>& robot, std::uint64_t index,
                         double length);

/// 0.1 to 3 rad, evenly spread over indices that follow each other.
double lengthNumber(std::uint64_t index);

/// What the joint that moves most moves, rad or m.
double lengthOf(const JointMotion& motion);

/// The exact check of one configuration of a motion at a time, as a loop over states does it.
class StateLoop {
 public:
  explicit StateLoop(std::shared_ptr<const CollisionScene> scene);

  /// At a fraction of the motion, by the formula that JointMotion states.
  const CollisionReport& at(const JointMotion& motion, double fraction,
                            const CheckSettings& settings);

  /// Is a contact found at steps by which no joint moves more than `step` rad or m? Ends at the
  /// first.
  bool findsContact(const JointMotion& motion, double step);

 private:
  std::shared_ptr<const CollisionScene> scene_;
  CollisionDetector detector_;
  std::vector<double> positions_;
  std::vector<Eigen::Isometry3d> X_RB_;
  BodyPoses poses_;
};

}  // namespace collision_pairs
