// MoveIt's collision environment, answered by this package.
#pragma once

#include <memory>
#include <mutex>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <moveit/collision_detection/collision_env.h>

#include "moveit_scene.h"
#include "moveit_shapes.h"

namespace collision_pairs {

struct MoveitLimits;
class MoveitMotions;

/// The collision detector "CollisionPairs" of MoveIt 1. Metres, in MoveIt's world frame.
///
/// Links are placed where the state has them, not by joints. Padding is a distance that is kept in
/// every direction, while MoveIt's own detectors enlarge the shapes. What cannot be checked (a
/// plane, a size that is not finite, a link without a finite pose) is a collision in every answer
/// that it concerns, and ROS's log says why.
///
/// Changes of the world are taken over at the next check: O(change), about 0.1 µs for each object
/// that stays. Each set of attached bodies has scenes of its own, the last 15 are kept; the first
/// check with a new set costs a build. States that have copies of the same shapes share them.
/// Octomaps may change in place, of which MoveIt tells nobody. Each check of the world reads the
/// leaves near the robot, a distance those up to the nearest. Motions, and checks with attached
/// octrees, read and compare all, O(nodes), and a change costs a build.
///
/// As MoveIt asks for: constant functions may run in several threads, the others in none beside.
class MoveitCollisionEnv : public collision_detection::CollisionEnv {
 public:
  using CollisionRequest = collision_detection::CollisionRequest;
  using CollisionResult = collision_detection::CollisionResult;
  using DistanceRequest = collision_detection::DistanceRequest;
  using DistanceResult = collision_detection::DistanceResult;
  using Matrix = collision_detection::AllowedCollisionMatrix;
  using State = moveit::core::RobotState;
  using World = collision_detection::World;

  explicit MoveitCollisionEnv(const moveit::core::RobotModelConstPtr& model, double padding = 0.0,
                              double scale = 1.0);
  MoveitCollisionEnv(const moveit::core::RobotModelConstPtr& model,
                     const collision_detection::WorldPtr& world, double padding = 0.0,
                     double scale = 1.0);
  /// Shares all scenes with the other one, whose world must be the same or like it.
  MoveitCollisionEnv(const MoveitCollisionEnv& other, const collision_detection::WorldPtr& world);
  ~MoveitCollisionEnv() override;
  MoveitCollisionEnv(const MoveitCollisionEnv&) = delete;
  MoveitCollisionEnv& operator=(const MoveitCollisionEnv&) = delete;

  void checkSelfCollision(const CollisionRequest& req, CollisionResult& res,
                          const State& state) const override {
    check(req, res, state, nullptr, Among::SELF);
  }
  void checkSelfCollision(const CollisionRequest& req, CollisionResult& res, const State& state,
                          const Matrix& acm) const override {
    check(req, res, state, &acm, Among::SELF);
  }
  void checkRobotCollision(const CollisionRequest& req, CollisionResult& res,
                           const State& state) const override {
    check(req, res, state, nullptr, Among::WORLD);
  }
  void checkRobotCollision(const CollisionRequest& req, CollisionResult& res, const State& state,
                           const Matrix& acm) const override {
    check(req, res, state, &acm, Among::WORLD);
  }
  /// Certified for all states between the two, see moveit_motion.h.
  void checkRobotCollision(const CollisionRequest& req, CollisionResult& res, const State& state1,
                           const State& state2, const Matrix& acm) const override {
    checkMotion(req, res, state1, state2, &acm);
  }
  void checkRobotCollision(const CollisionRequest& req, CollisionResult& res, const State& state1,
                           const State& state2) const override {
    checkMotion(req, res, state1, state2, nullptr);
  }
  void distanceSelf(const DistanceRequest& req, DistanceResult& res,
                    const State& state) const override {
    measure(req, res, state, Among::SELF);
  }
  void distanceRobot(const DistanceRequest& req, DistanceResult& res,
                     const State& state) const override {
    measure(req, res, state, Among::WORLD);
  }
  void setWorld(const collision_detection::WorldPtr& world) override;

 protected:
  void updatedPaddingOrScaling(const std::vector<std::string>& links) override;

 private:
  /// A body as a state has it attached. What it points to is kept, so that addresses can be
  /// compared.
  struct Attached {
    std::string name;
    const moveit::core::LinkModel* link;
    std::vector<shapes::ShapeConstPtr> shapes;
    std::vector<Eigen::Isometry3d> X_OE;  ///< poses of the shapes in the frame of the body
    std::set<std::string> touch_links;
    std::vector<std::pair<double, std::vector<OctreeLeaf>>> leaves;  ///< as the scenes have them
    bool is(const moveit::core::AttachedBody& body) const;
  };
  /// The scenes for one set of attached bodies. A text that is not empty: why there is no scene.
  struct Scenes {
    std::vector<Attached> attached;
    std::vector<MovingBody> moving;
    std::shared_ptr<const MoveitScene> self, world;
    std::string self_problem, world_problem;
    std::set<std::string> changed;  ///< objects that `world` does not have as they are
    std::shared_ptr<const MoveitMotions> motions;  ///< of some world before, or null
    std::uint64_t last_used = 0;
  };

  enum class Among { SELF, WORLD };
  /// Null, and a warning: cannot be checked.
  std::shared_ptr<const MoveitScene> sceneFor(const State& state, Among among) const;
  void check(const CollisionRequest& req, CollisionResult& res, const State& state,
             const Matrix* acm, Among among) const;
  void measure(const DistanceRequest& req, DistanceResult& res, const State& state,
               Among among) const;
  std::shared_ptr<const MoveitMotions> motionsFor(const State& state) const;
  void checkMotion(const CollisionRequest& req, CollisionResult& res, const State& state1,
                   const State& state2, const Matrix* acm) const;
  MoveitLimits limitsOf(const CollisionRequest& req, const Matrix* acm) const;

  void observe();
  void noteChange(const std::string& name) const;
  Scenes& scenesOf(const State& state) const;
  void makeScenes(Scenes& scenes) const;
  void updateWorld(Scenes& scenes) const;
  MovingBody movingLink(const moveit::core::LinkModel& link) const;
  MovingBody movingBody(const Attached& attached) const;
  /// Without octrees.
  RigidObject rigidObject(const World::Object& object) const;
  std::vector<MoveitOctree> octreesOfWorld() const;

  World::ObserverHandle observer_;
  mutable std::mutex mutex_;  // of all below
  mutable std::vector<std::unique_ptr<Scenes>> scenes_;
  mutable std::uint64_t nb_uses_ = 0;
  mutable std::set<std::string> octrees_;  // objects that have any
};

}  // namespace collision_pairs
