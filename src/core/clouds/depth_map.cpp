#include "depth_map.h"

#include <algorithm>

namespace collision_pairs {
namespace {

using Eigen::Vector3d;

constexpr std::size_t DENSE = 20'000;             // points
constexpr int FINE_BINS = 200, COARSE_BINS = 50;  // along an edge, which spans about 2 rad

}  // namespace

void DepthMap::begin(std::size_t nb_points) {
  nb_along_ = nb_points < DENSE ? COARSE_BINS : FINE_BINS;
  ranges_.assign(6u * static_cast<std::size_t>(nb_along_ * nb_along_), 0.0f);
}

DepthMap::Bin DepthMap::binOf(const Vector3d& p_S) const {
  const Vector3d size = p_S.cwiseAbs();
  const int axis = size[0] > size[1] ? (size[0] > size[2] ? 0 : 2) : (size[1] > size[2] ? 1 : 2);
  const int next = axis == 2 ? 0 : axis + 1, last = axis == 0 ? 2 : axis - 1;
  const double scale = 0.5 * nb_along_ / std::max(size[axis], 1e-9);
  const auto along = [&](double at) {
    return std::min(static_cast<int>(at * scale + 0.5 * nb_along_), nb_along_ - 1);
  };
  return {2 * axis + (p_S[axis] < 0.0 ? 1 : 0), along(p_S[next]), along(p_S[last])};
}

void DepthMap::add(const Vector3d& p_S, double range) {
  float& farthest = ranges_[indexOf(binOf(p_S))];
  farthest = std::max(farthest, static_cast<float>(range));
}

bool DepthMap::hides(const Vector3d& p_S) const {
  const Bin bin = binOf(p_S);
  float farthest = ranges_[indexOf(bin)];
  if (farthest == 0.0f) {
    for (int v = std::max(bin.v - 1, 0); v <= std::min(bin.v + 1, nb_along_ - 1); ++v) {
      for (int u = std::max(bin.u - 1, 0); u <= std::min(bin.u + 1, nb_along_ - 1); ++u) {
        farthest = std::max(farthest, ranges_[indexOf({bin.face, u, v})]);
      }
    }
  }
  return farthest > 0.0f && farthest < p_S.norm();
}

}  // namespace collision_pairs
