#include "mesh_edges.h"

#include <cmath>
#include <numeric>

namespace collision_pairs {
namespace {

std::vector<std::uint32_t> numbers(UnionFind& groups, std::size_t n) {
  std::vector<std::uint32_t> result(n);
  for (std::uint32_t i = 0; i < n; ++i) result[i] = groups.find(i);
  return result;
}

}  // namespace

std::vector<std::uint32_t> weld(const std::vector<Eigen::Vector3d>& vertices) {
  std::vector<std::uint32_t> order(vertices.size()), same(vertices.size());
  std::iota(order.begin(), order.end(), 0);
  const auto less = [&](std::uint32_t i, std::uint32_t j) {
    for (int k = 0; k < 3; ++k) {
      if (vertices[i][k] != vertices[j][k]) return vertices[i][k] < vertices[j][k];
    }
    return i < j;
  };
  std::sort(order.begin(), order.end(), less);
  for (std::size_t k = 0; k < order.size(); ++k) {
    const bool repeats = k > 0 && vertices[order[k]] == vertices[order[k - 1]];
    same[order[k]] = repeats ? same[order[k - 1]] : order[k];
  }
  return same;
}

Facets facetsOf(const TriangleMesh& mesh, const std::vector<std::uint32_t>& same) {
  std::vector<std::pair<Triangle3, int>> facing;
  facing.reserve(mesh.triangles.size());
  for (const Triangle3& t : mesh.triangles) {
    Triangle3 c{same[t[0]], same[t[1]], same[t[2]]};
    if (c[0] == c[1] || c[1] == c[2] || c[2] == c[0]) continue;
    std::rotate(c.begin(), std::min_element(c.begin(), c.end()), c.end());
    const bool swapped = c[1] > c[2];
    if (swapped) std::swap(c[1], c[2]);
    facing.emplace_back(c, swapped ? -1 : 1);
  }
  std::sort(facing.begin(), facing.end());
  Facets facets;
  forEachRun(
      facing.begin(), facing.end(), [](const auto& entry) { return entry.first; },
      [&](auto begin, auto end) {
        Triangle3 t = begin->first;
        int copies = 0;
        for (auto entry = begin; entry != end; ++entry) copies += entry->second;
        if (copies < 0) std::swap(t[1], t[2]);
        facets.triangles.push_back(t);
        facets.copies.push_back(std::abs(copies));
      });
  return facets;
}

Sides sortedSides(const Surface& surface) {
  Sides sides;
  sides.reserve(3 * surface.size());
  for (std::uint32_t t = 0; t < surface.size(); ++t) {
    for (int k = 0; k < 3; ++k) {
      const std::uint32_t i = surface[t][k], j = surface[t][(k + 1) % 3];
      sides.push_back({std::min(i, j), std::max(i, j), t, i < j});
    }
  }
  const auto edge = [](const Side& side) {  // as one number, for a single comparison
    return static_cast<std::uint64_t>(side.low) << 32 | side.high;
  };
  std::sort(sides.begin(), sides.end(), [&](const Side& x, const Side& y) {
    return edge(x) != edge(y) ? edge(x) < edge(y) : x.triangle < y.triangle;
  });
  return sides;
}

int balance(Sides::const_iterator begin, Sides::const_iterator end, const std::vector<int>& copies,
            int most_copies) {
  int sum = 0;
  for (; begin != end; ++begin) {
    const int n = std::min(copies[begin->triangle], most_copies);
    sum += begin->forward ? n : -n;
  }
  return sum;
}

std::vector<std::uint32_t> piecesOf(const Facets& facets, Sides& sides) {
  const std::size_t n = facets.triangles.size();
  UnionFind pieces(n);
  forEachEdge(sides, [&](auto begin, auto end) {
    if (end - begin == 2) pieces.join(begin[0].triangle, begin[1].triangle);
  });
  const std::vector<std::uint32_t> patches = numbers(pieces, n);
  const auto patch = [&](const Side& side) { return patches[side.triangle]; };
  forEachEdge(sides, [&](auto begin, auto end) {
    if (end - begin <= 2) return;
    auto open = end;
    forEachGroup(begin, end, patch, [&](auto first, auto last) {
      const bool even = (last - first) % 2 == 0;
      if (even && balance(first, last, facets.copies, ALL_COPIES) == 0) return;
      if (open != end) pieces.join(open->triangle, first->triangle);
      open = first;
    });
  });
  return numbers(pieces, n);
}

UnionFind::UnionFind(std::size_t n) : parent_(n) { std::iota(parent_.begin(), parent_.end(), 0); }

}  // namespace collision_pairs
