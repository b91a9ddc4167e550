// Occupied voxels for rviz. Pure functions.
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>
#include <visualization_msgs/Marker.h>

#include "collision_pairs/aabb.h"
#include "collision_pairs/occupied_voxels.h"

namespace collision_pairs {

/// At most this many voxels are drawn; those nearest to the boxes are always included.
constexpr std::size_t MOST_DRAWN_VOXELS = 100000;

/// One list of cubes in namespace "cloud NAME". Voxels no further than `reach` from a box are
/// coloured by that distance, from red to amber. `boxes`: of the robot, in W.
visualization_msgs::Marker toMarker(const OccupiedVoxels& voxels, const std::string& name,
                                    const std::vector<Aabb>& boxes, double reach,
                                    const std::string& world_frame);

/// Deletes the marker.
visualization_msgs::Marker noMarker(const std::string& name, const std::string& world_frame);

}  // namespace collision_pairs
