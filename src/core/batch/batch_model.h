// A scene as the batch stage sees it: bodies, spheres and pairs in float, and by how much they may
// be off.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "batch_kernel.h"
#include "collision_pairs/collision_scene.h"
#include "sphere_cover.h"

namespace collision_pairs {

/// By how much the pose that the kernels compute for a body may be off, whatever the positions.
/// docs/batch.md derives the bounds.
struct PoseError {
  double rotation = 0.0;  ///< largest change of a unit vector
  double position = 0.0;  ///< metres, of the body's origin
  double reach = 0.0;     ///< metres: its origin is no further from that of W
};

/// What BatchTables points to, and whom its entries belong to.
struct BatchModel {
  /// Why a scene is not for the batch stage; empty if it is. Clouds, FCL, geometry other than the
  /// meshes, half-spaces that move, and what is further than a kilometre away are not.
  static std::string whyNot(const CollisionScene& scene, Fidelity fidelity);
  /// Of a scene that is. Cost: coverBySpheres() of each element, on all cores.
  explicit BatchModel(const CollisionScene& scene, bool with_tables = true);
  BatchModel(const BatchModel&) = delete;
  BatchModel& operator=(const BatchModel&) = delete;

  BatchTables tables() const {
    return {bodies.data(),
            static_cast<int>(bodies.size()),
            spheres.data(),
            static_cast<int>(spheres.size()),
            trees.data(),
            pairs.data(),
            static_cast<int>(pairs.size())};
  }

  /// A position of the robot's joints that bodies need, by column.
  struct Column {
    int joint;
    double most;  ///< rad or m: beyond, or not a number, the state is not for the kernels
  };
  std::vector<Column> columns;
  std::vector<BatchBody> bodies;
  std::vector<PoseError> errors;  ///< beside bodies
  std::vector<int> robot_body;    ///< beside bodies: in RobotModel::bodies()
  std::vector<BatchSphere> spheres;
  std::vector<BatchTree> trees;           ///< one for each element that moves, in their order
  std::vector<std::uint32_t> element_of;  ///< by tree
  std::vector<BatchPair> pairs;           ///< of elements that move against each other
  std::vector<SphereCover> covers;        ///< by element; none for static boxes
  std::size_t memory() const;             ///< bytes
};

}  // namespace collision_pairs
