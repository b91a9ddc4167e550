// Occupied leaves of octrees. MoveIt lets octrees change in place and tells nobody.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include <Eigen/Geometry>
#include <octomap/OcTree.h>

#include "collision_pairs/aabb.h"
#include "collision_pairs/body_poses.h"
#include "collision_pairs/occupied_voxels.h"
#include "collision_pairs/robot_model.h"

namespace collision_pairs {

/// An octree of a world object.
struct MoveitOctree {
  std::string object;  ///< MoveIt's name
  std::shared_ptr<const octomap::OcTree> tree;
  Eigen::Isometry3d X_WO;
};

/// Leaves of level 0 have the tree's resolution as edge, each further level twice that.
constexpr int NB_OCTREE_LEVELS = 16;

/// Edge of the leaves of a level, metres.
inline double edgeOfLeaf(double resolution, int level) { return resolution * (1 << level); }

/// An occupied leaf: the cube from cell * edge to (cell + 1) * edge in the tree's frame.
struct OctreeLeaf {
  int level;
  VoxelCell cell;
  bool operator==(const OctreeLeaf& other) const {
    return level == other.level && cell == other.cell;
  }
};

/// The occupied leaves, in the order of the tree, pruned ones as they are (the whole tree is
/// eight). O(nodes).
std::vector<OctreeLeaf> occupiedLeaves(const octomap::OcTree& tree);

/// Those no further than `reach` metres from any of the boxes (in the tree's frame; those that are
/// not valid() are none), and few others. O(nodes there).
std::vector<OctreeLeaf> leavesWithin(const octomap::OcTree& tree, const std::vector<Aabb>& boxes,
                                     double reach);

/// Appends a box for each leaf of a tree at X_MO in its model's frame M.
void appendBoxes(double resolution, const std::vector<OctreeLeaf>& leaves,
                 const Eigen::Isometry3d& X_MO, std::vector<Element>& elements);

/// For a scene with a cloud for each level, in this order.
CloudVoxels voxelsOf(double resolution, const std::vector<OctreeLeaf>& leaves);

}  // namespace collision_pairs
