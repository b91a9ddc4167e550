// What a sensor's rays hide, from one cloud of its points.
#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/Core>

namespace collision_pairs {

/// The directions about a sensor in bins, on the faces of a cube: how far the farthest ray of each
/// bin saw. For organised clouds and others alike. Cost: about 5 ns per point.
class DepthMap {
 public:
  /// Bins of 0.01 rad, or of 0.04 rad if there are too few points to fill them.
  void begin(std::size_t nb_points);
  /// A ray to the point p_S (metres, in the sensor's frame) that sees nothing beyond `range`
  /// metres.
  void add(const Eigen::Vector3d& p_S, double range);
  /// True if every ray in the bin of the point, or in those around it if it is empty, ended before.
  /// False if there is none.
  bool hides(const Eigen::Vector3d& p_S) const;

 private:
  struct Bin {
    int face, u, v;
  };
  Bin binOf(const Eigen::Vector3d& p_S) const;
  std::size_t indexOf(const Bin& bin) const {
    return (static_cast<std::size_t>(bin.face) * nb_along_ + bin.v) * nb_along_ + bin.u;
  }

  int nb_along_ = 0;           ///< bins along an edge of the cube
  std::vector<float> ranges_;  ///< by bin; 0: no ray
};

}  // namespace collision_pairs
