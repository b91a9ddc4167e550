#include "outer_spheres.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace collision_pairs {
namespace {

using Eigen::Vector3d;

constexpr double CLOSE = 0.01;    // of the root's radius: leaves that stick out less are kept
constexpr int MOST_DEPTH = 24;    // of a tree
constexpr int MOST_HALVINGS = 3;  // of the step of the search for a centre
constexpr int MOST_ROUNDS = 50;   // of that search
constexpr int CORE_POINTS = 24;   // of a set for enclosingSphere()
constexpr int CORE_STEPS = 200;   // on that set, per round
constexpr double CLOSE_ENOUGH = 1.002;
constexpr double RELATIVE_ROUNDING = 1e-12;  // relative, of results computed from coordinates

/// The part on one side of a plane perpendicular to an axis; sign 1: above `at`, -1: below.
/// Sutherland, Hodgman: "Reentrant polygon clipping" (1974).
Polygon clipped(const Polygon& polygon, int axis, double at, double sign) {
  Polygon kept;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vector3d &p = polygon[i], &next = polygon[(i + 1) % polygon.size()];
    const double above = sign * (p[axis] - at), next_above = sign * (next[axis] - at);
    if (above >= 0.0) kept.push_back(p);
    if ((above < 0.0) == (next_above < 0.0) || above == 0.0 || next_above == 0.0) continue;
    kept.push_back(p + above / (above - next_above) * (next - p));
    kept.back()[axis] = at;
  }
  return kept;
}

const Vector3d& furthestPoint(const std::vector<Vector3d>& points, const Vector3d& from) {
  const Vector3d* best = &points.front();
  double most = -1.0;
  for (const Vector3d& p : points) {
    const double squared = (p - from).squaredNorm();
    if (squared > most) most = squared, best = &p;
  }
  return *best;
}

double furthest(const std::vector<Vector3d>& points, const Vector3d& from) {
  double squared = 0.0;
  for (const Vector3d& p : points) squared = std::max(squared, (p - from).squaredNorm());
  return std::sqrt(squared);
}

/// The sphere around given points that sticks out of a solid least: by its radius minus the depth
/// of its centre.
class BestSphere {
 public:
  BestSphere(const CoveredSolid& solid, const std::vector<PlacedSphere>& samples)
      : solid_(solid), samples_(samples) {}

  PlacedSphere sphere;
  double sticks_out;

  void around(const std::vector<Vector3d>& points, const Aabb& box) {
    if (samples_.empty()) {
      sphere = enclosingSphere(points);
      sticks_out = sphere.radius;
      return;
    }
    const Vector3d center = box.center();
    deep_ = depthAt(center);
    sphere = {center, furthest(points, center)};
    sticks_out = sphere.radius - deep_;
    tryInside(points);
    search(points, 0.25 * (box.max - box.min).maxCoeff());
  }

 private:
  double depthAt(const Vector3d& p) const {
    const double depth = solid_.depth(p);
    return solid_.holds && !solid_.holds(p) ? -depth : depth;
  }

  void tryInside(const std::vector<Vector3d>& points) {
    std::array<const Vector3d*, 6> outermost;  // to reject a sphere early
    outermost.fill(&points.front());
    for (const Vector3d& p : points) {
      for (int axis = 0; axis < 3; ++axis) {
        if (p[axis] < (*outermost[axis])[axis]) outermost[axis] = &p;
        if (p[axis] > (*outermost[3 + axis])[axis]) outermost[3 + axis] = &p;
      }
    }
    for (const PlacedSphere& sample : samples_) {
      const double limit = sticks_out + sample.radius;
      if (limit <= 0.0) continue;
      const auto isBeyond = [&](const Vector3d& p) {
        return (p - sample.center).squaredNorm() >= limit * limit;
      };
      if (std::any_of(outermost.begin(), outermost.end(),
                      [&](const Vector3d* p) { return isBeyond(*p); })) {
        continue;
      }
      const auto beyond = std::find_if(points.begin(), points.end(), isBeyond);
      if (beyond != points.end()) continue;
      take({sample.center, furthest(points, sample.center)}, sample.radius);
    }
  }

  // The depths of two points differ by at most their distance.
  void search(const std::vector<Vector3d>& points, double step) {
    for (int round = 0, halvings = 0; round < MOST_ROUNDS && halvings < MOST_HALVINGS; ++round) {
      bool is_better = false;
      for (int i = 0; i < 6; ++i) {
        Vector3d center = sphere.center;
        center[i % 3] += i < 3 ? step : -step;
        const double radius = furthest(points, center);
        if (radius - (deep_ + step) >= sticks_out) continue;
        const double deep = step < deep_ ? solid_.depth(center) : depthAt(center);
        if (radius - deep >= sticks_out) continue;
        take({center, radius}, deep);
        is_better = true;
      }
      if (is_better) continue;
      step *= 0.5;
      ++halvings;
    }
  }

  void take(const PlacedSphere& better, double deep) {
    sphere = better;
    deep_ = deep;
    sticks_out = sphere.radius - deep;
  }

  const CoveredSolid& solid_;
  const std::vector<PlacedSphere>& samples_;
  double deep_ = 0.0;
};

