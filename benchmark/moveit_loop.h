// The peer of the whole check: the loop of MoveIt 1's FCL path, rebuilt from its description.
#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include <Eigen/Geometry>
#include <fcl/broadphase/broadphase_dynamic_AABB_tree.h>
#include <fcl/geometry/bvh/BVH_model.h>

#include "benchmark_robots.h"

namespace collision_pairs {

/// What it pays for each query, as MoveIt does: every persistent FCL object of the robot is copied,
/// moved and given its box by computeAABB(), all are registered in a new dynamic AABB tree, and the
/// callback looks both link names up in a map of maps before FCL answers the pair. The world keeps
/// its tree. Meshes are BVHModel<OBBRSS>. Surfaces only: what lies wholly inside is missed.
class MoveItLoop {
 public:
  explicit MoveItLoop(const BenchmarkRobot& source);
  /// With one geometry at the origin of W instead of the world, such as an octree.
  MoveItLoop(const BenchmarkRobot& source, std::shared_ptr<fcl::CollisionGeometryd> world);

  using Poses = std::vector<Eigen::Isometry3d>;  ///< of RobotModel::bodies()

  bool selfCollides(const Poses& X_RB) const;
  /// Number of link pairs in contact, each with one contact computed.
  std::size_t selfContacts(const Poses& X_RB) const;
  double selfDistance(const Poses& X_RB) const;
  bool collides(const Poses& X_RB) const;  ///< self, then world
  bool worldCollides(const Poses& X_RB) const;
  double worldDistance(const Poses& X_RB) const;

 private:
  struct Object {
    std::string link;
    int body;
    Eigen::Isometry3d X_BE;
    std::shared_ptr<fcl::CollisionObjectd> object;
  };
  struct Query;

  using Objects = std::vector<std::shared_ptr<fcl::CollisionObjectd>>;
  using AllowedCollisions = std::map<std::string, std::map<std::string, bool>>;

  static bool onPair(fcl::CollisionObjectd* a, fcl::CollisionObjectd* b, void* data);
  static bool onDistance(fcl::CollisionObjectd* a, fcl::CollisionObjectd* b, void* data,
                         double& bound);
  static std::vector<Object> makeObjects(const RobotModel& robot);
  void readAllowed(const BenchmarkRobot& source);
  void registerWorld();

  Objects copiesAt(const Poses& X_RB) const;
  void querySelf(const Poses& X_RB, Query& query) const;
  void queryWorld(const Poses& X_RB, Query& query) const;

  std::vector<Object> robot_;
  std::vector<Object> world_;
  AllowedCollisions allowed_;
  std::shared_ptr<fcl::DynamicAABBTreeCollisionManagerd> world_tree_;
};

}  // namespace collision_pairs
