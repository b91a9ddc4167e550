#include "packed_brute_force.h"

#include <algorithm>

namespace collision_pairs {

const std::vector<BoxPair>& PackedBruteForce::pairs(const std::vector<Aabb>& boxes,
                                                    std::size_t nb_static) {
  const std::size_t n = boxes.size();
  for (int k = 0; k < 3; ++k) {
    lo_[k].resize(n);
    hi_[k].resize(n);
    for (std::size_t i = 0; i < n; ++i) {
      lo_[k][i] = boxes[i].min[k];
      hi_[k][i] = boxes[i].max[k];
    }
  }
  hit_.resize(n);
  pairs_.clear();
  for (std::size_t i = 0; i < n; ++i) testRow(i, std::max(i + 1, nb_static), n);
  return pairs_;
}

void PackedBruteForce::testRow(std::size_t i, std::size_t begin, std::size_t end) {
  const double *lx = lo_[0].data(), *ly = lo_[1].data(), *lz = lo_[2].data();
  const double *hx = hi_[0].data(), *hy = hi_[1].data(), *hz = hi_[2].data();
  const double l0 = lx[i], l1 = ly[i], l2 = lz[i], h0 = hx[i], h1 = hy[i], h2 = hz[i];
  unsigned char* hit = hit_.data();
  for (std::size_t j = begin; j < end; ++j) {
    hit[j] = (lx[j] <= h0) & (l0 <= hx[j]) & (ly[j] <= h1) & (l1 <= hy[j]) & (lz[j] <= h2) &
             (l2 <= hz[j]);
  }
  for (std::size_t j = begin; j < end; ++j) {
    if (hit[j]) pairs_.push_back({static_cast<std::uint32_t>(i), static_cast<std::uint32_t>(j)});
  }
}

}  // namespace collision_pairs
