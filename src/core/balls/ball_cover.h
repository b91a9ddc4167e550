// Balls that together enclose a solid, and balls inside of it.
#pragma once

#include <mutex>
#include <utility>
#include <vector>

#include "outer_balls.h"
#include "prepared_shape.h"

namespace collision_pairs {

struct BallCover {
  std::vector<OuterBall> outer;  ///< a tree whose leaves enclose the solid
  /// Wholly inside the solid, the largest first. None where the surface is not closed, or of
  /// solids without volume.
  std::vector<Ball> inner;
};

/// In the shape's frame; not of a half-space. What "solid" means is what NarrowPhase::touches()
/// answers by: of a mesh its triangles and all that WindingNumber::holds() says is inside.
/// most_balls: of the tree. Cost: that of outerBalls(), and three thousand queries for the nearest
/// point of the surface.
BallCover coverByBalls(const Prepared& shape, std::size_t most_balls);

/// The balls that a mesh is checked by at Fidelity::SPHERES: made when they are first asked for, by
/// whichever thread; all others wait. Immutable then.
class FineBalls {
 public:
  static constexpr std::size_t MOST_BALLS = 2047;

  explicit FineBalls(Shape shape) : shape_(std::move(shape)) {}
  /// Cost: the first time that of prepareShape() and coverByBalls(), some 0.2 s for a link.
  const std::vector<OuterBall>& get() const;

 private:
  const Shape shape_;
  mutable std::once_flag is_made_;
  mutable std::vector<OuterBall> balls_;
};

}  // namespace collision_pairs