void buildOver(const std::vector<PlacedSphere>& leaves, std::size_t begin, std::size_t end, int at,
               std::vector<OuterSphere>& spheres) {
  OuterSphere& sphere = spheres[static_cast<std::size_t>(at)];
  if (begin + 1 == end) {
    sphere = {leaves[begin], 0};
    return;
  }
  sphere.center = 0.5 * (leaves[begin].center + leaves[end - 1].center);
  for (std::size_t i = begin; i < end; ++i) {
    const double reach = (leaves[i].center - sphere.center).norm() + leaves[i].radius;
    sphere.radius = std::max(sphere.radius, reach * (1.0 + RELATIVE_ROUNDING));
  }
  const int children = sphere.first_child = static_cast<int>(spheres.size());
  spheres.resize(spheres.size() + 2);
  const std::size_t middle = (begin + end) / 2;
  buildOver(leaves, begin, middle, children, spheres);
  buildOver(leaves, middle, end, children + 1, spheres);
}

class OuterTree {
 public:
  OuterTree(const CoveredSolid& solid, const std::vector<PlacedSphere>& samples,
            std::size_t most_spheres)
      : solid_(solid), best_(solid, samples), most_spheres_(most_spheres) {}

  std::vector<OuterSphere> build() {
    add({0, 0, 0.0, solid_.surface, boxAround(cornersOf(solid_.surface))});
    const double close = CLOSE * spheres_[0].radius;
    while (!open_.empty() && open_.front().sticks_out > close &&
           spheres_.size() + 2 <= most_spheres_) {
      std::pop_heap(open_.begin(), open_.end());
      const Leaf leaf = std::move(open_.back());
      open_.pop_back();
      divide(leaf);
    }
    return std::move(spheres_);
  }

 private:
  struct Leaf {
    int sphere;
    int depth;
    double sticks_out;
    std::vector<Polygon> surface;
    Aabb box;  ///< of the part of the solid in its cell
    bool operator<(const Leaf& other) const { return sticks_out < other.sticks_out; }
  };

  /// Adds a leaf; its box is still that of its cell.
  void add(Leaf leaf) {
    std::vector<Vector3d> extremes = cornersOf(leaf.surface);
    for (int i = 0; i < 8; ++i) {
      const Vector3d corner((i & 1 ? leaf.box.max : leaf.box.min)[0],
                            (i & 2 ? leaf.box.max : leaf.box.min)[1],
                            (i & 4 ? leaf.box.max : leaf.box.min)[2]);
      if (solid_.may_hold(corner)) extremes.push_back(corner);
    }
    leaf.sphere = static_cast<int>(spheres_.size());
    spheres_.push_back({{leaf.box.center(), 0.0}, 0});
    if (extremes.empty()) return;  // the cell is empty
    leaf.box = boxAround(extremes);
    best_.around(extremes, leaf.box);
    static_cast<PlacedSphere&>(spheres_.back()) = best_.sphere;
    spheres_.back().radius +=
        RELATIVE_ROUNDING * (best_.sphere.radius + best_.sphere.center.norm());
    leaf.sticks_out = best_.sticks_out;
    if (leaf.depth == MOST_DEPTH) return;
    open_.push_back(std::move(leaf));
    std::push_heap(open_.begin(), open_.end());
  }

  void divide(const Leaf& leaf) {
    int axis = 0;
    (leaf.box.max - leaf.box.min).maxCoeff(&axis);
    const double middle = leaf.box.center()[axis];
    spheres_[static_cast<std::size_t>(leaf.sphere)].first_child = static_cast<int>(spheres_.size());
    for (const bool upper : {false, true}) {
      Leaf half{0, leaf.depth + 1, 0.0, {}, leaf.box};
      for (const Polygon& polygon : leaf.surface) {
        Polygon kept = clipped(polygon, axis, middle, upper ? 1.0 : -1.0);
        if (!kept.empty()) half.surface.push_back(std::move(kept));
      }
      (upper ? half.box.min : half.box.max)[axis] = middle;
      add(std::move(half));
    }
  }

  const CoveredSolid& solid_;
  BestSphere best_;
  const std::size_t most_spheres_;
  std::vector<OuterSphere> spheres_;
  std::vector<Leaf> open_;  // a heap
};

}  // namespace

PlacedSphere enclosingSphere(const std::vector<Vector3d>& points) {
  std::vector<Vector3d> core{points.front(), furthestPoint(points, points.front())};
  PlacedSphere best{core[0], (furthestPoint(points, core[0]) - core[0]).norm()};
  Vector3d center = 0.5 * (core[0] + core[1]);
  for (int round = 0; round < CORE_POINTS; ++round) {
    for (int step = 1; step <= CORE_STEPS && round > 0; ++step) {
      center += (furthestPoint(core, center) - center) / (step + 1.0);
    }
    const Vector3d& outermost = furthestPoint(points, center);
    const double radius = (outermost - center).norm();
    if (radius < best.radius) best = {center, radius};
    if (radius <= CLOSE_ENOUGH * (furthestPoint(core, center) - center).norm()) break;
    core.push_back(outermost);
  }
  return best;
}

std::vector<OuterSphere> treeOver(const std::vector<PlacedSphere>& leaves) {
  std::vector<OuterSphere> spheres(1);
  buildOver(leaves, 0, leaves.size(), 0, spheres);
  return spheres;
}

std::vector<OuterSphere> outerSpheres(const CoveredSolid& solid,
                                      const std::vector<PlacedSphere>& samples,
                                      std::size_t most_spheres) {
  return OuterTree(solid, samples, most_spheres).build();
}

}  // namespace collision_pairs
