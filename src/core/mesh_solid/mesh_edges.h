// The triangles of a mesh over shared vertices, their edges, and the parts that these connect.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <tuple>
#include <vector>

#include "collision_pairs/shape.h"

namespace collision_pairs {

using Triangle3 = std::array<std::uint32_t, 3>;  ///< indices into the vertices of a mesh
using Surface = std::vector<Triangle3>;

/// For each vertex the first one with the same coordinates; -0 is 0.
std::vector<std::uint32_t> weld(const std::vector<Eigen::Vector3d>& vertices);

/// The triangles of a mesh, one facet per set of corners, however many triangles share it.
/// Triangles with two coincident corners are left out.
struct Facets {
  Surface triangles;
  std::vector<int> copies;  ///< those that face this way minus those that face the other; >= 0
};

/// `same`: result of weld() for the mesh's vertices.
Facets facetsOf(const TriangleMesh& mesh, const std::vector<std::uint32_t>& same);

/// One side of one triangle.
struct Side {
  std::uint32_t low, high, triangle;
  bool forward;  ///< the triangle traverses the edge from low to high
};
using Sides = std::vector<Side>;

/// The sides of all triangles, grouped by edge. Cost: O(n log n).
Sides sortedSides(const Surface& surface);

constexpr int ALL_COPIES = std::numeric_limits<int>::max();

/// Number of forward sides minus backward sides; each facet counts at most `most_copies` times.
int balance(Sides::const_iterator begin, Sides::const_iterator end, const std::vector<int>& copies,
            int most_copies);

/// Numbers the facets; facets with equal numbers have to be classified together. An edge of two
/// facets joins them, an edge of more facets joins those that would be open there on their own.
/// Reorders the sides within each edge.
std::vector<std::uint32_t> piecesOf(const Facets& facets, Sides& sides);

/// visit(begin, end) for each run of elements with equal keys.
template <class Iterator, class Key, class Visit>
void forEachRun(Iterator begin, Iterator end, const Key& key, const Visit& visit) {
  while (begin != end) {
    const Iterator first = begin;
    while (begin != end && key(*begin) == key(*first)) ++begin;
    visit(first, begin);
  }
}

/// The same for all elements with equal keys, after sorting by key.
template <class Iterator, class Key, class Visit>
void forEachGroup(Iterator begin, Iterator end, const Key& key, const Visit& visit) {
  const auto less = [&](const auto& x, const auto& y) { return key(x) < key(y); };
  if (!std::is_sorted(begin, end, less)) std::stable_sort(begin, end, less);
  forEachRun(begin, end, key, visit);
}

/// visit(begin, end) for the sides of each edge.
template <class Visit>
void forEachEdge(Sides& sides, const Visit& visit) {
  const auto edge = [](const Side& side) { return std::tie(side.low, side.high); };
  forEachRun(sides.begin(), sides.end(), edge, visit);
}

class UnionFind {
 public:
  explicit UnionFind(std::size_t n);
  std::uint32_t find(std::uint32_t i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  void join(std::uint32_t i, std::uint32_t j) { parent_[find(i)] = find(j); }

 private:
  std::vector<std::uint32_t> parent_;
};

}  // namespace collision_pairs
