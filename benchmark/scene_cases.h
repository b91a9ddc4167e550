// Scenes of one robot that model more and less of it, and of the world around it.
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "benchmark_robots.h"
#include "collision_pairs/collision_scene.h"

namespace collision_pairs {

/// What to model.
struct SceneCase {
  std::string robot;  ///< how much of it: a column of the table
  std::string world;  ///< "none", "far" (out of reach) or "near" (beside where it moves)
  bool srdf = true;   ///< its pairs switched off; false: of links that hang together only
  std::string group;  ///< only pairs with a link that this group of the SRDF moves; empty: all
  bool others_ignored = false;  ///< the links that the group does not move are not in the scene
  std::size_t nb_boxes = 0;
};

/// The scene, and what it took to have it.
struct BuiltCase {
  SceneCase what;
  std::shared_ptr<const CollisionScene> scene;
  std::size_t nb_meshes = 0, nb_triangles = 0;  ///< loaded, for the robot's links
  std::size_t heap_bytes = 0;                   ///< that stay allocated for all of it
};

/// Boxes of 4 to 30 cm, 5 to 50 m away from the origin.
std::vector<RigidObject> farBoxes(std::size_t count);

/// Boxes of 2 cm within 2 m of the origin that are out of the alarm distance in every one of the
/// robot's states, as their axis-aligned boxes tell.
std::vector<RigidObject> nearBoxes(const BenchmarkRobot& robot, std::size_t count);

/// As the node does it: reads the URDF, and loads the meshes of the links that are in some pair.
BuiltCase buildCase(const BenchmarkRobot& robot, const SceneCase& what,
                    std::vector<RigidObject> boxes);

/// Of the robot with its SRDF and these objects.
SceneDescription describe(const BenchmarkRobot& robot, std::vector<RigidObject> objects);

}  // namespace collision_pairs
