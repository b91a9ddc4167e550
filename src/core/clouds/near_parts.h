// Finds the parts of the robot near a point.
#pragma once

#include <cstdint>
#include <vector>

#include "box_gap.h"
#include "collision_pairs/aabb.h"

namespace collision_pairs {

/// A grid around the boxes of one cycle: each cell lists the boxes that may overlap it.
class NearParts {
 public:
  struct Range {
    const std::uint32_t *first, *last;
    const std::uint32_t* begin() const { return first; }
    const std::uint32_t* end() const { return last; }
  };

  /// `least_edge` of cells, metres: smaller ones are more to fill and tell little if the boxes have
  /// been grown by as much.
  void begin(double least_edge);
  /// In W; its index is the number of those added before. An infinite one is near every point.
  void add(const OrientedBox& box);
  void addNothing();  ///< takes the next index; near no point
  void end();

  /// Of all boxes; infinite if one of them is.
  Aabb bounds() const {
    const Aabb none = noBox();
    return unbounded_.empty() ? bounds_ : Aabb{none.max, none.min};
  }

  /// All boxes that contain the point, and possibly others near it.
  Range at(const Eigen::Vector3d& p_W) const;

 private:
  struct Entry {
    std::uint32_t cell, part;
  };

  Eigen::Array3i cellAt(const Eigen::Vector3d& p_W) const;
  void enterCells(std::uint32_t part);

  std::vector<OrientedBox> boxes_;
  std::vector<std::uint32_t> unbounded_;
  Aabb bounds_ = noBox();
  double least_edge_ = 0.0, cells_a_metre_ = 0.0;
  Eigen::Array3i nb_cells_ = Eigen::Array3i::Zero();
  std::vector<Entry> entries_;
  std::vector<std::uint32_t> first_, next_;  ///< by cell: the first of its parts
  std::vector<std::uint32_t> parts_;
};

}  // namespace collision_pairs
