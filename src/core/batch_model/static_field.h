// Distances of the static elements of a scene, stored in cells.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <vector>

#include "batch_model.h"

namespace collision_pairs {

/// Bounds of the distance to static elements at the centres of the cells of a box in W. A cell is
/// filled in when it is first read, so that no more is computed than states need. Thread safe; all
/// threads get the same values.
class StaticField {
 public:
  static constexpr int SIDE = 64;                     ///< cells, along each side of the box
  static constexpr std::size_t MOST_ELEMENTS = 1000;  ///< preparation tests each of them

  /// `elements`: static ones of the scene. Scene and model must outlive this. Memory: 24 bytes per
  /// cell. Cost of filling in a cell: about 10 ns per element, 20 times that for a mesh.
  StaticField(const CollisionScene& scene, const BatchModel& model,
              std::vector<std::uint32_t> elements, const Aabb& region);

  /// True if a point in W is certainly further than `reach` (metres, >= 0) from every element: by
  /// the bound of its cell's centre minus the distance to it, or else by the elements near the cell
  /// if they are few. False outside of the region. Cost: 5 or 50 ns.
  bool isFurther(const Eigen::Vector3d& p_W, double reach) const;
  /// True if a point is certainly nearer than `reach` to some element (or deeper inside it, if
  /// `reach` is negative), which is written to `element`.
  bool isNearer(const Eigen::Vector3d& p_W, double reach, std::uint32_t& element) const;
  /// The bounds of the cells, for kernels, which may take the next cell at a border.
  BatchGrid grid() const;
  static std::size_t memory() {
    return (sizeof(Slot) + sizeof(std::atomic<int>)) * SIDE * SIDE * SIDE;
  }

 private:
  static constexpr std::uint32_t MOST_NEAR = 4, NOT_FILLED = 0xffffffff;
  struct Slot {
    /// All elements that can be nearest to a point of the cell; if there are more than MOST_NEAR,
    /// only their number. The number is written last.
    std::atomic<std::uint32_t> nb_near{NOT_FILLED}, near[MOST_NEAR] = {};
  };
  /// A static element and its inverse pose.
  struct PlacedElement {
    std::uint32_t element;
    Eigen::Matrix3d R_EW;
    Eigen::Vector3d p_EW;
  };
  /// Returns a lower bound of the distance of p_W from all `elements`. Appends those to `near` that
  /// can be nearest to a point of a cell around it with the given diagonal.
  double findNear(const Eigen::Vector3d& p_W, double diagonal,
                  const std::vector<std::uint32_t>& elements,
                  std::vector<std::uint32_t>& near) const;
  /// The cell of p_W, filled in, and its centre; -1 outside of the region.
  int cellOf(const Eigen::Vector3d& p_W, Eigen::Vector3d& center) const;
  void fill(const Eigen::Vector3d& p_W, const std::vector<std::uint32_t>& elements, int cell) const;
  /// A lower bound of the distance. It is computed no more tightly than needed to exceed `enough`.
  double apartFrom(const PlacedElement& placed, const Eigen::Vector3d& p_W, double enough) const;
  /// An upper bound of the signed distance, negative inside.
  double upperOf(const PlacedElement& placed, const Eigen::Vector3d& p_W) const;

  const CollisionScene& scene_;
  const BatchModel& model_;
  std::vector<PlacedElement> placed_;
  Eigen::Vector3d origin_, cell_size_;  ///< floats
  double margin_;                       ///< m: far above the rounding of a place as float
  std::unique_ptr<Slot[]> slots_;
  /// Lower bound of the distance of a cell's centre to any element, as BatchGrid has it: apart from
  /// the rest, so that what is read most stays in the cache.
  std::unique_ptr<std::atomic<int>[]> apart_;
  std::vector<std::vector<std::uint32_t>> near_block_;  // elements, by block of 4 x 4 x 4 cells
};

}  // namespace collision_pairs
