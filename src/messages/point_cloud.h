// sensor_msgs/PointCloud2 as points.
#pragma once

#include <vector>

#include <Eigen/Core>
#include <sensor_msgs/PointCloud2.h>

namespace collision_pairs {

/// The points of the cloud in its own frame, in their order, metres; without those of no return,
/// which have a coordinate that is not finite or are within 1 mm of the sensor. Coordinates x, y
/// and z may be float32 or float64, at any offset, of either endianness, in rows with any padding.
/// The contents of `points` are replaced; its memory is reused.
///
/// Throws InputError that names the error of the layout: a coordinate that is missing, repeated or
/// of another type, inconsistent sizes, or data too short for its points, or with room for more.
/// Never reads outside cloud.data. 640 x 480 packed float32 points: about 0.5 ms.
void readPoints(const sensor_msgs::PointCloud2& cloud, std::vector<Eigen::Vector3d>& points);

/// Throws as readPoints(), without reading the points.
void requireReadable(const sensor_msgs::PointCloud2& cloud);

/// A cloud of one row, packed float32, to which the points are rounded.
sensor_msgs::PointCloud2 toPointCloud2(const std::vector<Eigen::Vector3d>& points,
                                       const std_msgs::Header& header);

}  // namespace collision_pairs
