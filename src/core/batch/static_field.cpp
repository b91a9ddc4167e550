#include "static_field.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace collision_pairs {
namespace {

using Eigen::Vector3d;

constexpr double INFINITE = std::numeric_limits<double>::infinity();
constexpr double ROUNDING = 1e-7;  // of what is stored, relative: as a float

/// Signed distance of a point from a box around the origin.
double distanceFromBox(const Vector3d& half, const Vector3d& p) {
  const Vector3d beyond = p.cwiseAbs() - half;
  return beyond.cwiseMax(0.0).norm() + std::min(beyond.maxCoeff(), 0.0);
}

}  // namespace

StaticField::StaticField(const CollisionScene& scene, const BatchModel& model,
                         std::vector<std::uint32_t> elements, const Aabb& region)
    : scene_(scene),
      model_(model),
      elements_(std::move(elements)),
      origin_(region.min),
      cell_size_((region.max - region.min) / SIDE),
      cells_a_metre_(cell_size_.cwiseInverse()),
      slots_(std::make_unique<Slot[]>(SIDE * SIDE * SIDE)) {}

StaticField::Bounds StaticField::find(const Vector3d& p_W, bool closely) const {
  const Vector3d place = (p_W - origin_).cwiseProduct(cells_a_metre_);
  const bool is_within = (place.array() >= 0.0).all() && (place.array() < SIDE).all();
  if (!is_within) return {-INFINITE, INFINITE, 0};
  const Eigen::Vector3i cell = place.cast<int>();
  Slot& slot = slots_[static_cast<std::size_t>((cell[2] * SIDE + cell[1]) * SIDE + cell[0])];
  const Vector3d center =
      origin_ + (cell.cast<double>().array() + 0.5).matrix().cwiseProduct(cell_size_);
  if (!slot.is_known.load(std::memory_order_acquire)) fill(center, slot);
  const std::uint32_t nb_near = slot.nb_near.load(std::memory_order_relaxed);
  if (closely && nb_near <= MOST_NEAR) {
    Bounds bounds{INFINITE, INFINITE, 0};
    for (std::uint32_t i = 0; i < nb_near; ++i) {
      look(slot.near[i].load(std::memory_order_relaxed), p_W, bounds);
    }
    return bounds;
  }
  const double beside = (p_W - center).norm();
  return {slot.apart.load(std::memory_order_relaxed) - beside,
          slot.upper.load(std::memory_order_relaxed) + beside,
          slot.element.load(std::memory_order_relaxed)};
}

void StaticField::fill(const Vector3d& p_W, Slot& slot) const {
  Bounds bounds{INFINITE, INFINITE, 0};
  for (const std::uint32_t element : elements_) look(element, p_W, bounds);
  // From the centre to another point of the cell distances change by half its diagonal at most.
  const double within = bounds.apart + cell_size_.norm() * (1.0 + ROUNDING);
  std::uint32_t nb_near = 0;
  for (const std::uint32_t element : elements_) {
    Bounds of_one{INFINITE, INFINITE, 0};
    look(element, p_W, of_one);
    if (of_one.apart > within) continue;
    if (nb_near < MOST_NEAR) slot.near[nb_near].store(element, std::memory_order_relaxed);
    ++nb_near;
  }
  slot.nb_near.store(nb_near, std::memory_order_relaxed);
  slot.apart.store(static_cast<float>(bounds.apart - ROUNDING * std::abs(bounds.apart)),
                   std::memory_order_relaxed);
  slot.upper.store(static_cast<float>(bounds.upper + ROUNDING * std::abs(bounds.upper)),
                   std::memory_order_relaxed);
  slot.element.store(bounds.element, std::memory_order_relaxed);
  slot.is_known.store(true, std::memory_order_release);
}

void StaticField::look(std::uint32_t id, const Vector3d& p_W, Bounds& bounds) const {
  const SceneElement& element = scene_.elements()[id];
  const Vector3d p_E = element.X_BE.inverse() * p_W;
  double apart, upper = INFINITE;
  if (const auto* box = std::get_if<Box>(&element.shape)) {
    apart = upper = distanceFromBox(0.5 * box->size, p_E);
  } else if (std::holds_alternative<HalfSpace>(element.shape)) {
    apart = upper = p_E[2];
  } else {
    apart = distanceFromBox(element.box_half, p_E - element.box_center);
    const BallCover& cover = model_.covers[id];
    if (apart < bounds.apart) {
      double of_leaves = INFINITE;
      const auto leaves = cover.outer.begin() + static_cast<std::ptrdiff_t>(cover.outer.size() / 2);
      for (auto ball = leaves; ball != cover.outer.end(); ++ball) {
        of_leaves = std::min(of_leaves, (p_E - ball->center).norm() - ball->radius);
      }
      apart = std::max(apart, of_leaves);
    }
    for (const Ball& ball : cover.inner) {
      upper = std::min(upper, (p_E - ball.center).norm() - ball.radius);
    }
  }
  bounds.apart = std::min(bounds.apart, apart);
  if (upper < bounds.upper) bounds.upper = upper, bounds.element = id;
}

}  // namespace collision_pairs
