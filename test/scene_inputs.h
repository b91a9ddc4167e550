// Scenes as a program describes them that loads only what is needed, and what is refused.
#pragma once

#include <set>
#include <string>

#include "collision_pairs/collision_scene.h"
#include "test_shapes.h"

namespace collision_pairs {

inline Shape vastMesh() { return meshShape(boxMesh({1e101, 1.0, 1.0})); }

/// As after loading the meshes that neededModels() names.
inline SceneDescription withNeededGeometry(SceneDescription description) {
  const std::set<std::string> needed = CollisionScene::neededModels(description);
  for (SceneRobot& robot : description.robots) {
    robot.model = robot.model->withElements([&](const Link& link) {
      const bool is_needed = needed.count(withPrefix(robot.prefix, link.name)) > 0;
      return is_needed ? link.elements : std::vector<Element>{};
    });
  }
  return description;
}

}  // namespace collision_pairs
