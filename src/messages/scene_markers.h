// The modelled scene, and occupied voxels, for rviz. Pure functions.
#pragma once

#include <string>
#include <vector>

#include <visualization_msgs/MarkerArray.h>

#include "collision_pairs/collision_scene.h"
#include "collision_pairs/occupied_voxels.h"

namespace collision_pairs {

/// The shapes that a check at this fidelity compares: what the URDF says, hulls, OBBs (also
/// for aabb, whose boxes are those of toMarkers()), of the spheres of a mesh the 64 that distances
/// are measured from, capsules in place of cylinders; a half-space is a square. Padding is not
/// drawn. In the namespaces "links" and "attached_objects" (locked to the frame of their link, so
/// that rviz moves them) and "standing"; links are grey. At most 10,000 elements, moving ones
/// first. The array begins with DELETEALL.
visualization_msgs::MarkerArray toSceneMarkers(const CollisionScene& scene, Fidelity fidelity,
                                               const std::string& world_frame);

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
