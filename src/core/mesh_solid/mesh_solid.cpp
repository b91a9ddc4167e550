#include "mesh_solid.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "infinity.h"
#include "outer_faces.h"
#include "solid_angle.h"
#include "winding_number.h"

namespace collision_pairs {
namespace {

using Eigen::Vector3d;
using Numbering = std::vector<std::uint32_t>;  // by facet; equal numbers belong together

constexpr double CLOSED_BELOW = 0.02;   // mean error in turns: half the share of missing area
constexpr int NUM_SAMPLES = 64;         // per surface that may be closed
constexpr double SAMPLE_HEIGHT = 1e-3;  // above a triangle, relative to its area / perimeter
constexpr double NEARLY_MEET = 1e-5;    // distance of vertices, relative to the mesh's size
constexpr double MIN_POSITIVE = std::numeric_limits<double>::min();
constexpr double CONVEX_TOLERANCE = 1e-12;  // of the mesh's size

Vector3d centroid(const TriangleMesh& mesh, const Triangle3& t) {
  return (mesh.vertices[t[0]] + mesh.vertices[t[1]] + mesh.vertices[t[2]]) / 3.0;
}

Vector3d areaVector(const TriangleMesh& mesh, const Triangle3& t) {
  const Vector3d& a = mesh.vertices[t[0]];
  return 0.5 * (mesh.vertices[t[1]] - a).cross(mesh.vertices[t[2]] - a);
}

// The open edges of a surface, as segments from first to second.
std::vector<std::pair<std::uint32_t, std::uint32_t>> boundaryOf(const Surface& surface) {
  std::vector<std::pair<std::uint32_t, std::uint32_t>> boundary;
  Sides sides = sortedSides(surface);
  const std::vector<int> once(surface.size(), 1);
  forEachEdge(sides, [&](auto begin, auto end) {
    const int sum = balance(begin, end, once, 1);
    const auto low = begin->low, high = begin->high;
    boundary.insert(boundary.end(), static_cast<std::size_t>(std::abs(sum)),
                    sum > 0 ? std::pair(low, high) : std::pair(high, low));
  });
  return boundary;
}

// Area of flat caps over a surface's open edges: for each set of connected edges, the length of the
// vector area that any surface across it has.
double capArea(const TriangleMesh& mesh, const Surface& surface) {
  const auto boundary = boundaryOf(surface);
  UnionFind loops(mesh.vertices.size());
  for (const auto& [i, j] : boundary) loops.join(i, j);
  std::map<std::uint32_t, Vector3d> caps;  // by loop: twice its vector area
  for (const auto& [i, j] : boundary) {
    const Vector3d& tip = mesh.vertices[loops.find(i)];
    const auto cap = caps.try_emplace(loops.find(i), Vector3d::Zero()).first;
    cap->second += (mesh.vertices[i] - tip).cross(mesh.vertices[j] - tip);
  }
  double area = 0.0;
  for (const auto& [loop, twice] : caps) area += 0.5 * twice.norm();
  return area;
}

// Deviation of a surface's winding number from an integer. A fan over its boundary would close the
// surface and make it an integer, so the fan's contribution is the deviation.
class WindingError {
 public:
  WindingError(const TriangleMesh& mesh, const Surface& surface)
      : mesh_(mesh), boundary_(boundaryOf(surface)) {
    for (const auto& [i, j] : boundary_) tip_ += mesh.vertices[i] / boundary_.size();
  }
  double at(const Vector3d& p) const {
    SolidAngleSum fan(p);
    for (const auto& [i, j] : boundary_) fan.add(tip_, mesh_.vertices[i], mesh_.vertices[j]);
    return std::abs(fan.total() - std::round(fan.total()));
  }

