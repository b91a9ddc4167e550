// A room with boxes in it, as points, and as a depth camera sees it with a robot in the middle.
#pragma once

#include <cstdint>
#include <vector>

#include "benchmark_robots.h"
#include "collision_pairs/aabb.h"

namespace collision_pairs {

using Points = std::vector<Eigen::Vector3d>;

class Room {
 public:
  /// A floor at z = 0, 6 m by 6 m, two walls 2.5 m high and `nb_boxes` boxes about the middle.
  explicit Room(int nb_boxes);

  /// On all surfaces, `step` metres from each other.
  Points points(double step) const;

  /// What a depth camera of 640 by 480 pixels in p_WC that looks at p_WT sees of the room and of
  /// the robot, row by row, with 2 mm of noise along the ray; NaN where it sees nothing.
  Points seenFrom(const Eigen::Vector3d& p_WC, const Eigen::Vector3d& p_WT, const RobotModel& robot,
                  const std::vector<Eigen::Isometry3d>& X_WB, unsigned seed = 2) const;

 private:
  std::vector<Aabb> boxes_;  // floor and walls, too
};

}  // namespace collision_pairs
