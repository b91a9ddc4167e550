#include "sphere_cover.h"

#include <algorithm>
#include <cmath>

#include "covered_solid.h"

namespace collision_pairs {
namespace {

using Eigen::Vector3d;

constexpr int CAPSULE_SLICES = 10;   // with one sphere each, and one at each end
constexpr int PRISM_SIDES = 24;      // enlarges a cylinder by 0.9 % of its radius
constexpr int GRID = 14;             // samples along each side of the box
constexpr int MOST_INNER = 12;       // spheres
constexpr double WORTHWHILE = 0.08;  // of the largest inner sphere: the least that another one adds
constexpr double NEARLY_APART = 1e-9;  // relative: above the rounding of a distance

void sortLargestFirst(std::vector<PlacedSphere>& spheres) {
  std::sort(spheres.begin(), spheres.end(),
            [](const PlacedSphere& a, const PlacedSphere& b) { return a.radius > b.radius; });
}

/// Of samples with their distances from the surface, those that are inside. A sphere that does not
/// reach the surface is on the same side as its centre, so few centres have to be tested, the
/// largest first.
std::vector<PlacedSphere> insideOf(const CoveredSolid& solid, std::vector<PlacedSphere> samples) {
  sortLargestFirst(samples);
  enum { UNKNOWN, INSIDE, OUTSIDE };
  std::vector<int> where(samples.size(), UNKNOWN);
  std::vector<PlacedSphere> inside;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    if (where[i] == UNKNOWN) {
      const int here = solid.holds(samples[i].center) ? INSIDE : OUTSIDE;
      for (std::size_t j = i; j < samples.size(); ++j) {
        const double apart = (samples[j].center - samples[i].center).norm();
        if (j == i || apart < (1.0 - NEARLY_APART) * samples[i].radius) where[j] = here;
      }
    }
    if (where[i] == INSIDE) inside.push_back(samples[i]);
  }
  return inside;
}

/// Spheres inside the solid around the points of a grid.
std::vector<PlacedSphere> samplesOf(const CoveredSolid& solid) {
  const Aabb box = boxAround(cornersOf(solid.surface));
  std::vector<PlacedSphere> samples;
  for (int i = 0; i < GRID * GRID * GRID; ++i) {
    const Eigen::Array3d at = Eigen::Array3d(i % GRID, i / GRID % GRID, i / GRID / GRID) + 0.5;
    const Vector3d p = box.min.array() + at / GRID * (box.max - box.min).array();
    const double radius = solid.depth(p);
    if (radius > 0.0) samples.push_back({p, radius});
  }
  return solid.holds ? insideOf(solid, std::move(samples)) : samples;
}

/// Chooses, repeatedly, the sample that reaches furthest out of those chosen so far.
std::vector<PlacedSphere> innerSpheres(std::vector<PlacedSphere> samples) {
  std::vector<PlacedSphere> chosen;
  std::vector<double> outside(samples.size(), 0.0);  // of each centre, from the chosen spheres
  while (!samples.empty() && chosen.size() < MOST_INNER) {
    std::size_t best = 0;
    for (std::size_t i = 1; i < samples.size(); ++i) {
      const auto adds = [&](std::size_t s) { return samples[s].radius + outside[s]; };
      if (adds(i) > adds(best)) best = i;
    }
    const PlacedSphere sphere = samples[best];
    if (!chosen.empty() && sphere.radius + outside[best] < WORTHWHILE * chosen[0].radius) break;
    for (std::size_t i = 0; i < samples.size(); ++i) {
      const double gap = (samples[i].center - sphere.center).norm() - sphere.radius;
      outside[i] = chosen.empty() ? gap : std::min(outside[i], gap);
    }
    chosen.push_back(sphere);
  }
  sortLargestFirst(chosen);
  return chosen;
}

SphereCover coverOf(const CoveredSolid& solid, std::size_t most_spheres) {
  std::vector<PlacedSphere> samples = samplesOf(solid);
  SphereCover cover;
  cover.outer = outerSpheres(solid, samples, most_spheres);
  if (solid.is_exact) cover.inner = innerSpheres(std::move(samples));
  return cover;
}

SphereCover coverOfPoints(const std::vector<Vector3d>& points) {
  return {{{enclosingSphere(points), 0}}, {}};
}

SphereCover coverOfConvex(const ConvexHull& hull, double size, std::size_t most_spheres) {
  if (hull.faces.empty()) return coverOfPoints(hull.points.vertices);
  return coverOf(hullSolid(hull, size), most_spheres);
}

struct MakeCover {
  SphereCover operator()(const Sphere& sphere) const {
    const PlacedSphere whole{Vector3d::Zero(), sphere.radius};
    return {{{whole, 0}}, {whole}};
  }
  SphereCover operator()(const Capsule& capsule) const {
    SphereCover cover;
    const double half = 0.5 * capsule.length;
    // One sphere of its radius at each end, others around the slices between.
    std::vector<PlacedSphere> leaves;
    for (int i = 0; i < CAPSULE_SLICES; ++i) {
      const double z = half * ((2.0 * i + 1.0) / CAPSULE_SLICES - 1.0);
      leaves.push_back({{0.0, 0.0, z}, std::hypot(capsule.radius, half / CAPSULE_SLICES)});
      cover.inner.push_back({{0.0, 0.0, z}, capsule.radius});
    }
    leaves.insert(leaves.begin(), {{0.0, 0.0, -half}, capsule.radius});
    leaves.push_back({{0.0, 0.0, half}, capsule.radius});
    cover.outer = treeOver(leaves);
    return cover;
  }
  SphereCover operator()(const Box& box) const {
    std::vector<Vector3d> corners;
    for (int i = 0; i < 8; ++i) {
      const Eigen::Array3d sign(i & 1 ? 1 : -1, i & 2 ? 1 : -1, i & 4 ? 1 : -1);
      corners.push_back(0.5 * sign * box.size.array());
    }
    return coverOfConvex(convexHull(corners), size(), most_spheres);
  }
  SphereCover operator()(const Cylinder& cylinder) const {
    std::vector<Vector3d> corners;
    const double outside = cylinder.radius / std::cos(M_PI / PRISM_SIDES);
    const double half = 0.5 * cylinder.length;
    for (int i = 0; i < PRISM_SIDES; ++i) {
      const double angle = 2.0 * M_PI * i / PRISM_SIDES;
      for (const double z : {-half, half}) {
        corners.emplace_back(outside * std::cos(angle), outside * std::sin(angle), z);
      }
    }
    const ConvexHull prism = convexHull(corners);
    if (prism.faces.empty()) return coverOfPoints(corners);
    return coverOf(cylinderSolid(cylinder, prism, size()), most_spheres);
  }
  SphereCover operator()(const HalfSpace&) const { return {}; }
  SphereCover operator()(const Convex&) const {
    return coverOfConvex(shape.hull, size(), most_spheres);
  }
  SphereCover operator()(const Mesh&) const {
    const bool is_hull = !shape.mesh || shape.hull.faces.empty();
    if (is_hull) return coverOfConvex(shape.hull, size(), most_spheres);
    return coverOf(meshSolid(shape, size()), most_spheres);
  }
  double size() const { return shape.core.extent + shape.core.center.norm(); }

  const Prepared& shape;
  const std::size_t most_spheres;
};

}  // namespace

SphereCover coverBySpheres(const Prepared& shape, std::size_t most_spheres) {
  return std::visit(MakeCover{shape, most_spheres}, shape.shape());
}

const std::vector<OuterSphere>& FineSpheres::get() const {
  std::call_once(is_made_, [this] {
    const auto prepared = prepareShape(shape_);
    spheres_ = coverBySpheres(static_cast<const Prepared&>(*prepared), MOST_SPHERES).outer;
  });
  return spheres_;
}

}  // namespace collision_pairs
