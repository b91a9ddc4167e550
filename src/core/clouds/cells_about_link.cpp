#include "cells_about_link.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace collision_pairs {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;

constexpr double LEAST_CELL_EDGE = 0.002;     // metres
constexpr double MOST_CELLS_ALONG = 1 << 19;  // so that a cell fits in 62 bits
constexpr double HALF_DIAGONAL = 0.87;        // relative to a cube's edge; rounded up
constexpr double CELL_ROUNDING = 1e-9;        // metres, and relative to the size
constexpr std::size_t FIRST_CELLS = 256;
constexpr std::size_t MOST_KNOWN = 1u << 20;  // cells: 32 MB; then all are discarded

const std::shared_ptr<const PreparedShape>& point() {
  static const std::shared_ptr<const PreparedShape> POINT = prepareShape(Sphere{0.0});
  return POINT;
}

}  // namespace

CellsAboutLink::CellsAboutLink(SceneElement element, double padding)
    : shape_(element.rung(Fidelity::MESH).shape), padding_(padding), slots_(FIRST_CELLS, 0) {
  grown_.center = element.box_center;
  grown_.half = element.box_half;
  grown_.half.array() += padding * (1.0 + CELL_ROUNDING) + CELL_ROUNDING;
  // A third of the padding: points on the surface, with noise of a quarter of the padding, are then
  // in cells that are entirely within it.
  edge_ = std::max(padding / 3.0, LEAST_CELL_EDGE);
  if (grown_.half.allFinite()) edge_ = std::max(edge_, 2.0 * grown_.size() / MOST_CELLS_ALONG);
}

CellsAboutLink::Points CellsAboutLink::ownAbout(const Vector3d& p_EP, NarrowPhase& narrow_phase) {
  const Vector3d from_corner = p_EP - grown_.center + grown_.half;
  const bool is_outside =
      (from_corner.array() < 0.0 || from_corner.array() > 2.0 * grown_.half.array()).any();
  if (is_outside) return Points::NONE;
  if (!grown_.half.allFinite()) return Points::SOME;
  const Eigen::Array<std::int64_t, 3, 1> cell = (from_corner.array() / edge_).cast<std::int64_t>();
  const auto key = static_cast<std::uint64_t>(cell[0] | cell[1] << 20 | cell[2] << 40);
  std::uint64_t& slot = slotOf(key);
  auto points = static_cast<Points>(slot & 3);
  if (points != Points::UNKNOWN) return points;
  const Vector3d in_cell = edge_ * (cell.cast<double>() + 0.5).matrix();
  points = classify(in_cell + grown_.center - grown_.half, narrow_phase);
  slot = key << 2 | static_cast<std::uint64_t>(points);
  ++nb_known_;
  if (2 * nb_known_ > slots_.size()) grow();
  return points;
}

CellsAboutLink::Points CellsAboutLink::classify(const Vector3d& p_ECenter,
                                                NarrowPhase& narrow_phase) const {
  const double size = grown_.half.maxCoeff() + grown_.center.cwiseAbs().maxCoeff();
  const double radius = HALF_DIAGONAL * edge_ + CELL_ROUNDING * (1.0 + size);
  const double metres = distance(p_ECenter, padding_ + radius, narrow_phase);
  if (metres > padding_ + radius) return Points::NONE;
  return metres + radius <= padding_ ? Points::ALL : Points::SOME;
}

double CellsAboutLink::distance(const Vector3d& p_EP, double max_distance,
                                NarrowPhase& narrow_phase) const {
  const Isometry3d X_EP(Eigen::Translation3d{p_EP});
  const PairDistance found = narrow_phase.distance(*shape_, *point(), X_EP, max_distance);
  // Uncertain points count as obstacles: at worst a false alarm.
  if (found.certainty == Certainty::DEGRADED) return std::numeric_limits<double>::infinity();
  return found.certainty == Certainty::BOUND ? 0.0 : found.distance;
}

std::uint64_t& CellsAboutLink::slotOf(std::uint64_t cell) {
  const std::size_t mask = slots_.size() - 1;
  std::size_t i = static_cast<std::size_t>((cell * 0x9e3779b97f4a7c15u) >> 32) & mask;
  while (slots_[i] != 0 && slots_[i] >> 2 != cell) i = (i + 1) & mask;
  return slots_[i];
}

void CellsAboutLink::grow() {
  if (nb_known_ > MOST_KNOWN) {
    std::fill(slots_.begin(), slots_.end(), 0);
    nb_known_ = 0;
    return;
  }
  const std::vector<std::uint64_t> before = std::move(slots_);
  slots_.assign(2 * before.size(), 0);
  for (const std::uint64_t slot : before) {
    if (slot != 0) slotOf(slot >> 2) = slot;
  }
}

}  // namespace collision_pairs
