// Spheres that together enclose a solid, and spheres inside it.
#pragma once

#include <mutex>
#include <utility>
#include <vector>

#include "outer_spheres.h"
#include "prepared_shape.h"

namespace collision_pairs {

struct SphereCover {
  std::vector<OuterSphere> outer;  ///< a tree whose leaves enclose the solid
  /// Wholly inside the solid, the largest first. None if the surface is not closed or the solid has
  /// no volume.
  std::vector<PlacedSphere> inner;
};

/// In the shape's frame; not for half-spaces. The solid is that of NarrowPhase::touches(): for a
/// mesh its triangles and all points inside according to WindingNumber::holds(). most_spheres: of
/// the tree. Cost: that of outerSpheres(), and three thousand queries for the nearest point of the
/// surface.
SphereCover coverBySpheres(const Prepared& shape, std::size_t most_spheres);

/// The spheres of a mesh at Fidelity::SPHERES. Built by the first thread that requests them, while
/// others wait; immutable afterwards.
class FineSpheres {
 public:
  static constexpr std::size_t MOST_SPHERES = 2047;

  explicit FineSpheres(Shape shape) : shape_(std::move(shape)) {}
  /// Cost of the first call: prepareShape() and coverBySpheres(), some 0.2 s for a link.
  const std::vector<OuterSphere>& get() const;

 private:
  const Shape shape_;
  mutable std::once_flag is_made_;
  mutable std::vector<OuterSphere> spheres_;
};

}  // namespace collision_pairs
