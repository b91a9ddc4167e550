#include "mesh_solid.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "outer_faces.h"
#include "solid_angle.h"
#include "winding_number.h"

namespace collision_pairs {
namespace {

using Eigen::Vector3d;
using Numbering = std::vector<std::uint32_t>;  // of what belongs together: one number a facet

constexpr double CLOSED_BELOW = 0.02;       // turns, in the mean: half the share of missing area
constexpr int NUM_SAMPLES = 32;             // of a surface that may be closed
constexpr double SAMPLE_HEIGHT = 1e-3;      // above a triangle, of its area over its circumference
constexpr double CONVEX_TOLERANCE = 1e-12;  // of the mesh's size
constexpr int ALL_COPIES = std::numeric_limits<int>::max();

// For each vertex the first one with the same coordinates.
std::vector<std::uint32_t> weld(const std::vector<Vector3d>& vertices) {
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

// Each set of three corners once, however many triangles have it.
struct Facets {
  Surface triangles;
  std::vector<int> copies;  // that face this way, less those that face the other one; >= 0
};

// Without triangles that have two corners in one place.
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

// As forEachRun(), for a range that is not sorted by its keys yet.
template <class Iterator, class Key, class Visit>
void forEachGroup(Iterator begin, Iterator end, const Key& key, const Visit& visit) {
  const auto less = [&](const auto& x, const auto& y) { return key(x) < key(y); };
  if (!std::is_sorted(begin, end, less)) std::stable_sort(begin, end, less);
  forEachRun(begin, end, key, visit);
}

// How many of the sides run forward, less those that run backward.
int balance(Sides::iterator begin, Sides::iterator end, const std::vector<int>& copies, int most) {
  int sum = 0;
  for (; begin != end; ++begin) {
    const int n = std::min(copies[begin->triangle], most);
    sum += begin->forward ? n : -n;
  }
  return sum;
}

Numbering numbers(UnionFind& groups, std::size_t n) {
  Numbering result(n);
  for (std::uint32_t i = 0; i < n; ++i) result[i] = groups.find(i);
  return result;
}

// What has to be judged together: an edge of two facets joins them, and one of more facets those
// that it would leave open if they were alone.
Numbering piecesOf(const Facets& facets, Sides& sides) {
  const std::size_t n = facets.triangles.size();
  UnionFind pieces(n);
  forEachEdge(sides, [&](auto begin, auto end) {
    if (end - begin == 2) pieces.join(begin[0].triangle, begin[1].triangle);
  });
  const Numbering patches = numbers(pieces, n);
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

Vector3d centroid(const TriangleMesh& mesh, const Triangle3& t) {
  return (mesh.vertices[t[0]] + mesh.vertices[t[1]] + mesh.vertices[t[2]]) / 3.0;
}

Vector3d areaVector(const TriangleMesh& mesh, const Triangle3& t) {
  const Vector3d& a = mesh.vertices[t[0]];
  return 0.5 * (mesh.vertices[t[1]] - a).cross(mesh.vertices[t[2]] - a);
}

// How far the surface is from winding a whole number of times around a point above one of its
// triangles, in turns.
double windingError(const TriangleMesh& mesh, const Surface& surface, const Triangle3& t) {
  const Vector3d &a = mesh.vertices[t[0]], &b = mesh.vertices[t[1]], &c = mesh.vertices[t[2]];
  const double circumference = (b - a).norm() + (c - b).norm() + (a - c).norm();
  SolidAngleSum sum(centroid(mesh, t) + SAMPLE_HEIGHT / circumference * areaVector(mesh, t));
  for (const Triangle3& s : surface) {
    sum.add(mesh.vertices[s[0]], mesh.vertices[s[1]], mesh.vertices[s[2]]);
  }
  return std::abs(sum.total() - std::round(sum.total()));
}

// A closed surface winds a whole number of times around every point. Is that so next to this one,
// at samples that are spread evenly over its area? Then what its edges leave open does not count:
// they match in parts only, or vertices nearly meet, or a triangle is missing.
bool isClosed(const TriangleMesh& mesh, const Surface& surface) {
  double area = 0.0, passed = 0.0, error = 0.0;
  for (const Triangle3& t : surface) area += areaVector(mesh, t).norm();
  int sample = 0;
  for (const Triangle3& t : surface) {
    const int before = sample;
    passed += areaVector(mesh, t).norm();
    while (sample < NUM_SAMPLES && (sample + 0.5) * area < passed * NUM_SAMPLES) ++sample;
    if (sample == before) continue;
    error += (sample - before) * windingError(mesh, surface, t);
    if (!(error < CLOSED_BELOW * NUM_SAMPLES)) return false;
  }
  return sample > 0;
}

void turn(Surface& surface) {
  for (Triangle3& t : surface) std::swap(t[1], t[2]);
}

double volumeOf(const TriangleMesh& mesh, const Surface& surface) {
  double sum = 0.0;
  for (const Triangle3& t : surface) sum += signedVolume(mesh, t, mesh.vertices[surface[0][0]]);
  return sum;
}

bool isLocallyConvex(const TriangleMesh& mesh, const Surface& surface) {
  const Sides sides = sortedSides(surface);
  Vector3d low = mesh.vertices[surface[0][0]], high = low;
  for (const Triangle3& t : surface) {
    for (const std::uint32_t i : t) {
      low = low.cwiseMin(mesh.vertices[i]);
      high = high.cwiseMax(mesh.vertices[i]);
    }
  }
  const double tolerance = CONVEX_TOLERANCE * (high - low).norm();
  const auto sameEdge = [](const Side& x, const Side& y) {
    return x.low == y.low && x.high == y.high;
  };
  for (std::size_t i = 0; i < sides.size(); i += 2) {
    if (i + 1 >= sides.size() || !sameEdge(sides[i], sides[i + 1])) return false;
    if (i + 2 < sides.size() && sameEdge(sides[i], sides[i + 2])) return false;
    const Triangle3& t = surface[sides[i].triangle];
    const Vector3d& corner = mesh.vertices[t[0]];
    const Vector3d normal = areaVector(mesh, t).normalized();
    for (const std::uint32_t other : surface[sides[i + 1].triangle]) {
      if (normal.dot(mesh.vertices[other] - corner) > tolerance) return false;
    }
  }
  return true;
}

class SolidFinder {
 public:
  explicit SolidFinder(const TriangleMesh& mesh)
      : mesh_(mesh),
        same_(weld(mesh.vertices)),
        facets_(facetsOf(mesh, same_)),
        settled_(facets_.triangles.size(), 0) {}

  MeshSolid find() {
    const Numbering part = findParts();
    Sides sides = sortedSides(facets_.triangles);
    const Numbering piece = piecesOf(facets_, sides);
    takeBalanced(piece, sides);
    settle(piece, [&](const Numbering& ids) { return takeAsItIs(ids) || takeOuterFaces(ids); });
    settle(part, [&](const Numbering& ids) { return takeAsItIs(ids); });
    settle(Numbering(part.size(), 0), [&](const Numbering& ids) { return takeAsItIs(ids); });
    orient();
    solid_.locally_convex = solid_.part_points.size() == 1 && !solid_.outward.empty() &&
                            isLocallyConvex(mesh_, solid_.outward);
    return std::move(solid_);
  }

 private:
  // Numbers the facets by the parts of the mesh, and takes a point of each.
  Numbering findParts() {
    UnionFind parts(mesh_.vertices.size());
    for (const Triangle3& t : mesh_.triangles) {
      parts.join(same_[t[0]], same_[t[1]]);
      parts.join(same_[t[0]], same_[t[2]]);
    }
    std::vector<char> known(mesh_.vertices.size(), 0);
    for (const Triangle3& t : mesh_.triangles) {
      char& is_known = known[parts.find(same_[t[0]])];
      if (!is_known) solid_.part_points.push_back(mesh_.vertices[t[0]]);
      is_known = 1;
    }
    Numbering result;
    for (const Triangle3& t : facets_.triangles) result.push_back(parts.find(t[0]));
    return result;
  }

  // Calls take(ids) for all facets that have the same number and are not settled yet, unless they
  // are too few to enclose anything; if it returns true, they are now.
  template <class Take>
  void settle(const Numbering& numbering, const Take& take) {
    Numbering open;
    for (std::uint32_t i = 0; i < settled_.size(); ++i) {
      if (!settled_[i]) open.push_back(i);
    }
    const auto number = [&](std::uint32_t i) { return numbering[i]; };
    forEachGroup(open.begin(), open.end(), number, [&](auto begin, auto end) {
      if (end - begin < 4 || !take(Numbering(begin, end))) return;
      for (auto i = begin; i != end; ++i) settled_[*i] = 1;
    });
  }

  Surface asItIs(const Numbering& ids, int most_copies) const {
    Surface surface;
    for (const std::uint32_t i : ids) {
      const int n = std::min(facets_.copies[i], most_copies);
      surface.insert(surface.end(), static_cast<std::size_t>(n), facets_.triangles[i]);
    }
    return surface;
  }

  // Pieces whose sides cancel at each edge: closed, and oriented consistently. Where triangles are
  // repeated, each once if that cancels too.
  void takeBalanced(const Numbering& piece, Sides& sides) {
    std::vector<char> once(piece.size(), 1), all(piece.size(), 1);
    forEachEdge(sides, [&](auto begin, auto end) {
      const auto number = [&](const Side& side) { return piece[side.triangle]; };
      forEachGroup(begin, end, number, [&](auto first, auto last) {
        if (balance(first, last, facets_.copies, 1) != 0) once[number(*first)] = 0;
        if (balance(first, last, facets_.copies, ALL_COPIES) != 0) all[number(*first)] = 0;
      });
    });
    settle(piece, [&](const Numbering& ids) {
      const std::uint32_t number = piece[ids[0]];
      if (!once[number] && !all[number]) return false;
      return take(asItIs(ids, once[number] ? 1 : ALL_COPIES), as_they_are_);
    });
  }

  bool takeAsItIs(const Numbering& ids) {
    Surface surface = asItIs(ids, ALL_COPIES);
    return isClosed(mesh_, surface) && take(std::move(surface), as_they_are_);
  }

  // Which way the triangles face is then not asked for.
  bool takeOuterFaces(const Numbering& ids) {
    Surface surface;
    for (const std::uint32_t i : ids) surface.push_back(facets_.triangles[i]);
    Surface outer = outerFaces(mesh_, surface, LooseEdges::ARE_SEAMS);
    if (!isClosed(mesh_, outer)) outer = outerFaces(mesh_, surface, LooseEdges::ARE_GAPS);
    return take(std::move(outer), turned_outwards_);
  }

  static bool take(Surface surface, std::vector<Surface>& taken) {
    if (surface.empty()) return false;
    taken.push_back(std::move(surface));
    return true;
  }

  void add(const Surface& surface) {
    solid_.outward.insert(solid_.outward.end(), surface.begin(), surface.end());
    solid_.volume += volumeOf(mesh_, surface);
  }

  // Bodies face outwards, those that faced inwards too. One that faces the other way than most of
  // the volume does bounds a hollow, if it lies within a body.
  void orient() {
    double sum = 0.0;
    for (const Surface& surface : as_they_are_) sum += volumeOf(mesh_, surface);
    std::vector<Surface> inward;
    for (Surface& surface : as_they_are_) {
      if (sum < 0.0) turn(surface);
      if (volumeOf(mesh_, surface) < 0.0) {
        inward.push_back(std::move(surface));
      } else {
        add(surface);
      }
    }
    WindingNumber bodies;
    if (!inward.empty()) bodies = WindingNumber(mesh_.vertices, solid_.outward);
    for (Surface& surface : inward) {
      const bool is_within = std::all_of(surface.begin(), surface.end(), [&](const Triangle3& t) {
        return bodies.holds(centroid(mesh_, t));
      });
      if (!is_within) turn(surface);
      add(surface);
    }
    for (const Surface& surface : turned_outwards_) add(surface);
  }

  const TriangleMesh& mesh_;
  const std::vector<std::uint32_t> same_;
  const Facets facets_;
  std::vector<char> settled_;         // one a facet
  std::vector<Surface> as_they_are_;  // closed
  std::vector<Surface> turned_outwards_;
  MeshSolid solid_;
};

}  // namespace

MeshSolid findSolid(const TriangleMesh& mesh) { return SolidFinder(mesh).find(); }

}  // namespace collision_pairs
