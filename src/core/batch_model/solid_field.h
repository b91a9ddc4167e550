// Bounds of the distance of points from a solid, and of their depth in it.
#pragma once

#include <memory>
#include <vector>

#include <Eigen/Geometry>

#include "prepared_shape.h"

namespace collision_pairs {

/// In the frame of the shape. The solid is that of coverBySpheres(). Bounds are read from a grid,
/// between whose nodes they are off by about h^2 / (4 d) metres, with h the width of a cell and d
/// the distance. Immutable.
class SolidField {
 public:
  /// Null unless it is a hull or mesh with volume. Cost: for a mesh 10,000 queries for the nearest
  /// point of its surface. Memory: 40 KB.
  static std::unique_ptr<const SolidField> make(const Prepared& shape);

  /// Points of another shape, in its frame, for loops over all of them.
  struct Points {
    static constexpr std::size_t MOST = 128;
    explicit Points(const std::vector<Eigen::Vector3d>& points = {});
    std::vector<float> at[3];
    double reach = 0.0;  ///< none is further from the origin, metres
  };
  /// By point, moved by X: what the nearest node tells, positive outside of the solid and negative
  /// inside, which is off by at most off(); 0 for one that knows nothing. False: it is too far
  /// away.
  bool nearestNodes(const Points& points, const Eigen::Isometry3d& X, float* nodes) const;
  double off() const { return off_; }

  /// True if the point is certainly further than `reach` (metres, >= 0) from the solid.
  bool isFurther(const Eigen::Vector3d& p, double reach) const;
  /// True if the point is certainly inside. Never for a surface that is not closed.
  bool isInside(const Eigen::Vector3d& p) const;
  std::size_t memory() const { return bounds_.size() * sizeof(float); }

 private:
  explicit SolidField(const Prepared& shape);
  template <bool OUTSIDE>
  double squareAt(const Eigen::Vector3d& p) const;

  double margin_;  ///< m: far above all rounding
  Eigen::Vector3d origin_;
  double width_, cells_a_metre_, off_;
  Eigen::Array3i nb_;  ///< nodes along each axis
  /// By node, x fastest: a lower bound of the distance, or, negative, of the depth.
  std::vector<float> bounds_;
};

}  // namespace collision_pairs
