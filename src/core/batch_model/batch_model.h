// The batch stage's model of a scene: bodies, spheres and pairs in float, and bounds of their
// errors.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "batch_kernel.h"
#include "collision_pairs/collision_scene.h"
#include "prepared_shape.h"
#include "scene_element.h"
#include "sphere_cover.h"

namespace collision_pairs {

/// Error bounds of the pose that the kernels compute for a body, for all positions; derived in
/// batch_model.cpp.
struct PoseError {
  double rotation = 0.0;  ///< largest error of a rotated unit vector
  double position = 0.0;  ///< metres, of the body's origin
  double reach = 0.0;     ///< metres: largest distance of its origin from that of W
};

/// Owns what BatchTables points to, and maps its entries to the scene.
struct BatchModel {
  /// Why the batch stage cannot be used for a scene; empty if it can. Not supported: clouds, FCL,
  /// geometry that is missing or coarser than meshes, half-spaces that move, and anything further
  /// than a kilometre away.
  static std::string whyNot(const CollisionScene& scene, Fidelity fidelity);
  /// For a scene without such a reason. Cost: coverBySpheres() for each element, on all cores.
  BatchModel(const CollisionScene& scene, bool with_tables);
  BatchModel(const BatchModel&) = delete;
  BatchModel& operator=(const BatchModel&) = delete;

  BatchTables tables() const {
    return {bodies.data(),
            static_cast<int>(bodies.size()),
            spheres.data(),
            static_cast<int>(spheres.size()),
            trees.data(),
            inner.data(),
            static_cast<int>(trees.size()),
            pairs.data(),
            static_cast<int>(pairs.size())};
  }

  /// A joint whose position the bodies depend on, by column.
  struct Column {
    int joint;
    double most;  ///< rad or m: largest absolute position that the kernels accept
  };
  std::vector<Column> columns;
  std::vector<BatchBody> bodies;
  std::vector<PoseError> errors;  ///< parallel to bodies
  std::vector<int> robot_body;    ///< parallel to bodies: index in RobotModel::bodies()
  std::vector<BatchSphere> spheres;
  std::vector<BatchTree> trees;           ///< one for each moving element, in their order
  std::vector<BatchInner> inner;          ///< parallel to trees
  std::vector<std::uint32_t> element_of;  ///< by tree
  std::vector<BatchPair> pairs;           ///< of moving elements
  std::vector<SphereCover> covers;        ///< by element; empty for static boxes
  std::size_t memory() const;             ///< bytes
};

}  // namespace collision_pairs
