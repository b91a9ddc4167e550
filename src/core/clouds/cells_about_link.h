// Tests whether points lie on the robot or near it: exact, with cached results.
#pragma once

#include <cstdint>
#include <vector>

#include "box_gap.h"
#include "collision_pairs/collision_scene.h"

namespace collision_pairs {

/// One element, and the space about it in cells in its own frame E. Of a cell that was met it is
/// known whether all of its points, none, or some are no further than the padding.
class CellsAboutLink {
 public:
  CellsAboutLink(SceneElement element, double padding);

  /// In E; holds all points that are own. Infinite for a half-space.
  const OrientedBox& grownBox() const { return grown_; }

  enum class Points : std::uint64_t { UNKNOWN = 0, NONE, ALL, SOME };
  /// Of the points of the cell of this one, which are own? Never UNKNOWN.
  Points ownAbout(const Eigen::Vector3d& p_EP, NarrowPhase& narrow_phase);

  /// True if the point is inside the element, or no further than the padding from it.
  bool isOwn(const Eigen::Vector3d& p_EP, NarrowPhase& narrow_phase) const {
    return distance(p_EP, padding_, narrow_phase) <= padding_;
  }

 private:
  /// Signed distance, or a lower bound of one beyond `max_distance`. Inside a mesh: 0.
  double distance(const Eigen::Vector3d& p_EP, double max_distance,
                  NarrowPhase& narrow_phase) const;
  Points classify(const Eigen::Vector3d& p_ECenter, NarrowPhase& narrow_phase) const;
  std::uint64_t& slotOf(std::uint64_t cell);
  void grow();

  std::shared_ptr<const PreparedShape> shape_;
  double padding_;
  OrientedBox grown_;
  double edge_;  ///< of a cell, metres
  std::size_t nb_known_ = 0;
  std::vector<std::uint64_t> slots_;  ///< an open hash table: four times the cell, and its Points
};

}  // namespace collision_pairs
