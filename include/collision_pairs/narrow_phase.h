// Shapes made ready for queries, and the table of who answers a pair of them.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include <Eigen/Geometry>

#include "collision_pairs/pair_distance.h"
#include "collision_pairs/shape.h"

namespace collision_pairs {

/// A shape with everything that a query needs and that is worth keeping (hull, tree of bounding
/// volumes, …). Immutable, so all threads share it.
class PreparedShape {
 public:
  virtual ~PreparedShape() = default;
  const Shape& shape() const { return shape_; }

 protected:
  explicit PreparedShape(Shape shape) : shape_(std::move(shape)) {}

 private:
  Shape shape_;
};

/// Who answers a pair of shapes.
enum class NarrowPhaseMethod {
  NATIVE,  ///< this package's own: exact to the accuracy that the table of pairs states
  FCL      ///< FCL 0.6 or later, wherever it has an answer and no call of it may end the process
};

/// "native", "fcl".
const char* narrowPhaseName(NarrowPhaseMethod method);
/// Throws InputError that lists the known names.
NarrowPhaseMethod parseNarrowPhase(const std::string& name);

/// With FCL, its object is prepared as well, and pairs of two such shapes are asked of it. Throws
/// std::invalid_argument that names the defect (see validateShape).
/// Cost: O(1), for Convex and Mesh O(n log n).
std::shared_ptr<const PreparedShape> prepareShape(
    const Shape& shape, NarrowPhaseMethod method = NarrowPhaseMethod::NATIVE);

/// Answers pairs of shapes. Holds scratch memory only: one per thread.
///
/// Poses: the rotation in X_AB may be off by rounding or by a quaternion that is not quite
/// normalised; up to 1e-3 (largest entry of R^T R - I) it is made orthonormal, and anything worse,
/// like a number that is not finite, gives a DEGRADED contact whose distance is a true lower bound.
class NarrowPhase {
 public:
  NarrowPhase();
  ~NarrowPhase();
  NarrowPhase(NarrowPhase&&) noexcept;
  NarrowPhase& operator=(NarrowPhase&&) noexcept;

  /// Are the two solids no further than `margin` metres apart (>= 0), by default: have they a point
  /// in common? Never throws.
  bool touches(const PreparedShape& A, const PreparedShape& B, const Eigen::Isometry3d& X_AB,
               double margin = 0.0);

  /// Signed distance, witness points and normal. What is further apart than max_distance (metres,
  /// >= 0, may be infinite) is not computed to the end and comes back as BEYOND. Where `accuracy`
  /// lets the search in triangles end early the answer is TOLERATED: the lower end of the interval,
  /// and two points of the solids that are no further apart than its upper end. Never throws.
  PairDistance distance(const PreparedShape& A, const PreparedShape& B,
                        const Eigen::Isometry3d& X_AB, double max_distance,
                        const Accuracy& accuracy = {});

  /// Calls of touches() and distance() so far that ended DEGRADED.
  std::uint64_t numDegraded() const;
  /// ... that were to be answered by FCL, but all or part of the answer is the native one: FCL has
  /// none for half-spaces, for one body inside a mesh, for most depths, and where it fails.
  std::uint64_t numAnsweredNatively() const;

 private:
  struct Scratch;
  std::unique_ptr<Scratch> scratch_;
};

}  // namespace collision_pairs