 private:
  const TriangleMesh& mesh_;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> boundary_;
  Vector3d tip_ = Vector3d::Zero();
};

// A point just above a triangle.
Vector3d pointAbove(const TriangleMesh& mesh, const Triangle3& t) {
  const Vector3d &a = mesh.vertices[t[0]], &b = mesh.vertices[t[1]], &c = mesh.vertices[t[2]];
  const double circumference = (b - a).norm() + (c - b).norm() + (a - c).norm();
  return centroid(mesh, t) + SAMPLE_HEIGHT / circumference * areaVector(mesh, t);
}

// The winding number of a closed surface is an integer. Returns the mean deviation of this one's,
// next to its triangles, at samples spread evenly over its area. Below CLOSED_BELOW the open edges
// do not matter: they match only in part, or vertices nearly coincide, or a triangle is missing.
// Infinite if above.
double openness(const TriangleMesh& mesh, const Surface& surface) {
  const WindingError winding_error(mesh, surface);
  double area = 0.0, passed = 0.0, error = 0.0;
  for (const Triangle3& t : surface) area += areaVector(mesh, t).norm();
  int sample = 0;
  for (const Triangle3& t : surface) {
    const int before = sample;
    passed += areaVector(mesh, t).norm();
    while (sample < NUM_SAMPLES && (sample + 0.5) * area < passed * NUM_SAMPLES) ++sample;
    if (sample == before) continue;
    error += (sample - before) * winding_error.at(pointAbove(mesh, t)) / NUM_SAMPLES;
    if (!(error < CLOSED_BELOW)) return INF;
  }
  return sample > 0 ? error : INF;
}

void turn(Surface& surface) {
  for (Triangle3& t : surface) std::swap(t[1], t[2]);
}

Surface facingOutwards(const Surface& surface, const std::vector<int>& facing) {
  Surface result;
  for (std::size_t i = 0; i < surface.size(); ++i) {
    if (facing[i] == 0) continue;
    result.push_back(surface[i]);
    if (facing[i] < 0) std::swap(result.back()[1], result.back()[2]);
  }
  return result;
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
    findPartPoints();
    Sides sides = sortedSides(facets_.triangles);
    const Numbering piece = piecesOf(facets_, sides);
    const std::vector<char> consistent = keepBalanced(piece, sides);
    settle(piece, [&](const Numbering& ids) {
      return keepNearlyClosed(ids, consistent[piece[ids[0]]] != 0);
    });
    if (std::count(settled_.begin(), settled_.end(), 0) > 0) {
      const auto together = [&](const Numbering& ids) { return keepAsItIs(ids); };
      settle(nearParts(), together);
      settle(Numbering(piece.size(), 0), together);
    }
    orient();
    solid_.locally_convex = solid_.part_points.size() == 1 && !solid_.outward.empty() &&
                            isLocallyConvex(mesh_, solid_.outward);
    findMissingShare();
    return std::move(solid_);
  }

 private:
  // Parts connected by vertices, with vertices merged according to `same`.
  UnionFind partsOf(const std::vector<std::uint32_t>& same) const {
    UnionFind parts(mesh_.vertices.size());
    for (const Triangle3& t : mesh_.triangles) {
      parts.join(same[t[0]], same[t[1]]);
      parts.join(same[t[0]], same[t[2]]);
    }
    return parts;
  }

  void findPartPoints() {
    UnionFind parts = partsOf(same_);
    std::vector<char> known(mesh_.vertices.size(), 0);
    for (const Triangle3& t : mesh_.triangles) {
      char& is_known = known[parts.find(same_[t[0]])];
      if (!is_known) solid_.part_points.push_back(mesh_.vertices[t[0]]);
      is_known = 1;
    }
  }

  // Numbers the facets by parts connected by vertices that coincide or nearly do. Rounding may
  // separate some vertices; one that it does not is enough to connect two parts.
  Numbering nearParts() const {
    Vector3d low = mesh_.vertices[0], high = low;
    for (const Vector3d& v : mesh_.vertices) {
      low = low.cwiseMin(v);
      high = high.cwiseMax(v);
    }
    const double cell = std::max(NEARLY_MEET * (high - low).maxCoeff(), MIN_POSITIVE);
    std::vector<Vector3d> rounded;
    for (const Vector3d& v : mesh_.vertices) rounded.push_back((v / cell).array().round());
    const std::vector<std::uint32_t> same = weld(rounded);
    UnionFind parts = partsOf(same);
    Numbering result;
    for (const Triangle3& t : facets_.triangles) result.push_back(parts.find(same[t[0]]));
    return result;
  }

