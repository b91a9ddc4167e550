// Balls that together enclose a solid, and balls inside of it.
#pragma once

#include <vector>

#include "enclosing_ball.h"
#include "prepared_shape.h"

namespace collision_pairs {

struct BallCover {
  /// A binary tree, the children of ball i are 2 i + 1 and 2 i + 2; all leaves at one depth. Each
  /// ball encloses its cell's part of the solid, so those of any one depth enclose all of it.
  std::vector<Ball> outer;
  /// Wholly inside the solid, the largest first. None where the surface is not closed, or of
  /// solids without volume.
  std::vector<Ball> inner;
};

/// In the shape's frame; not of a half-space. What "solid" means is what NarrowPhase::touches()
/// answers by: of a mesh its triangles and all that WindingNumber::holds() says is inside.
/// The cells are those of a k-d tree: their boxes shrunk to what is in them and split in the middle
/// of the longest side. In a box, every extreme point of the solid is a corner of a clipped
/// triangle or of the box: a ball around these encloses that part of the solid. Cost: for a mesh of
/// n triangles O(n) clippings, and a thousand queries for the nearest point of its surface: a few
/// milliseconds.
BallCover coverByBalls(const Prepared& shape);

}  // namespace collision_pairs
