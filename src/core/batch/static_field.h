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

  /// `elements`: of the scene, static. Both must outlive this. Memory: 36 bytes a cell.
  /// Cost: of a cell that is filled in, about 10 ns an element, and 20 times that for a mesh.
  StaticField(const CollisionScene& scene, const BatchModel& model,
              std::vector<std::uint32_t> elements, const Aabb& region);

  struct Bounds {
    double apart;  ///< no element is nearer; metres
    double upper;  ///< the distance from `element` is no more; negative: so deep inside
    std::uint32_t element;
  };
  /// Of a point in W: the cell's bounds, less its distance from the centre. Outside of the region
  /// nothing is known. About 5 ns.
  Bounds at(const Eigen::Vector3d& p_W) const { return find(p_W, false); }
  /// The same of the point itself, where few elements are near the cell. About 50 ns.
  Bounds closeTo(const Eigen::Vector3d& p_W) const { return find(p_W, true); }
  static std::size_t memory() { return sizeof(Slot) * SIDE * SIDE * SIDE; }

 private:
  static constexpr std::uint32_t MOST_NEAR = 4;
  struct Slot {
    std::atomic<bool> is_known{false};
    std::atomic<float> apart{0.0f}, upper{0.0f};
    std::atomic<std::uint32_t> element{0};
    /// All that can be nearest to a point of the cell; if there are more, their number alone.
    std::atomic<std::uint32_t> nb_near{0}, near[MOST_NEAR] = {};
  };
  Bounds find(const Eigen::Vector3d& p_W, bool closely) const;
  void fill(const Eigen::Vector3d& p_W, Slot& slot) const;
  void look(std::uint32_t element, const Eigen::Vector3d& p_W, Bounds& bounds) const;

  const CollisionScene& scene_;
  const BatchModel& model_;
  std::vector<std::uint32_t> elements_;
  Eigen::Vector3d origin_, cell_size_, cells_a_metre_;
  std::unique_ptr<Slot[]> slots_;
};

}  // namespace collision_pairs
