#include "near_parts.h"

#include <algorithm>
#include <cmath>

namespace collision_pairs {
namespace {

using Eigen::Array3d;
using Eigen::Array3i;
using Eigen::Vector3d;

constexpr double MOST_CELLS = 32.0;  // on the longest axis
constexpr double FURTHEST = 1e100;   // metres: larger boxes are near every point
constexpr double ROUNDED_UP = 1e-12;

Aabb aabbOf(const OrientedBox& box) {
  const Vector3d half = box.R.cwiseAbs() * box.half;
  const Vector3d grown = half + ROUNDED_UP * (half + box.center.cwiseAbs());
  return {box.center - grown, box.center + grown};
}

}  // namespace

void NearParts::begin(double least_edge) {
  least_edge_ = least_edge;
  boxes_.clear();
  unbounded_.clear();
  entries_.clear();
  bounds_ = noBox();
}

void NearParts::add(const OrientedBox& box) {
  const Aabb aabb = aabbOf(box);
  const bool is_bounded =
      aabb.valid() && aabb.min.minCoeff() > -FURTHEST && aabb.max.maxCoeff() < FURTHEST;
  if (!is_bounded) {
    unbounded_.push_back(static_cast<std::uint32_t>(boxes_.size()));
    return addNothing();
  }
  bounds_ = enclosing(bounds_, aabb);
  boxes_.push_back(box);
}

void NearParts::addNothing() {
  OrientedBox nothing;
  nothing.half.setConstant(-1.0);
  boxes_.push_back(nothing);
}

void NearParts::end() {
  nb_cells_.setZero();
  if (bounds_.valid()) {
    const Array3d size = (bounds_.max - bounds_.min).array();
    cells_a_metre_ = 1.0 / std::max(size.maxCoeff() / MOST_CELLS, least_edge_);
    nb_cells_ = (size * cells_a_metre_).floor().cast<int>() + 1;
  }
  for (std::uint32_t part = 0; part < boxes_.size(); ++part) enterCells(part);
  for (const std::uint32_t part : unbounded_) {
    for (int cell = 0; cell < nb_cells_.prod(); ++cell) {
      entries_.push_back({static_cast<std::uint32_t>(cell), part});
    }
  }
  first_.assign(static_cast<std::size_t>(nb_cells_.prod()) + 1, 0);
  for (const Entry& entry : entries_) ++first_[entry.cell + 1];
  for (std::size_t i = 1; i < first_.size(); ++i) first_[i] += first_[i - 1];
  next_.assign(first_.begin(), first_.end());
  parts_.resize(entries_.size());
  for (const Entry& entry : entries_) parts_[next_[entry.cell]++] = entry.part;
}

Array3i NearParts::cellAt(const Vector3d& p_W) const {
  // Rounds towards zero, so coordinates just below the first cell are in it.
  return ((p_W - bounds_.min).array() * cells_a_metre_).cast<int>().max(0).min(nb_cells_ - 1);
}

void NearParts::enterCells(std::uint32_t part) {
  const OrientedBox& box = boxes_[part];
  if (box.half[0] < 0.0) return;
  const Aabb aabb = aabbOf(box);
  const Array3i low = cellAt(aabb.min), high = cellAt(aabb.max);
  const double edge = 1.0 / cells_a_metre_;
  const double size = bounds_.min.cwiseAbs().maxCoeff() + bounds_.max.cwiseAbs().maxCoeff();
  OrientedBox cube;
  cube.half.setConstant(0.5 * edge + ROUNDED_UP * size);
  for (int z = low[2]; z <= high[2]; ++z) {
    for (int y = low[1]; y <= high[1]; ++y) {
      for (int x = low[0]; x <= high[0]; ++x) {
        cube.center = bounds_.min + edge * (Vector3d(x, y, z).array() + 0.5).matrix();
        if (squaredBoxGap(cube, box) > 0.0) continue;
        const int cell = x + nb_cells_[0] * (y + nb_cells_[1] * z);
        entries_.push_back({static_cast<std::uint32_t>(cell), part});
      }
    }
  }
}

NearParts::Range NearParts::at(const Vector3d& p_W) const {
  const bool is_inside =
      (p_W.array() >= bounds_.min.array() && p_W.array() <= bounds_.max.array()).all();
  if (!is_inside) return {unbounded_.data(), unbounded_.data() + unbounded_.size()};
  const Array3i at = cellAt(p_W);
  const auto cell = static_cast<std::size_t>(at[0] + nb_cells_[0] * (at[1] + nb_cells_[1] * at[2]));
  return {parts_.data() + first_[cell], parts_.data() + first_[cell + 1]};
}

}  // namespace collision_pairs
