// MoveIt's continuous checks: the straight motion in joint space between two states, certified.
#pragma once

#include <memory>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include <moveit/collision_detection/collision_common.h>
#include <moveit/robot_state/robot_state.h>

#include "collision_pairs/motion_check.h"
#include "moveit_check.h"
#include "moveit_scene.h"

namespace collision_pairs {

/// The robot with its joints, for a scene of free bodies and objects. Immutable.
class MoveitMotions {
 public:
  /// For states with these bodies, whose attached ones are at X_LO in the frames of their links, in
  /// this world. `cache` must outlive this. Throws InputError.
  MoveitMotions(const moveit::core::RobotModel& robot, const std::vector<MovingBody>& moving,
                const std::vector<Eigen::Isometry3d>& X_LO,
                std::shared_ptr<const MoveitScene> world, SceneCache& cache);

  /// False also if an octree has changed in place. O(nodes of octrees).
  bool areFor(const MoveitScene* world, const std::vector<Eigen::Isometry3d>& X_LO) const;

  /// Adds to `result` whether the robot meets the world between the two states, which are
  /// interpolated as RobotState does; the contacts are those of the state at which one was found,
  /// and percent_interpolation its place. Not certain, and so a collision: floating and planar
  /// joints that move, links that are not where their joints put them, a joint whose leader passes
  /// pi (MoveIt then lets it jump, unless by whole turns), and what stays open at steps of a
  /// millimetre. A pair that may touch on a condition may not. Throws InputError. Cost: a look-up
  /// in the matrix for each pair of a body and an object; a build if others may touch than before.
  void check(const moveit::core::RobotState& from, const moveit::core::RobotState& to,
             const MoveitLimits& limits, const collision_detection::CollisionRequest& request,
             collision_detection::CollisionResult& result) const;

 private:
  void addLeaves(const MoveitOctree& octree);
  /// The scene without the pairs that may touch: the last one, or a new one.
  std::shared_ptr<const CollisionScene> sceneFor(const MoveitLimits& limits) const;
  /// The positions of all joints, and the bodies that have none. False: the links of the state are
  /// elsewhere.
  bool follow(const moveit::core::RobotState& state, std::vector<double>& positions,
              PlacedBodies& placed) const;

  /// Ends joints that turn without limits, and those that mimic others, where MoveIt's
  /// interpolation does. False: a joint that mimics another is elsewhere in a state, jumps, or is
  /// planar or floating.
  bool turnAsMoveit(JointMotion& motion) const;

  std::shared_ptr<const MoveitScene> world_;
  std::vector<Eigen::Isometry3d> X_LO_;
  SceneCache& cache_;
  SceneDescription description_;  // without the objects of the world
  std::vector<RigidObject> objects_;
  std::vector<std::vector<OctreeLeaf>> leaves_;  // those in objects_, by octree of world_
  std::vector<std::pair<std::string, MoveitBody>> bodies_;  // with the names of their models
  std::vector<const moveit::core::LinkModel*> links_;       // by link of the robot model

  mutable std::mutex mutex_;
  mutable std::vector<std::vector<std::string>> left_out_;  // by object, models that may touch it
  mutable std::shared_ptr<const CollisionScene> scene_;
};

}  // namespace collision_pairs
