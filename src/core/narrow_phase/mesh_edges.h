// The edges of triangles that share vertices, and what hangs together by them.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <numeric>
#include <tuple>
#include <vector>

namespace collision_pairs {

using Triangle3 = std::array<std::uint32_t, 3>;  ///< indices into the vertices of a mesh
using Surface = std::vector<Triangle3>;

/// One side of one triangle.
struct Side {
  std::uint32_t low, high, triangle;
  bool forward;  // the triangle runs from low to high
};
using Sides = std::vector<Side>;

/// Of all triangles; those of one edge stand beside each other. Cost: O(n log n).
inline Sides sortedSides(const Surface& surface) {
  Sides sides;
  sides.reserve(3 * surface.size());
  for (std::uint32_t t = 0; t < surface.size(); ++t) {
    for (int k = 0; k < 3; ++k) {
      const std::uint32_t i = surface[t][k], j = surface[t][(k + 1) % 3];
      sides.push_back({std::min(i, j), std::max(i, j), t, i < j});
    }
  }
  std::sort(sides.begin(), sides.end(), [](const Side& x, const Side& y) {
    return std::tie(x.low, x.high, x.triangle) < std::tie(y.low, y.high, y.triangle);
  });
  return sides;
}

/// visit(begin, end) for each run of elements with equal keys.
template <class Iterator, class Key, class Visit>
void forEachRun(Iterator begin, Iterator end, const Key& key, const Visit& visit) {
  while (begin != end) {
    const Iterator first = begin;
    while (begin != end && key(*begin) == key(*first)) ++begin;
    visit(first, begin);
  }
}

/// visit(begin, end) for the sides of each edge.
template <class Visit>
void forEachEdge(Sides& sides, const Visit& visit) {
  const auto edge = [](const Side& side) { return std::tie(side.low, side.high); };
  forEachRun(sides.begin(), sides.end(), edge, visit);
}

class UnionFind {
 public:
  explicit UnionFind(std::size_t n) : parent_(n) { std::iota(parent_.begin(), parent_.end(), 0); }
  std::uint32_t find(std::uint32_t i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  void join(std::uint32_t i, std::uint32_t j) { parent_[find(i)] = find(j); }

 private:
  std::vector<std::uint32_t> parent_;
};

}  // namespace collision_pairs
