// The parameter ~clouds: which point clouds are obstacles, and how they are read.
#pragma once

#include <algorithm>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Geometry>
#include <yaml-cpp/yaml.h>

#include "collision_pairs/scene_description.h"

namespace collision_pairs {

/// One source of point clouds. Metres and seconds.
struct CloudConfig {
  /// sensor_msgs/PointCloud2.
  std::string topic;
  /// Edge of a voxel: cell k covers [k s, (k + 1) s) along each axis of the fixed frame.
  double voxel_size = 0.02;
  /// Points further from the origin of the cloud's frame are ignored.
  double max_range = 5.0;
  /// Points of one cloud needed to occupy a voxel. Values above 1 suppress noise, but also small or
  /// distant obstacles.
  int min_points = 1;
  /// A cloud is refused unless this many of its points are finite and within max_range: a camera
  /// that sees nothing at all is more often broken than alone. Points outside the box and on the
  /// robot count. 0: none needed.
  int min_valid_points = 1;
  /// How long a voxel stays occupied after it was last seen.
  double decay = 0.5;
  /// Each cloud replaces the previous one.
  bool replace = false;
  /// Points outside this box in the fixed frame are ignored.
  std::optional<Eigen::AlignedBox3d> box;
  /// Beyond this number the voxels farthest from the sensor are dropped, and no verdict is FREE.
  int max_voxels = 1000000;
  /// The verdict is UNKNOWN if the newest usable cloud of this source is older; 0: no limit.
  double source_timeout = 1.0;
  /// Points within this distance of a link or an attached object are not obstacles.
  double self_filter_padding = 0.02;
  /// Links, names, that are not checked against this cloud.
  std::vector<std::string> touch_links;

  /// Metres that every link keeps to its voxels, unless pair_padding says otherwise: what comes
  /// nearer is in contact before it is taken for the robot, though only some of its points are
  /// seen.
  double padding() const { return self_filter_padding + voxel_size; }
  /// Metres: what was seen this near the robot is followed. Covers what moves from one cloud to
  /// the next.
  double near() const { return self_filter_padding + std::max(0.08, 2.0 * voxel_size); }

  /// Its name in pairs: the topic without its leading slash.
  std::string name() const;
};

bool operator==(const CloudConfig& a, const CloudConfig& b);

/// The obstacle that a scene has for it.
RigidObject obstacleOf(const CloudConfig& cloud);

/// The one with that name; null if there is none.
const CloudConfig* findCloud(const std::vector<CloudConfig>& clouds, const std::string& name);

/// Throws InputError that names the cloud, key, value and rule; an unknown key is refused with the
/// closest known one.
std::vector<CloudConfig> readClouds(const YAML::Node& value);

}  // namespace collision_pairs
