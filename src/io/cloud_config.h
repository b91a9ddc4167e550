// The parameter ~clouds: which point clouds are obstacles, and how they are read.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <Eigen/Geometry>
#include <yaml-cpp/yaml.h>

namespace collision_pairs {

/// One source of point clouds. Metres and seconds.
struct CloudConfig {
  /// sensor_msgs/PointCloud2.
  std::string topic;
  /// Edge of a voxel: cell k covers [k s, (k + 1) s) along each axis of the fixed frame.
  double voxel_size = 0.02;
  /// Points further from the origin of the cloud's frame are left out.
  double max_range = 5.0;
  /// A voxel with fewer points of one cloud is not occupied by it. More than 1 hides noise, and
  /// what is small or far away.
  int min_points = 1;
  /// How long a voxel stays occupied that no cloud shows again.
  double decay = 0.5;
  /// Each cloud shows everything: what the newest does not show is gone at once.
  bool replace = false;
  /// Points outside of it, a box in the fixed frame, are left out.
  std::optional<Eigen::AlignedBox3d> box;
  /// Of more occupied voxels the farthest from the sensor are left out, and nothing is FREE.
  int max_voxels = 1000000;
  /// A source whose newest usable cloud is older against now makes the verdict UNKNOWN; 0: never
  /// too old.
  double source_timeout = 1.0;
  /// Points within this distance of a link or an attached object are not obstacles.
  double self_filter_padding = 0.02;
  /// Links, names or patterns, that are not checked against this cloud.
  std::vector<std::string> touch_links;

  /// What pairs call it: the topic without its leading slash.
  std::string name() const;
};

bool operator==(const CloudConfig& a, const CloudConfig& b);

/// Throws InputError that says which cloud, key and value, and what it must be; a key that is none
/// of these is refused, with the nearest one.
std::vector<CloudConfig> readClouds(const YAML::Node& value);

}  // namespace collision_pairs
