#include "static_field.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "infinity.h"

namespace collision_pairs {
namespace {

using Eigen::Vector3d;

constexpr int BLOCKS = StaticField::SIDE / 4;
constexpr double STORED_ROUNDING = 1e-7;  // relative, of a bound stored as float

int bitsOf(double value) {
  const auto number = static_cast<float>(value);
  int bits;
  static_assert(sizeof bits == sizeof number);
  std::memcpy(&bits, &number, sizeof bits);
  return bits;
}

float floatOf(int bits) {
  float number;
  std::memcpy(&number, &bits, sizeof number);
  return number;
}

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
      origin_(region.min.cast<float>().cast<double>()),
      cell_size_(((region.max - region.min) / SIDE).cast<float>().cast<double>()),
      margin_(1e-6 * (origin_.norm() + SIDE * cell_size_.norm())),
      slots_(std::make_unique<Slot[]>(SIDE * SIDE * SIDE)),
      apart_(std::make_unique<std::atomic<int>[]>(SIDE * SIDE * SIDE)),
      near_block_(BLOCKS * BLOCKS * BLOCKS) {
  std::fill_n(apart_.get(), SIDE * SIDE * SIDE, bitsOf(-INF));
  std::vector<std::uint32_t> all;
  for (const std::uint32_t element : elements) {
    const Eigen::Isometry3d X_EW = scene.elements()[element].X_BE.inverse();
    all.push_back(static_cast<std::uint32_t>(placed_.size()));
    placed_.push_back({element, X_EW.linear(), X_EW.translation()});
  }
  const Vector3d block_size = cell_size_ * (SIDE / BLOCKS);
  for (int i = 0; i < BLOCKS * BLOCKS * BLOCKS; ++i) {
    const Vector3d block(i % BLOCKS + 0.5, i / BLOCKS % BLOCKS + 0.5, i / (BLOCKS * BLOCKS) + 0.5);
    findNear(origin_ + block.cwiseProduct(block_size), block_size.norm(), all,
             near_block_[static_cast<std::size_t>(i)]);
  }
}

BatchGrid StaticField::grid() const {
  static_assert(sizeof(std::atomic<int>) == sizeof(int) && std::atomic<int>::is_always_lock_free);
  BatchGrid grid{reinterpret_cast<const int*>(apart_.get()), SIDE, {}, {}, {}};
  for (int axis = 0; axis < 3; ++axis) {
    grid.origin[axis] = static_cast<float>(origin_[axis]);
    grid.size[axis] = static_cast<float>(cell_size_[axis]);
    grid.cells_a_metre[axis] = 1.0f / grid.size[axis];
  }
  return grid;
}

int StaticField::cellOf(const Vector3d& p_W, Vector3d& center) const {
  const Vector3d place = (p_W - origin_).cwiseQuotient(cell_size_);
  const bool is_within = (place.array() >= 0.0).all() && (place.array() < SIDE).all();
  if (!is_within) return -1;
  const Eigen::Vector3i along = place.cast<int>();
  const int cell = (along[2] * SIDE + along[1]) * SIDE + along[0];
  center = origin_ + (along.cast<double>().array() + 0.5).matrix().cwiseProduct(cell_size_);
  if (slots_[static_cast<std::size_t>(cell)].nb_near.load(std::memory_order_acquire) ==
      NOT_FILLED) {
    const Eigen::Vector3i block = along / (SIDE / BLOCKS);
    fill(center,
         near_block_[static_cast<std::size_t>((block[2] * BLOCKS + block[1]) * BLOCKS + block[0])],
         cell);
  }
  return cell;
}

bool StaticField::isFurther(const Vector3d& p_W, double reach) const {
  Vector3d center;
  const int cell = cellOf(p_W, center);
  if (cell < 0) return false;
  const auto index = static_cast<std::size_t>(cell);
  const double apart = floatOf(apart_[index].load(std::memory_order_relaxed)) + margin_;
  if (apart - (p_W - center).norm() > reach) return true;
  const Slot& slot = slots_[index];
  const std::uint32_t nb_near = slot.nb_near.load(std::memory_order_relaxed);
  if (nb_near > MOST_NEAR) return false;
  for (std::uint32_t i = 0; i < nb_near; ++i) {
    const PlacedElement& placed = placed_[slot.near[i].load(std::memory_order_relaxed)];
    if (!(apartFrom(placed, p_W, reach) > reach)) return false;
  }
  return true;
}

bool StaticField::isNearer(const Vector3d& p_W, double reach, std::uint32_t& element) const {
  Vector3d center;
  const int cell = cellOf(p_W, center);
  if (cell < 0) return false;
  const Slot& slot = slots_[static_cast<std::size_t>(cell)];
  const std::uint32_t nb_near = slot.nb_near.load(std::memory_order_relaxed);
  for (std::uint32_t i = 0; i < std::min(nb_near, MOST_NEAR); ++i) {
    const PlacedElement& placed = placed_[slot.near[i].load(std::memory_order_relaxed)];
    if (!(upperOf(placed, p_W) < reach)) continue;
    element = placed.element;
    return true;
  }
  return false;
}

// The bound of an element changes by at most the distance between two points. So an element whose
// bound exceeds the smallest one by more than the diagonal is the nearest nowhere in the cell.
double StaticField::findNear(const Vector3d& p_W, double diagonal,
                             const std::vector<std::uint32_t>& elements,
                             std::vector<std::uint32_t>& near) const {
  double apart = INF;
  for (const std::uint32_t i : elements) {
    apart = std::min(apart, apartFrom(placed_[i], p_W, -INF));
  }
  const double within = apart + diagonal * (1.0 + STORED_ROUNDING);
  for (const std::uint32_t i : elements) {
    if (apartFrom(placed_[i], p_W, -INF) <= within) near.push_back(i);
  }
  return apart;
}

void StaticField::fill(const Vector3d& p_W, const std::vector<std::uint32_t>& elements,
                       int cell) const {
  Slot& slot = slots_[static_cast<std::size_t>(cell)];
  thread_local std::vector<std::uint32_t> near;
  near.clear();
  const double apart = findNear(p_W, cell_size_.norm(), elements, near);
  for (std::size_t i = 0; i < near.size() && i < MOST_NEAR; ++i) {
    slot.near[i].store(near[i], std::memory_order_relaxed);
  }
  const double lower = apart - margin_;
  apart_[static_cast<std::size_t>(cell)].store(bitsOf(lower - STORED_ROUNDING * std::abs(lower)),
                                               std::memory_order_relaxed);
  slot.nb_near.store(static_cast<std::uint32_t>(near.size()), std::memory_order_release);
}

double StaticField::apartFrom(const PlacedElement& placed, const Vector3d& p_W,
                              double enough) const {
  const SceneElement& element = scene_.elements()[placed.element];
  const Vector3d p_E = placed.R_EW * p_W + placed.p_EW;
  if (std::holds_alternative<HalfSpace>(element.shape)) return p_E[2];
  const double of_box = distanceFromBox(element.box_half, p_E - element.box_center);
  const bool is_certain = enough > -INF && of_box > enough;
  if (is_certain || std::holds_alternative<Box>(element.shape)) return of_box;
  double of_leaves = INF;
  for (const OuterSphere& sphere : model_.covers[placed.element].outer) {
    if (of_leaves <= enough) break;
    if (sphere.first_child != 0) continue;
    of_leaves = std::min(of_leaves, (p_E - sphere.center).norm() - sphere.radius);
  }
  return std::max(of_box, of_leaves);
}

double StaticField::upperOf(const PlacedElement& placed, const Vector3d& p_W) const {
  const SceneElement& element = scene_.elements()[placed.element];
  const Vector3d p_E = placed.R_EW * p_W + placed.p_EW;
  if (std::holds_alternative<HalfSpace>(element.shape)) return p_E[2];
  if (const auto* box = std::get_if<Box>(&element.shape)) {
    return distanceFromBox(0.5 * box->size, p_E);
  }
  double upper = INF;
  for (const PlacedSphere& sphere : model_.covers[placed.element].inner) {
    upper = std::min(upper, (p_E - sphere.center).norm() - sphere.radius);
  }
  return upper;
}

}  // namespace collision_pairs
