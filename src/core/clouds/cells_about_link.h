// Tests whether points lie on the robot or near it: exact, with cached results.
#pragma once

#include <cstdint>
#include <vector>

#include "box_gap.h"
#include "collision_pairs/collision_scene.h"

namespace collision_pairs {

/// One element, and the space around it divided into cells in its own frame E. For each visited
/// cell it is stored whether all, none or some of its points are within the padding.
class CellsAboutLink {
 public:
  CellsAboutLink(SceneElement element, double padding);

  /// In E; contains all own points. Infinite for a half-space.
  const OrientedBox& grownBox() const { return grown_; }

  enum class Points : std::uint64_t { UNKNOWN = 0, NONE, ALL, SOME };
  /// Which points in this point's cell are own; never UNKNOWN.
  Points ownAbout(const Eigen::Vector3d& p_EP, NarrowPhase& narrow_phase);

  /// True if the point is inside the element, or within the padding of it.
  bool isOwn(const Eigen::Vector3d& p_EP, NarrowPhase& narrow_phase) const {
    return distance(p_EP, padding_, narrow_phase) <= padding_;
  }

  /// Signed distance, or a lower bound if beyond `max_distance`. Inside a mesh: 0.
  double distance(const Eigen::Vector3d& p_EP, double max_distance,
                  NarrowPhase& narrow_phase) const;

 private:
  Points classify(const Eigen::Vector3d& p_ECenter, NarrowPhase& narrow_phase) const;
  std::uint64_t& slotOf(std::uint64_t cell);
  void grow();

  std::shared_ptr<const PreparedShape> shape_;
  double padding_;
  OrientedBox grown_;
  double edge_;  ///< of cells, metres
  std::size_t nb_known_ = 0;
  std::vector<std::uint64_t> slots_;  ///< an open-addressing hash table of 4 * cell + Points
};

}  // namespace collision_pairs
