// Shapes of MoveIt (geometric_shapes) as elements of collision models. Metres.
#pragma once

#include <map>
#include <memory>
#include <mutex>
#include <utility>
#include <vector>

#include <Eigen/Geometry>
#include <geometric_shapes/shapes.h>

#include "collision_pairs/robot_model.h"
#include "moveit_octree.h"

namespace collision_pairs {

/// Whether they are of one type, size and mesh, or one octree: as copies of states have them. O(1),
/// of meshes O(vertices). A shape that is changed in place is not noticed.
bool areAlike(const shapes::ShapeConstPtr& a, const shapes::ShapeConstPtr& b);

/// The octrees among some shapes as they are now: resolution, metres, and occupied leaves; of one
/// without a tree 0, and none.
std::vector<std::pair<double, std::vector<OctreeLeaf>>> leavesOf(
    const std::vector<shapes::ShapeConstPtr>& parts);

/// Turns shapes into elements. Keeps the triangles of meshes for as long as MoveIt keeps the shape,
/// so that scenes share them. One serves all threads.
class MoveitShapes {
 public:
  /// Appends the shape, scaled about its centre, at X_ME in its model's frame M. A cone becomes
  /// the 64-sided pyramid around it, an octree one box per occupied leaf. Throws InputError for what
  /// cannot be checked: a plane, which MoveIt takes for a thin sheet, and unknown types.
  void append(const shapes::ShapeConstPtr& shape, double scale, const Eigen::Isometry3d& X_ME,
              std::vector<Element>& elements);

 private:
  struct Key {
    std::weak_ptr<const shapes::Shape> shape;
    double scale;
    bool operator<(const Key& other) const {
      const std::owner_less<std::weak_ptr<const shapes::Shape>> less;
      if (less(shape, other.shape)) return true;
      return !less(other.shape, shape) && scale < other.scale;
    }
  };
  std::shared_ptr<const TriangleMesh> trianglesOf(const shapes::ShapeConstPtr& shape, double scale);

  std::mutex mutex_;
  std::map<Key, std::shared_ptr<const TriangleMesh>> meshes_;
  std::size_t nb_swept_ = 64;  // when to look for shapes that are gone
};

}  // namespace collision_pairs
