// How far the static elements of a scene are, kept in cells.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <vector>

#include "batch_model.h"

namespace collision_pairs {

/// Bounds of the distance to what is static, at the centres of the cells of a box in W. A cell is
/// filled in when it is first asked for, so that no more is computed than states need; several
/// threads may ask at a time, and find the same.
class StaticField {
 public:
  static constexpr int SIDE = 64;                     ///< cells, along each side of the box
  static constexpr std::size_t MOST_ELEMENTS = 1000;  ///< a cell looks at each of them

  /// `elements`: of the scene, static. Both must outlive this. Memory: 28 bytes a cell.
  /// Cost: of a cell that is filled in, about 10 ns an element, and 20 times that for a mesh.
  StaticField(const CollisionScene& scene, const BatchModel& model,
              std::vector<std::uint32_t> elements, const Aabb& region);

  /// Is a point in W certainly further than `reach` (metres, >= 0) from every element? By the bound
  /// of its cell's centre, less the way to it; else, where few elements are near the cell, by
  /// these. Outside of the region nothing is certain. 5 or 50 ns.
  bool isFurther(const Eigen::Vector3d& p_W, double reach) const;
  /// Is a point certainly nearer to some element than that (or deeper in it, if `reach` is
  /// negative)? Then to the one that is written to `element`.
  bool isNearer(const Eigen::Vector3d& p_W, double reach, std::uint32_t& element) const;
  static std::size_t memory() { return sizeof(Slot) * SIDE * SIDE * SIDE; }

 private:
  static constexpr std::uint32_t MOST_NEAR = 4;
  struct Slot {
    std::atomic<bool> is_known{false};
    std::atomic<float> apart{0.0f};  ///< no element is nearer to the centre
    /// All that can be nearest to a point of the cell; if there are more, their number alone.
    std::atomic<std::uint32_t> nb_near{0}, near[MOST_NEAR] = {};
  };
  /// A static element, to be looked at.
  struct Thing {
    std::uint32_t element;
    Eigen::Matrix3d R_EW;
    Eigen::Vector3d p_EW;
  };
  /// Returns a bound of the distance of p_W, and those of `things` that can be nearest to a point
  /// of the cell about it with that diagonal.
  double findNear(const Eigen::Vector3d& p_W, double diagonal,
                  const std::vector<std::uint32_t>& things, std::vector<std::uint32_t>& near) const;
  /// The cell of p_W, filled in, and its centre; null outside of the region.
  const Slot* slotOf(const Eigen::Vector3d& p_W, Eigen::Vector3d& center) const;
  void fill(const Eigen::Vector3d& p_W, const std::vector<std::uint32_t>& things, Slot& slot) const;
  /// The element is no nearer than this. Where that is less than `enough`, it may be less than need
  /// be.
  double apartFrom(const Thing& thing, const Eigen::Vector3d& p_W, double enough) const;
  /// The element is no further away, or the point so deep inside.
  double upperOf(const Thing& thing, const Eigen::Vector3d& p_W) const;

  const CollisionScene& scene_;
  const BatchModel& model_;
  std::vector<Thing> things_;
  Eigen::Vector3d origin_, cell_size_, cells_a_metre_;
  std::unique_ptr<Slot[]> slots_;
  std::vector<std::vector<std::uint32_t>> near_block_;  // things, by block of 4 x 4 x 4 cells
};

}  // namespace collision_pairs
