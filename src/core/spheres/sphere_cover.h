// Spheres that together enclose a solid, and spheres inside of it.
#pragma once

#include <mutex>
#include <utility>
#include <vector>

#include "outer_spheres.h"
#include "prepared_shape.h"

namespace collision_pairs {

struct SphereCover {
  std::vector<OuterSphere> outer;  ///< a tree whose leaves enclose the solid
  /// Wholly inside the solid, the largest first. None where the surface is not closed, or of
  /// solids without volume.
  std::vector<PlacedSphere> inner;
};

/// In the shape's frame; not of a half-space. What "solid" means is what NarrowPhase::touches()
/// answers by: of a mesh its triangles and all that WindingNumber::holds() says is inside.
/// most_spheres: of the tree. Cost: that of outerSpheres(), and three thousand queries for the
/// nearest point of the surface.
SphereCover coverBySpheres(const Prepared& shape, std::size_t most_spheres);

/// The spheres that a mesh is checked by at Fidelity::SPHERES: made when they are first asked for,
/// by whichever thread; all others wait. Immutable then.
class FineSpheres {
 public:
  static constexpr std::size_t MOST_SPHERES = 2047;

  explicit FineSpheres(Shape shape) : shape_(std::move(shape)) {}
  /// Cost: the first time that of prepareShape() and coverBySpheres(), some 0.2 s for a link.
  const std::vector<OuterSphere>& get() const;

 private:
  const Shape shape_;
  mutable std::once_flag is_made_;
  mutable std::vector<OuterSphere> spheres_;
};

}  // namespace collision_pairs
