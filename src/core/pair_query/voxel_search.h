// Finds the voxel of a cloud that is nearest to an element, or one that it touches.
#pragma once

#include <algorithm>
#include <limits>
#include <utility>
#include <vector>

#include "anytime_query.h"
#include "box_gap.h"
#include "collision_pairs/occupied_voxels.h"
#include "pair_ladder.h"
#include "surface_query.h"

namespace collision_pairs {

/// Best-first branch and bound (R. Hjaltason, H. Samet, "Distance browsing in spatial databases",
/// 1999): a heap of cubes and voxels by a lower bound of their signed distance, which is refined
/// when one reaches the top: axis-aligned boxes, oriented ones, then the element's hull or its
/// triangles against the box around the occupied part of a cube, and at all times the planes that
/// kept other boxes apart, which keep all of a floor away. Below a cube, only the triangles near it
/// are searched. Voxels are passed to the ladder like static boxes of a world, so that all rungs
/// and methods give the same results. Beside triangles only the nearest is, and all that may be in
/// contact: how far any other is apart is known to 1e-10 m without. Voxels that are not nearer than
/// the best so far by more than that are skipped: of the equally near voxels of a floor, only one
/// is queried.
class VoxelSearch {
 public:
  struct Found {
    PairLadder::Answer answer;  ///< as from PairLadder
    VoxelCell voxel = VoxelCell::Zero();
  };

  /// All must live until the last query of the cycle; poses and boxes of the elements of clouds are
  /// overwritten.
  void begin(const CollisionScene& scene, std::vector<Eigen::Isometry3d>& X_WE,
             std::vector<Aabb>& boxes, PairLadder& ladder);

  /// True if the box of some voxel is within `reach` of the element's, padding included.
  // Below, one of the two elements of a pair belongs to a cloud that is not empty.

  bool isWithin(const BoxPair& pair, const OccupiedVoxels& voxels, double reach);

  // Pairs are by model.

  /// The lower bound by the nearest of their axis-aligned boxes, marked UNFINISHED; BEYOND if
  /// further apart than max_distance.
  Found boundOfBoxes(const BoxPair& pair, const OccupiedVoxels& voxels, double max_distance);
  /// As PairLadder::touches().
  Found touches(const BoxPair& pair, const OccupiedVoxels& voxels, Fidelity top,
                const Deadline& deadline);
  /// As PairLadder::refine(), for the nearest voxel, or for one that is certainly in contact if the
  /// nearest is not certain. If the time runs out: the deepest contact so far, else a lower bound,
  /// UNFINISHED. The depth of a contact is a BOUND where another voxel may be deeper.
  Found nearest(const BoxPair& pair, const OccupiedVoxels& voxels, Fidelity top,
                double max_distance, const Deadline& deadline);

 private:
  /// Metres: smaller differences of voxels' distances are ignored.
  static constexpr double SAME = 1e-10;
  static constexpr double ROUNDING = 64.0 * std::numeric_limits<double>::epsilon();
  struct Entry {
    double bound;  ///< metres
    VoxelCell corner;
    std::uint32_t index;                        ///< of the cube
    SurfaceQuery::Nodes nodes;                  ///< of the surface, near the cube
    std::int8_t level;                          ///< of the cube; -1: a voxel
    bool is_fine = false;                       ///< bounded by the element's hull or triangles
    bool operator<(const Entry& other) const {  // for a heap whose top is the last in this order
      return bound != other.bound ? bound > other.bound : level > other.level;
    }
  };

  void setBox(const BoxPair& pair, const OccupiedVoxels& voxels);
  void start(const BoxPair& pair, const OccupiedVoxels& voxels, Fidelity rung, double max_distance);
  void push(Entry entry);
  Entry pop();
  /// Pushes it again with a finer bound; false if there is none.
  bool refine(Entry& entry);
  /// A cube larger than the element mostly contains it. The planes that keep one box away from a
  /// hull do for others, and the first voxel is measured at the cost of its bound.
  bool isWorthMore(const Entry& entry, const Aabb& box) const {
    const bool is_next = entry.level < 0 && best_ < std::numeric_limits<double>::infinity();
    if (!has_triangles_ && !planes_.empty() && !is_next) return false;
    if (entry.level < 0) return limit_ > 0.0;
    return entry.level == 0 || (box.max - box.min).norm() <= 2.0 * size_;
  }
  void expand(const Entry& cube);
  // Those within cells_ that its boxes and the planes leave.
  void pushChildren(const Entry& cube);
  void findVoxels(const Entry& cube);  ///< in near_; not the candidate
  /// The box around the occupied part of a cube, or of a voxel.
  Aabb boxOf(const Entry& entry) const;

