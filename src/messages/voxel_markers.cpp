#include "voxel_markers.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>

#include "geometry_conversions.h"
#include "marker_style.h"

namespace collision_pairs {
namespace {

using visualization_msgs::Marker;

struct ByCoordinates {
  bool operator()(const VoxelCell& a, const VoxelCell& b) const {
    return std::tie(a.x(), a.y(), a.z()) < std::tie(b.x(), b.y(), b.z());
  }
};
/// 0: touching; 1: as far as reach.
using Nearness = std::map<VoxelCell, float, ByCoordinates>;

Nearness nearVoxels(const OccupiedVoxels& voxels, const std::vector<Aabb>& boxes, double reach) {
  Nearness near;
  for (const Aabb& box : boxes) {
    if (!box.valid()) continue;
    voxels.forEachWithin(box, reach, [&](const VoxelCell& cell) {
      const double gap = std::sqrt(squaredGap(voxels.boxOf(cell, Eigen::Vector3i::Ones()), box));
      const auto share = static_cast<float>(std::min(1.0, gap / reach));
      const auto [known, is_new] = near.emplace(cell, share);
      if (!is_new) known->second = std::min(known->second, share);
    });
  }
  return near;
}

Marker markerOf(const std::string& name, const std::string& world_frame) {
  Marker marker;
  marker.header.frame_id = world_frame;
  marker.ns = "cloud " + name;
  marker.type = Marker::CUBE_LIST;
  marker.pose.orientation.w = 1.0;
  return marker;
}

}  // namespace

Marker toMarker(const OccupiedVoxels& voxels, const std::string& name,
                const std::vector<Aabb>& boxes, double reach, const std::string& world_frame) {
  Marker marker = markerOf(name, world_frame);
  marker.action = Marker::ADD;
  marker.scale = toVector3(Eigen::Vector3d::Constant(voxels.voxelSize()));
  marker.color = color(0.30f, 0.55f, 0.75f, 1.0f);
  const auto add = [&](const VoxelCell& cell, const std_msgs::ColorRGBA& shade) {
    if (marker.points.size() == MOST_DRAWN_VOXELS) return;
    const Eigen::Vector3d center =
        (cell.cast<double>() + Eigen::Vector3d::Constant(0.5)) * voxels.voxelSize();
    marker.points.push_back(toPoint(center));
    marker.colors.push_back(shade);
  };
  const Nearness near = nearVoxels(voxels, boxes, reach);
  for (const auto& [cell, share] : near) {
    add(cell, color(0.95f - 0.05f * share, 0.15f + 0.60f * share, 0.10f, 1.0f));
  }
  voxels.forEach([&](const VoxelCell& cell) {
    if (near.empty() || near.count(cell) == 0) add(cell, marker.color);
  });
  if (marker.points.empty()) marker.action = Marker::DELETE;  // rviz complains
  return marker;
}

Marker noMarker(const std::string& name, const std::string& world_frame) {
  Marker marker = markerOf(name, world_frame);
  marker.action = Marker::DELETE;
  return marker;
}

}  // namespace collision_pairs
