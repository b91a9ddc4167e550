// The detector "CollisionPairs" as a plugin of MoveIt.
#include <string>

#include <moveit/collision_detection/collision_detector_allocator.h>
#include <moveit/collision_detection/collision_plugin.h>
#include <pluginlib/class_list_macros.hpp>

#include "moveit_collision_env.h"

namespace collision_pairs {

/// Makes collision environments for MoveIt's planning scenes.
class MoveitDetectorAllocator
    : public collision_detection::CollisionDetectorAllocatorTemplate<MoveitCollisionEnv,
                                                                     MoveitDetectorAllocator> {
 public:
  const std::string& getName() const override {
    static const std::string name = "CollisionPairs";
    return name;
  }
};

class MoveitPlugin : public collision_detection::CollisionPlugin {
 public:
  bool initialize(const planning_scene::PlanningScenePtr& scene, bool exclusive) const override {
    scene->setActiveCollisionDetector(MoveitDetectorAllocator::create(), exclusive);
    return true;
  }
};

}  // namespace collision_pairs

PLUGINLIB_EXPORT_CLASS(collision_pairs::MoveitPlugin, collision_detection::CollisionPlugin)