  // Lower bounds of the signed distance of the element and a box: by the boxes around the element,
  // and by the planes that have kept other boxes apart from it.
  double boundOfBoxes(const Aabb& box) const;
  double boundOfPlanes(const Aabb& box) const;
  void addPlane(const Eigen::Vector3d& nhat_W, const Aabb& box);
  // Lower bounds of the distance, padding left aside, by its hull or its triangles; negative if
  // they may be in contact.
  double gapOfHulls(const Aabb& box);
  double gapOfTriangles(Entry& entry, const Aabb& box);

  double errorOfSurface() const;

  // Of an element with triangles.

  /// Makes it the candidate, pushes it if only the ladder can tell, or skips it. `known`: a lower
  /// bound of the surface's distance.
  void takeVoxel(Entry voxel, double known);
  void takeNearestOf(const Entry& cube);
  /// Those in near_. `nodes`: of the surface near all of them.
  void takeVoxels(const SurfaceQuery::Nodes& nodes);
  bool isOutside(const Entry& entry, const Aabb& box) const;
  void measureVoxel(const VoxelCell& cell, Fidelity top, double max_distance);
  void placeVoxel(const VoxelCell& cell);
  bool isPruned(double bound) const { return bound > limit_ || bound >= best_ - slackOf(bound); }
  /// A voxel that is apart must not hide a contact.
  double slackOf(double bound) const { return bound > 0.0 || best_ <= 0.0 ? SAME : 0.0; }
  /// Search distance from the shapes, metres: what lies beyond is hopeless.
  double reach() const { return std::max(std::min(limit_, best_ - 0.5 * SAME), 0.0) + padding_; }
  double searched() const { return reach() + 2.0 * surface_error_; }  ///< from the triangles
  void keepBest(const PairLadder::Answer& answer, const VoxelCell& cell);
  Found unfinished(const Entry& entry);
  Found result() const;
  /// The deepest certain contact, where others may have a signed distance as low as `lower`.
  Found contactWithin(double lower) const;

  const CollisionScene* scene_ = nullptr;
  std::vector<Eigen::Isometry3d>* X_WE_ = nullptr;
  std::vector<Aabb>* boxes_ = nullptr;
  PairLadder* ladder_ = nullptr;

  // State of one query.
  BoxPair pair_{0, 0};
  std::uint32_t of_cloud_ = 0, of_link_ = 0;
  const OccupiedVoxels* voxels_ = nullptr;
  double rounding_ = 0.0;  ///< metres, of boxes of voxels
  Aabb box_;               ///< of the element, in W; enlarged by all paddings
  Fidelity rung_ = Fidelity::AABB;
  bool has_oriented_ = false;
  OrientedBox oriented_;  ///< around the element at its rung, in W
  double padding_ = 0.0;
  double size_ = 0.0;  ///< metres, of the element: half its diagonal
  bool has_triangles_ = false;
  double limit_ = 0.0;  ///< nothing further is searched
  double best_ = 0.0;   ///< nothing that is not nearer is searched
  OccupiedVoxels::CellRange cells_;
  Found nearest_, contact_;  ///< so far: the nearest, and the deepest certain contact
  Eigen::Vector3d nhat_E_;   ///< of the hull's last bound: where the next begins
  struct Plane {
    Eigen::Vector3d nhat;  ///< unit, away from the element
    double reach;          ///< of the element along it
  };
  std::vector<Plane> planes_;  ///< in W; the newest last
  SurfaceQuery surface_;
  double surface_error_ = 0.0;  ///< metres, of bounds by triangles
  bool has_candidates_ = false;
  Entry candidate_;  ///< the nearest voxel so far, which is apart and not yet passed to the ladder
  std::vector<Entry> heap_;
  std::vector<Entry> near_;  ///< the voxels of a cube that may be nearer than the best
  std::vector<std::pair<double, std::size_t>> by_gap_;  ///< of the surface; indices into near_
  std::vector<Aabb> outside_;  ///< boxes that neither intersect the element nor lie inside it
};

}  // namespace collision_pairs
