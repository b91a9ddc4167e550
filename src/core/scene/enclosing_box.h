// The oriented box of an element.
#pragma once

#include <utility>

#include <Eigen/Geometry>

#include "collision_pairs/shape.h"

namespace collision_pairs {

/// A box that encloses the shape tightly, and its pose in the shape's frame E. For vertices: the
/// smallest of the boxes that have one axis along the frame or along a principal axis of the
/// vertices, each rotated about that axis to the smallest cross section (rotating calipers,
/// Toussaint 1983, by trying each edge of the planar hull). Enlarged by rounding.
std::pair<Box, Eigen::Isometry3d> enclosingBox(const Shape& shape);

}  // namespace collision_pairs
