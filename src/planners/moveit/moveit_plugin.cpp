// The detector "CollisionPairs" as a plugin of MoveIt.
#include <moveit/collision_detection/collision_detector_allocator.h>
#include <moveit/collision_detection/collision_plugin.h>
#include <pluginlib/class_list_macros.hpp>

#include "moveit_detector_allocator.h"

namespace collision_pairs {

class MoveitPlugin : public collision_detection::CollisionPlugin {
 public:
  bool initialize(const planning_scene::PlanningScenePtr& scene, bool exclusive) const override {
    scene->setActiveCollisionDetector(MoveitDetectorAllocator::create(), exclusive);
    return true;
  }
};

}  // namespace collision_pairs

PLUGINLIB_EXPORT_CLASS(collision_pairs::MoveitPlugin, collision_detection::CollisionPlugin)
