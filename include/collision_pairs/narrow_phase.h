// Prepared shapes, and queries of pairs of them: contact, distance, witness points.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include <Eigen/Geometry>

#include "collision_pairs/pair_distance.h"
#include "collision_pairs/shape.h"

namespace collision_pairs {

/// A shape with the precomputed data of queries (hull, tree of bounding volumes, …). Immutable, so
/// all threads can share it.
class PreparedShape {
 public:
  virtual ~PreparedShape() = default;
  const Shape& shape() const { return shape_; }
  /// Of a mesh with open sheets: about how much of its surface is missing, 0 to 1. Such a sheet
  /// encloses nothing. Otherwise 0.
  double missingShare() const { return missing_share_; }

 protected:
  explicit PreparedShape(Shape shape) : shape_(std::move(shape)) {}
  double missing_share_ = 0.0;

 private:
  Shape shape_;
};

/// The library that answers a pair of shapes.
enum class NarrowPhaseMethod {
  NATIVE,  ///< this package, with the accuracy listed in docs/accuracy.md
  FCL      ///< FCL 0.6 or later, for all pairs that it supports without risk of an abort
};

/// "native", "fcl".
const char* narrowPhaseName(NarrowPhaseMethod method);
/// Throws InputError that lists the known names.
NarrowPhaseMethod parseNarrowPhase(const std::string& name);

/// With FCL, the FCL object is prepared as well, and pairs of two such shapes are answered by FCL.
/// Throws std::invalid_argument that names the defect (see validateShape).
/// Cost: O(1); Convex and Mesh: O(n log n).
std::shared_ptr<const PreparedShape> prepareShape(
    const Shape& shape, NarrowPhaseMethod method = NarrowPhaseMethod::NATIVE);

/// Answers queries of pairs of shapes A and B, with X_AB the pose of B's frame in A's. Holds
/// scratch memory only: use one per thread.
///
/// The rotation in X_AB may be inexact, from rounding or from a quaternion that is not quite
/// normalised. Up to 1e-3 (largest entry of R^T R - I) it is made orthonormal. Anything worse, such
/// as a number that is not finite, gives a DEGRADED contact whose distance is a valid lower bound.
///
/// Two are in contact if they overlap, or the gap between them is no more than rounding of the
/// numbers given: 1e-15 of their sizes, of the distance of their frames, and of `offset`, how far
/// the two are from the origin of the poses that X_AB was computed from (metres).
/// Cost of a query: 0.1 to 14 µs in the median, by the pair of shapes
/// (docs/data/native_and_fcl.csv).
class NarrowPhase {
 public:
  NarrowPhase();
  ~NarrowPhase();
  NarrowPhase(NarrowPhase&&) noexcept;
  NarrowPhase& operator=(NarrowPhase&&) noexcept;

  /// True if the two solids are in contact or no further apart than `margin` metres (>= 0). Never
  /// throws. `apart_along`, if given, is tried first: a unit vector in A's frame along which the
  /// two were apart before, or 0. It changes no answer, and is replaced where they are found apart.
  bool touches(const PreparedShape& A, const PreparedShape& B, const Eigen::Isometry3d& X_AB,
               double margin = 0.0, double offset = 0.0, Eigen::Vector3d* apart_along = nullptr);

  /// Signed distance (<= 0: contact), witness points and normal, in A's frame. If the two are
  /// further apart than max_distance (metres, >= 0, may be infinite), the search ends early and
  /// returns BEYOND. If `accuracy` lets the search in triangles end early, the answer is TOLERATED:
  /// the lower end of the interval, and two points of the solids that are no further apart than its
  /// upper end. Never throws. `between`, if given, is tried first: the vertices of the hulls
  /// between which the closest points were before. It changes no answer, and is replaced by those
  /// of this one.
  PairDistance distance(const PreparedShape& A, const PreparedShape& B,
                        const Eigen::Isometry3d& X_AB, double max_distance,
                        const Accuracy& accuracy = {}, double offset = 0.0,
                        ClosestVertices* between = nullptr);

  /// Number of calls of touches() and distance() that ended DEGRADED.
  std::uint64_t numDegraded() const;
  /// Number of calls meant for FCL that were answered wholly or partly natively: half-spaces, a
  /// body inside a mesh, most depths, and failures of FCL.
  std::uint64_t numAnsweredNatively() const;

 private:
  struct Scratch;
  std::unique_ptr<Scratch> scratch_;
};

}  // namespace collision_pairs
