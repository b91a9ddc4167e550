#include "solid_field.h"

#include <algorithm>
#include <cmath>

#include "covered_solid.h"

namespace collision_pairs {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;

constexpr double NODES = 10000.0;
constexpr double BORDER = 2.0;         // cells around the shape
constexpr double ROUNDING = 1e-6;      // relative: a bound is stored as float
constexpr double FIELD_MARGIN = 1e-7;  // relative to the size, and metres
constexpr double MOST_CELLS = 4000.0;  // up to here float is off by less than 0.002 cells

// Its size is of use to what may_hold() alone, which is not asked here.
CoveredSolid solidOf(const Prepared& shape) {
  return shape.mesh ? meshSolid(shape, 0.0) : hullSolid(shape.hull, 0.0);
}

}  // namespace

SolidField::Points::Points(const std::vector<Vector3d>& points) {
  for (const Vector3d& p : points) {
    for (int axis = 0; axis < 3; ++axis) at[axis].push_back(static_cast<float>(p[axis]));
    reach = std::max(reach, p.norm());
  }
}

std::unique_ptr<const SolidField> SolidField::make(const Prepared& shape) {
  if (shape.hull.faces.empty()) return nullptr;
  return std::unique_ptr<const SolidField>(new SolidField(shape));
}

SolidField::SolidField(const Prepared& shape)
    : margin_(FIELD_MARGIN *
              (1.0 + shape.core.extent + shape.core.radius + shape.core.center.norm())) {
  const CoveredSolid solid = solidOf(shape);
  const Aabb box = boxAround(shape.hull.points.vertices);
  const Vector3d size = box.max - box.min;
  width_ = std::cbrt((size.array() + 0.2 * size.maxCoeff()).prod() / NODES);
  off_ = 0.87 * width_ + margin_;  // half a diagonal, and the rounding of places
  cells_a_metre_ = 1.0 / width_;
  origin_ = box.min - Vector3d::Constant(BORDER * width_);
  nb_ = (size.array() / width_ + 2.0 * BORDER).ceil().cast<int>() + 1;
  bounds_.resize(static_cast<std::size_t>(nb_.prod()));
  std::size_t node = 0;
  for (int z = 0; z < nb_[2]; ++z) {
    for (int y = 0; y < nb_[1]; ++y) {
      double depth = 0.0;  // of the node before, metres
      bool is_inside = false;
      for (int x = 0; x < nb_[0]; ++x) {
        const Vector3d p = origin_ + width_ * Vector3d(x, y, z);
        // Further from the surface than the next node, it is on the same side as that.
        const bool is_same = std::abs(depth) > (1.0 + ROUNDING) * width_ && solid.holds;
        depth = solid.depth(p);
        is_inside = is_same ? is_inside : solid.holds ? solid.holds(p) : depth > 0.0;
        const double apart = solid.holds ? std::abs(depth) : is_inside ? depth : -depth;
        const double bound = std::max((1.0 - ROUNDING) * apart, 0.0);
        bounds_[node++] = static_cast<float>(!is_inside ? bound : solid.is_exact ? -bound : 0.0);
      }
    }
  }
}

// The square of the distance d from any set, minus |p|^2, is the least of functions that are linear
// in p, and so nowhere below what lies between its values at other points: with nodes c and the
// weights w of trilinear interpolation, d(p)^2 >= sum w d(c)^2 - sum w |c - p|^2, and the last sum
// is h^2 t (1 - t) for each axis. The same holds for the distance from all that is not solid, the
// depth. A point outside of the grid, q being the nearest point in it, has d(p)^2 >= |p - q|^2 +
// d(q)^2, because the box of the grid is convex and holds the solid.
template <bool OUTSIDE>
double SolidField::squareAt(const Vector3d& p) const {
  double t[3], beyond = 0.0, off = 0.0;
  std::size_t index = 0, row = 1;
  std::size_t rows[3];
  for (int axis = 0; axis < 3; ++axis) {
    const double place = (p[axis] - origin_[axis]) * cells_a_metre_;
    const double within = std::min(std::max(place, 0.0), static_cast<double>(nb_[axis] - 1));
    const int cell = std::min(static_cast<int>(within), nb_[axis] - 2);
    t[axis] = within - cell;
    off += t[axis] * (1.0 - t[axis]);
    beyond += (place - within) * (place - within);
    index += row * static_cast<std::size_t>(cell);
    rows[axis] = row;
    row *= static_cast<std::size_t>(nb_[axis]);
  }
  const auto at = [](const float* node) {
    const double bound = std::max(OUTSIDE ? *node : -*node, 0.0f);
    return bound * bound;
  };
  const auto along = [&](const float* node) { return at(node) + t[0] * (at(node + 1) - at(node)); };
  const float *const first = bounds_.data() + index, *const above = first + rows[2];
  const double low = along(first) + t[1] * (along(first + rows[1]) - along(first));
  const double high = along(above) + t[1] * (along(above + rows[1]) - along(above));
  return low + t[2] * (high - low) + width_ * width_ * ((OUTSIDE ? beyond : 0.0) - off);
}

bool SolidField::nearestNodes(const Points& points, const Isometry3d& X, float* nodes) const {
  if (!((X.translation().norm() + points.reach) * cells_a_metre_ < MOST_CELLS)) return false;
  const Eigen::Matrix3f R = (X.linear() * cells_a_metre_).cast<float>();
  // Rounded to the nearest node by what is added.
  const Eigen::Vector3f p =
      ((X.translation() - origin_) * cells_a_metre_ + Vector3d::Constant(0.5)).cast<float>();
  const float row[3] = {1.0f, static_cast<float>(nb_[0]), static_cast<float>(nb_[0] * nb_[1])};
  const std::size_t count = points.at[0].size();
  const float *const x = points.at[0].data(), *const y = points.at[1].data(),
                     *const z = points.at[2].data();
  int index[Points::MOST];
  for (std::size_t i = 0; i < count; ++i) {
    float node = 0.0f;
    for (int axis = 0; axis < 3; ++axis) {
      float place = R(axis, 0) * x[i] + R(axis, 1) * y[i] + R(axis, 2) * z[i] + p[axis];
      const auto last = static_cast<float>(nb_[axis] - 1);
      place = place > 0.0f ? place : 0.0f;
      place = place < last ? place : last;
      node += row[axis] * static_cast<float>(static_cast<int>(place));
    }
    index[i] = static_cast<int>(node);
  }
  for (std::size_t i = 0; i < count; ++i) nodes[i] = bounds_[static_cast<std::size_t>(index[i])];
  return true;
}

bool SolidField::isFurther(const Vector3d& p, double reach) const {
  const double beyond = reach + margin_;
  return squareAt<true>(p) > beyond * beyond;
}

bool SolidField::isInside(const Vector3d& p) const {
  return squareAt<false>(p) > margin_ * margin_;
}

}  // namespace collision_pairs