  // Calls keep(ids) for the unsettled facets of each number, unless they are too few to enclose
  // anything. If it returns true, they are settled.
  template <class Keep>
  void settle(const Numbering& numbering, const Keep& keep) {
    Numbering open;
    for (std::uint32_t i = 0; i < settled_.size(); ++i) {
      if (!settled_[i]) open.push_back(i);
    }
    const auto number = [&](std::uint32_t i) { return numbering[i]; };
    forEachGroup(open.begin(), open.end(), number, [&](auto begin, auto end) {
      if (end - begin < 4 || !keep(Numbering(begin, end))) return;
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

  // Pieces whose sides cancel at each edge are closed and consistently oriented. Repeated triangles
  // count once if that cancels too. Returns which pieces are consistent except at open edges.
  std::vector<char> keepBalanced(const Numbering& piece, Sides& sides) {
    std::vector<char> once(piece.size(), 1), all(piece.size(), 1), consistent(piece.size(), 1);
    forEachEdge(sides, [&](auto begin, auto end) {
      const auto number = [&](const Side& side) { return piece[side.triangle]; };
      forEachGroup(begin, end, number, [&](auto first, auto last) {
        if (balance(first, last, facets_.copies, 1) != 0) once[number(*first)] = 0;
        if (balance(first, last, facets_.copies, ALL_COPIES) == 0) return;
        all[number(*first)] = 0;
        if (last - first > 1) consistent[number(*first)] = 0;
      });
    });
    settle(piece, [&](const Numbering& ids) {
      const std::uint32_t number = piece[ids[0]];
      if (!once[number] && !all[number]) return false;
      return keep(asItIs(ids, once[number] ? 1 : ALL_COPIES), as_they_are_);
    });
    return consistent;
  }

  bool keepAsItIs(const Numbering& ids) {
    Surface surface = asItIs(ids, ALL_COPIES);
    return openness(mesh_, surface) < CLOSED_BELOW && keep(std::move(surface), as_they_are_);
  }

  // The piece as it is, or its outer faces whichever way its triangles face: the one that is less
  // open. The faces left out may still close something together with others.
  bool keepNearlyClosed(const Numbering& ids, bool consistent) {
    Surface given = asItIs(ids, ALL_COPIES);
    const double given_open = openness(mesh_, given);
    if (consistent && given_open < CLOSED_BELOW) return keep(std::move(given), as_they_are_);
    Surface surface;
    for (const std::uint32_t i : ids) surface.push_back(facets_.triangles[i]);
    std::vector<int> facing = outerFaces(mesh_, surface, LooseEdges::ARE_SEAMS);
    Surface outer = facingOutwards(surface, facing);
    const double outer_open = openness(mesh_, outer);
    if (given_open < CLOSED_BELOW && given_open <= outer_open) {
      return keep(std::move(given), as_they_are_);
    }
    if (!(outer_open < CLOSED_BELOW)) {
      facing = outerFaces(mesh_, surface, LooseEdges::ARE_GAPS);
      outer = facingOutwards(surface, facing);
    }
    for (std::size_t k = 0; k < ids.size(); ++k) settled_[ids[k]] = facing[k] != 0;
    keep(std::move(outer), turned_outwards_);
    return false;
  }

  static bool keep(Surface surface, std::vector<Surface>& kept) {
    if (surface.empty()) return false;
    kept.push_back(std::move(surface));
    return true;
  }

  void add(const Surface& surface) {
    solid_.outward.insert(solid_.outward.end(), surface.begin(), surface.end());
    solid_.volume += volumeOf(mesh_, surface);
  }

  // Makes all bodies face outwards. A surface that faces opposite to most of the volume bounds a
  // cavity, if it lies within a body.
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

  // Sheets within the bodies are internal walls, and those that face both ways have no thickness.
  void findMissingShare() {
    const bool is_all_closed = std::count(settled_.begin(), settled_.end(), 0) == 0;
    if (is_all_closed) return;
    WindingNumber bodies;
    if (!solid_.outward.empty()) bodies = WindingNumber(mesh_.vertices, solid_.outward);
    Surface open;
    double area = 0.0;
    for (std::size_t i = 0; i < facets_.triangles.size(); ++i) {
      const Triangle3& t = facets_.triangles[i];
      area += areaVector(mesh_, t).norm();
      const bool is_open = !settled_[i] && facets_.copies[i] != 0;
      if (is_open && (solid_.outward.empty() || !bodies.holds(centroid(mesh_, t)))) {
        open.push_back(t);
      }
    }
    const double missing = capArea(mesh_, open);
    if (missing > 0.0) solid_.missing_share = missing / (area + missing);
  }

  const TriangleMesh& mesh_;
  const std::vector<std::uint32_t> same_;
  const Facets facets_;
  std::vector<char> settled_;         // one per facet
  std::vector<Surface> as_they_are_;  // closed
  std::vector<Surface> turned_outwards_;
  MeshSolid solid_;
};

}  // namespace

MeshSolid findSolid(const TriangleMesh& mesh) { return SolidFinder(mesh).find(); }

}  // namespace collision_pairs
