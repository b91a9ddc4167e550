// What queries need of a mesh.
#pragma once

#include <memory>
#include <vector>

#include "triangle_tree.h"
#include "winding_number.h"

namespace collision_pairs {

/// A mesh that is not convex, ready for queries.
struct PreparedMesh {
  std::shared_ptr<const TriangleMesh> triangles;
  TriangleTree tree;
  WindingNumber solid;                       ///< the parts that enclose space
  std::vector<Eigen::Vector3d> part_points;  ///< a point of each part
};

}  // namespace collision_pairs
