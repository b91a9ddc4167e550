// Queries one pair of elements at one rung of the fidelity ladder, or at finer and finer rungs
// until it is settled.
//
// This folder measures one pair:
// - pair_ladder: how far apart are two elements, at one fidelity or by finer and finer ones?
// - anytime_query: which pairs are settled first if there is a deadline?
// - voxel_search: which voxel of a cloud is nearest to an element?
// - voxel_bounds.cpp: how near to the element may the voxels in a box be?
#pragma once

#include <vector>

#include <Eigen/Geometry>

#include "collision_pairs/aabb.h"
#include "collision_pairs/collision_scene.h"
#include "collision_pairs/narrow_phase.h"
#include "convex_core.h"

namespace collision_pairs {

/// Refers to the poses of the elements in this cycle; all results are in the world frame W.
/// A pair is given as (element of the first model, element of the second).
class PairLadder {
 public:
  struct Answer {
    PairDistance found;  ///< p_ACa, p_ACb and nhat_AB_A measured and expressed in W
    Fidelity rung;       ///< the geometry that gave the result
  };

  /// All must live until the last query of the cycle. X_WE: one pose per element.
  void begin(const CollisionScene& scene, const std::vector<Eigen::Isometry3d>& X_WE,
             const std::vector<Aabb>& boxes);

  /// At exactly this rung, which the scene must have for the two. BEYOND if further apart than
  /// max_distance.
  Answer measure(const BoxPair& pair, Fidelity rung, double max_distance);

  /// As measure() at rungOf(pair, top), but stops at the first rung that proves the pair further
  /// apart than max_distance: that rung encloses `top`, so the result is the same. A pair of boxes
  /// costs tens of nanoseconds, one of hulls about a microsecond, one of meshes up to a hundred.
  /// With a tolerance (metres) a search in triangles stops when the certified interval of the
  /// distance is no wider; its lower end is returned as TOLERATED. Contact or not, padding
  /// included, is not affected.
  Answer refine(const BoxPair& pair, Fidelity top, double max_distance, double tolerance = 0.0);

  /// Only whether the two are in contact at rung `top`, which costs less than refine(): BOUND at
  /// distance 0 if they are, BEYOND if not, DEGRADED if neither could be proved. At a rung larger
  /// than the elements, pairs may be in contact whose tight boxes are not: the caller has to test
  /// these.
  Answer touches(const BoxPair& pair, Fidelity top);

  /// Lower bounds of the signed distance, marked UNFINISHED, or BEYOND if further apart than
  /// max_distance: of the axis-aligned boxes, about 10 ns; of them and the boxes along each
  /// element's axes, 40 ns; of the hulls, never less than `known`, a microsecond.
  Answer boundOfAlignedBoxes(const BoxPair& pair, double max_distance) const;
  Answer boundOfBoxes(const BoxPair& pair, double max_distance) const;
  Answer boundOfHulls(const BoxPair& pair, const Answer& known, double max_distance) const;

  /// A lower bound of the distance of an element from a convex shape at X_WS, by their hulls, at
  /// rung CONVEX or MESH; <= 0 if these may be in contact. Padding is not subtracted. More than
  /// max_distance if such a bound can be. `nhat_E` is where to begin: see roughGap(). Costs a tenth
  /// of a microsecond to one.
  double hullsApart(std::uint32_t element, Fidelity rung, const ConvexCore& shape,
                    const Eigen::Isometry3d& X_WS, double max_distance,
                    Eigen::Vector3d& nhat_E) const;
  /// What a bound by its triangles may be off by.
  double errorOfSurface(std::uint32_t element, const ConvexCore& shape,
                        const Eigen::Isometry3d& X_WS) const;
  /// How far its hull reaches along a unit vector in W, measured from W; metres, rounded up.
  double reachAlong(const Eigen::Vector3d& nhat_W, std::uint32_t element, Fidelity rung,
                    const ConvexCore& shape) const;

  /// The coarsest of `top` and the finest rungs of the two elements in the scene.
  Fidelity rungOf(const BoxPair& pair, Fidelity top) const;
  /// True if refine() to `top` would use triangles, which boundOfHulls() may avoid.
  bool needsTriangles(const BoxPair& pair, Fidelity top) const;
  /// As NarrowPhase::numAnsweredNatively(), since begin().
  std::uint32_t numAnsweredNatively() const;
  /// The elements of `pair`, the one of the model with the smaller id first.
  BoxPair byModel(const BoxPair& pair) const;

 private:
  Eigen::Isometry3d relativePose(const BoxPair& pair) const {
    return relativePose((*X_WE_)[pair.first], (*X_WE_)[pair.second]);
  }
  // Of the two from the origin of W, metres: rounding of their poses scales with it.
  static double offset(const Eigen::Isometry3d& X_WA, const Eigen::Isometry3d& X_WB) {
    return X_WA.translation().norm() + X_WB.translation().norm();
  }
  double offset(const BoxPair& pair) const {
    return offset((*X_WE_)[pair.first], (*X_WE_)[pair.second]);
  }
  static Eigen::Isometry3d relativePose(const Eigen::Isometry3d& X_WA,
                                        const Eigen::Isometry3d& X_WB);
  Answer measureAt(const BoxPair& pair, const Eigen::Isometry3d& X_AB, Fidelity rung,
                   double max_distance, double tolerance);
  Answer measureBoxes(const BoxPair& pair) const;
  Answer notBelowBoxes(const BoxPair& pair, const Eigen::Isometry3d& X_AB, Answer answer) const;
  /// Of the boxes along the elements' axes minus the padding, from the centre of the first; minus
  /// infinity if they overlap.
  PairDistance boxGap(const BoxPair& pair, const Eigen::Isometry3d& X_AB) const;
  Answer measureSpheres(const BoxPair& pair, const Eigen::Isometry3d& X_AB, double max_distance);
  /// In the frame of the first; the padding is not subtracted. BEYOND: by more than max_distance.
  PairDistance spheresApart(const BoxPair& pair, const Eigen::Isometry3d& X_AB,
                            double max_distance);
  struct Last;
  /// True unless they are proved to be apart.
  bool meets(const BoxPair& pair, Fidelity rung);
  Last& lastOf(const BoxPair& pair, const Eigen::Isometry3d& X_AB);
  /// A lower bound of the distance of the two OBBs minus the padding; <= 0 does not imply overlap.
  double obbGap(const BoxPair& pair, const Eigen::Isometry3d& X_AB) const;

  const CollisionScene* scene_ = nullptr;
  const std::vector<Eigen::Isometry3d>* X_WE_ = nullptr;
  const std::vector<Aabb>* boxes_ = nullptr;
  // Of as many pairs, along what they were apart and where they were closest when they were last
  // asked about. It is tried first where they have moved little since: that saves half the time of
  // verdicts and distances of hulls along motions, and changes no answer.
  static constexpr std::size_t MOST_LAST = 1024;
  struct Last {
    BoxPair pair{};
    Eigen::Isometry3d X_AB = Eigen::Isometry3d::Identity();
    Eigen::Vector3d apart_along = Eigen::Vector3d::Zero();
    ClosestVertices between;
  };
  std::vector<Last> last_;  // empty until a pair is asked about: it takes longer than many a check
  NarrowPhase narrow_phase_;
  std::uint64_t natively_before_ = 0;
};

}  // namespace collision_pairs
