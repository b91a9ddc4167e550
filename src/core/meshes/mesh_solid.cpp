#include "mesh_solid.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <tuple>

namespace collision_pairs {
namespace {

using Triangle = std::array<std::uint32_t, 3>;

constexpr double CLOSED_IF_HOLES_BELOW = 0.01;  // of the part's area
constexpr double CONVEX_TOLERANCE = 1e-12;      // of the mesh's size

// For each vertex the first one with the same coordinates.
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

// Without triangles that have two corners in one place, and each set of corners only once.
std::vector<Triangle> soundTriangles(const TriangleMesh& mesh,
                                     const std::vector<std::uint32_t>& same) {
  std::vector<std::pair<Triangle, Triangle>> keyed;
  keyed.reserve(mesh.triangles.size());
  for (const Triangle& t : mesh.triangles) {
    const Triangle welded{same[t[0]], same[t[1]], same[t[2]]};
    if (welded[0] == welded[1] || welded[1] == welded[2] || welded[2] == welded[0]) continue;
    Triangle key = welded;
    std::sort(key.begin(), key.end());
    keyed.emplace_back(key, welded);
  }
  const auto less = [](const auto& x, const auto& y) { return x.first < y.first; };
  const auto equal = [](const auto& x, const auto& y) { return x.first == y.first; };
  std::stable_sort(keyed.begin(), keyed.end(), less);
  keyed.erase(std::unique(keyed.begin(), keyed.end(), equal), keyed.end());
  std::vector<Triangle> result;
  for (const auto& entry : keyed) result.push_back(entry.second);
  return result;
}

// One side of one triangle, keyed by its two vertices so that sides of an edge are neighbours.
struct Side {
  std::uint32_t low, high, triangle;
  bool forward;  // the triangle runs from low to high
  bool sameEdge(const Side& other) const { return low == other.low && high == other.high; }
};

std::vector<Side> sortedSides(const std::vector<Triangle>& triangles) {
  std::vector<Side> sides;
  sides.reserve(3 * triangles.size());
  for (std::uint32_t t = 0; t < triangles.size(); ++t) {
    for (int k = 0; k < 3; ++k) {
      const std::uint32_t i = triangles[t][k], j = triangles[t][(k + 1) % 3];
      sides.push_back({std::min(i, j), std::max(i, j), t, i < j});
    }
  }
  std::sort(sides.begin(), sides.end(), [](const Side& x, const Side& y) {
    return std::tie(x.low, x.high, x.triangle) < std::tie(y.low, y.high, y.triangle);
  });
  return sides;
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

// Turns triangles so that neighbours run along their common edge in opposite directions; by edges
// of two triangles first, by edges of more where there is no other way.
void orientAlike(const std::vector<Side>& sides, std::vector<Triangle>& triangles) {
  std::vector<std::vector<std::pair<std::uint32_t, bool>>> clean(triangles.size());
  std::vector<std::vector<std::pair<std::uint32_t, bool>>> crowded(triangles.size());
  for (std::size_t i = 0; i < sides.size();) {
    std::size_t end = i + 1;
    while (end < sides.size() && sides[end].sameEdge(sides[i])) ++end;
    for (std::size_t k = i + 1; k < end; ++k) {
      auto& links = end - i == 2 ? clean : crowded;
      const bool flip = sides[k].forward == sides[i].forward;
      links[sides[i].triangle].emplace_back(sides[k].triangle, flip);
      links[sides[k].triangle].emplace_back(sides[i].triangle, flip);
    }
    i = end;
  }
  std::vector<char> state(triangles.size(), -1);  // -1 unknown, 0 as it is, 1 turned
  std::vector<std::uint32_t> first, later;
  for (std::uint32_t seed = 0; seed < triangles.size(); ++seed) {
    if (state[seed] >= 0) continue;
    state[seed] = 0;
    first.push_back(seed);
    while (!first.empty() || !later.empty()) {
      auto& queue = first.empty() ? later : first;
      const bool by_crowded = first.empty();
      const std::uint32_t t = queue.back();
      queue.pop_back();
      if (!by_crowded) later.push_back(t);
      for (const auto& [next, flip] : by_crowded ? crowded[t] : clean[t]) {
        if (state[next] >= 0) continue;
        state[next] = static_cast<char>(state[t] ^ static_cast<char>(flip));
        first.push_back(next);
      }
    }
  }
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    if (state[t] == 1) std::swap(triangles[t][1], triangles[t][2]);
  }
}

double area(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c) {
  return 0.5 * (b - a).cross(c - a).norm();
}

// Area of the fans that would close the holes of a part.
std::map<std::uint32_t, double> holeAreas(const TriangleMesh& mesh, const std::vector<Side>& sides,
                                          UnionFind& parts) {
  UnionFind loops(mesh.vertices.size());
  std::vector<Side> open;
  for (std::size_t i = 0; i < sides.size(); ++i) {
    const bool shared = (i > 0 && sides[i].sameEdge(sides[i - 1])) ||
                        (i + 1 < sides.size() && sides[i].sameEdge(sides[i + 1]));
    if (shared) continue;
    open.push_back(sides[i]);
    loops.join(sides[i].low, sides[i].high);
  }
  std::map<std::uint32_t, std::pair<Eigen::Vector3d, double>> centroids;
  for (const Side& side : open) {
    auto& [sum, count] =
        centroids.try_emplace(loops.find(side.low), Eigen::Vector3d::Zero(), 0.0).first->second;
    sum += mesh.vertices[side.low] + mesh.vertices[side.high];
    count += 2.0;
  }
  std::map<std::uint32_t, double> result;
  for (const Side& side : open) {
    const auto& [sum, count] = centroids.at(loops.find(side.low));
    const Eigen::Vector3d center = sum / count;
    result[parts.find(side.low)] += area(center, mesh.vertices[side.low], mesh.vertices[side.high]);
  }
  return result;
}

bool isLocallyConvex(const TriangleMesh& mesh, const std::vector<Triangle>& triangles,
                     const std::vector<Side>& sides) {
  Eigen::Vector3d low = mesh.vertices[triangles[0][0]], high = low;
  for (const Triangle& t : triangles) {
    for (const std::uint32_t i : t) {
      low = low.cwiseMin(mesh.vertices[i]);
      high = high.cwiseMax(mesh.vertices[i]);
    }
  }
  const double tolerance = CONVEX_TOLERANCE * (high - low).norm();
  for (std::size_t i = 0; i < sides.size(); i += 2) {
    if (i + 1 >= sides.size() || !sides[i].sameEdge(sides[i + 1])) return false;
    if (i + 2 < sides.size() && sides[i].sameEdge(sides[i + 2])) return false;
    const Triangle& t = triangles[sides[i].triangle];
    const Eigen::Vector3d& corner = mesh.vertices[t[0]];
    const Eigen::Vector3d normal =
        (mesh.vertices[t[1]] - corner).cross(mesh.vertices[t[2]] - corner).normalized();
    for (const std::uint32_t other : triangles[sides[i + 1].triangle]) {
      if (normal.dot(mesh.vertices[other] - corner) > tolerance) return false;
    }
  }
  return true;
}

struct Part {
  double area = 0.0;
  double volume = 0.0;
};

}  // namespace

MeshSolid findSolid(const TriangleMesh& mesh) {
  MeshSolid solid;
  const std::vector<std::uint32_t> same = weld(mesh.vertices);
  UnionFind parts(mesh.vertices.size());
  for (const Triangle& t : mesh.triangles) {
    parts.join(same[t[0]], same[t[1]]);
    parts.join(same[t[0]], same[t[2]]);
  }
  std::map<std::uint32_t, Part> part;
  for (const Triangle& t : mesh.triangles) {
    if (part.try_emplace(parts.find(same[t[0]])).second) {
      solid.part_points.push_back(mesh.vertices[t[0]]);
    }
  }
  std::vector<Triangle> triangles = soundTriangles(mesh, same);
  const std::vector<Side> sides = sortedSides(triangles);
  orientAlike(sides, triangles);
  const Eigen::Vector3d origin = mesh.vertices.front();
  for (const Triangle& t : triangles) {
    const Eigen::Vector3d a = mesh.vertices[t[0]] - origin, b = mesh.vertices[t[1]] - origin,
                          c = mesh.vertices[t[2]] - origin;
    Part& whole = part[parts.find(t[0])];
    whole.area += area(a, b, c);
    whole.volume += a.dot(b.cross(c)) / 6.0;
  }
  const std::map<std::uint32_t, double> holes = holeAreas(mesh, sides, parts);
  for (Triangle t : triangles) {
    const std::uint32_t id = parts.find(t[0]);
    const auto hole = holes.find(id);
    if (hole != holes.end() && hole->second > CLOSED_IF_HOLES_BELOW * part[id].area) continue;
    if (part[id].volume < 0.0) std::swap(t[1], t[2]);
    solid.outward.push_back(t);
  }
  for (const auto& entry : part) {
    const auto hole = holes.find(entry.first);
    const bool open =
        hole != holes.end() && hole->second > CLOSED_IF_HOLES_BELOW * entry.second.area;
    if (!open) solid.volume += std::abs(entry.second.volume);
  }
  solid.locally_convex = part.size() == 1 && holes.empty() && !solid.outward.empty() &&
                         isLocallyConvex(mesh, solid.outward, sortedSides(solid.outward));
  return solid;
}

}  // namespace collision_pairs
