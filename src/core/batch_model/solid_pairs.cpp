#include "solid_pairs.h"

#include <algorithm>
#include <limits>
#include <map>

namespace collision_pairs {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;

constexpr std::size_t MOST_ELEMENTS = 4000;  // of a scene: one byte a pair, 16 MB

std::size_t nbTriangles(const Prepared& shape) {
  return shape.mesh ? shape.mesh->triangles->triangles.size() : 0;
}

/// Points of the solid.
std::vector<Vector3d> cornersOf(const Prepared& shape) {
  if (!shape.mesh) return shape.hull.points.vertices;
  std::vector<Vector3d> corners;
  for (const auto& triangle : shape.mesh->triangles->triangles) {
    for (const auto vertex : triangle) corners.push_back(shape.mesh->triangles->vertices[vertex]);
  }
  return corners;
}

/// Farthest point sampling: repeatedly the one furthest from those chosen so far.
std::vector<Vector3d> farthestPoints(const std::vector<Vector3d>& points, std::size_t most) {
  std::vector<Vector3d> chosen;
  std::vector<double> apart(points.size(), std::numeric_limits<double>::infinity());
  while (chosen.size() < most && !points.empty()) {
    const auto furthest = std::max_element(apart.begin(), apart.end()) - apart.begin();
    if (!(apart[static_cast<std::size_t>(furthest)] > 0.0)) break;
    chosen.push_back(points[static_cast<std::size_t>(furthest)]);
    for (std::size_t i = 0; i < points.size(); ++i) {
      apart[i] = std::min(apart[i], (points[i] - chosen.back()).squaredNorm());
    }
  }
  return chosen;
}

}  // namespace

SolidPairs::SolidPairs(const CollisionScene& scene, const BatchModel& model)
    : scene_(scene), model_(model), data_(scene.elements().size()) {
  std::map<const PreparedShape*, std::uint32_t> first_with;
  for (std::uint32_t i = 0; i < data_.size(); ++i) {
    const PreparedShape* const shape = scene.elements()[i].rung(Fidelity::MESH).shape.get();
    first_with_shape_.push_back(first_with.try_emplace(shape, i).first->second);
  }
  if (data_.size() > MOST_ELEMENTS) return;
  is_worth_.resize(data_.size() * data_.size());
  for (const BatchPair& of_model : model.pairs) {
    const BoxPair pair{model.element_of[static_cast<std::size_t>(of_model.first)],
                       model.element_of[static_cast<std::size_t>(of_model.second)]};
    const std::size_t nb_triangles = nbTriangles(preparedOf(scene.elements()[pair.first])) +
                                     nbTriangles(preparedOf(scene.elements()[pair.second]));
    is_worth_[indexOf(pair)] = !of_model.has_table && nb_triangles >= LEAST_TRIANGLES;
  }
}

std::size_t SolidPairs::indexOf(const BoxPair& pair) const {
  return pair.first * data_.size() + pair.second;
}

const SolidPairs::ElementData& SolidPairs::dataOf(std::uint32_t element) const {
  element = first_with_shape_[element];
  ElementData& data = data_[element];
  if (!data.is_made.load(std::memory_order_acquire) &&
      data.nb_asked.fetch_add(1, std::memory_order_relaxed) >= ASKED) {
    std::call_once(data.once, [&] { make(element, data); });
  }
  return data;
}

void SolidPairs::make(std::uint32_t element, ElementData& data) const {
  const Prepared& shape = preparedOf(scene_.elements()[element]);
  data.field = SolidField::make(shape);
  data.corners = farthestPoints(cornersOf(shape), SolidField::Points::MOST);
  data.of_corners = SolidField::Points(data.corners);
  std::vector<Vector3d> centers;
  for (const OuterSphere& sphere : model_.covers[element].outer) {
    if (sphere.first_child != 0) continue;
    data.spheres.push_back(sphere);
    centers.push_back(sphere.center);
  }
  data.of_spheres = SolidField::Points(centers);
  data.is_made.store(true, std::memory_order_release);
}

SolidPairs::Outcome SolidPairs::settle(const BoxPair& pair, const Isometry3d& X_AB) const {
  if (is_worth_.empty() || !is_worth_[indexOf(pair)]) return Outcome::OPEN;
  const ElementData &a = dataOf(pair.first), &b = dataOf(pair.second);
  if (!a.is_made.load(std::memory_order_acquire) || !b.is_made.load(std::memory_order_acquire)) {
    return Outcome::OPEN;
  }
  const double padding = scene_.padding(pair.first, pair.second);
  const Isometry3d X_BA = X_AB.inverse(Eigen::Isometry);
  if (areApart(a, b, X_AB, padding) || areApart(b, a, X_BA, padding)) return Outcome::FREE;
  return touch(a, b, X_AB) || touch(b, a, X_BA) ? Outcome::CONTACT : Outcome::OPEN;
}

// The sphere that seems nearest comes first: it soon tells that not all are apart.
bool SolidPairs::areApart(const ElementData& solid, const ElementData& other, const Isometry3d& X,
                          double padding) {
  float nodes[SolidField::Points::MOST];
  const auto& spheres = other.spheres;
  if (!solid.field || spheres.empty()) return false;  // static boxes have no spheres
  if (!solid.field->nearestNodes(other.of_spheres, X, nodes)) return false;
  const auto isApart = [&](std::size_t i) {
    const double reach = spheres[i].radius + padding;
    return nodes[i] - solid.field->off() > reach ||
           solid.field->isFurther(X * spheres[i].center, reach);
  };
  std::size_t nearest = 0;
  for (std::size_t i = 1; i < spheres.size(); ++i) {
    const double gap = nodes[i] - spheres[i].radius;
    if (gap < nodes[nearest] - spheres[nearest].radius) nearest = i;
  }
  if (!isApart(nearest)) return false;
  for (std::size_t i = 0; i < spheres.size(); ++i) {
    if (i != nearest && !isApart(i)) return false;
  }
  return true;
}

bool SolidPairs::touch(const ElementData& solid, const ElementData& other, const Isometry3d& X) {
  float nodes[SolidField::Points::MOST];
  if (!solid.field || !solid.field->nearestNodes(other.of_corners, X, nodes)) return false;
  for (std::size_t i = 0; i < other.corners.size(); ++i) {
    if (nodes[i] < 0.0f &&
        (-nodes[i] > solid.field->off() || solid.field->isInside(X * other.corners[i]))) {
      return true;
    }
  }
  return false;
}

std::size_t SolidPairs::memory() const {
  std::size_t bytes = data_.size() * sizeof(ElementData) + is_worth_.size();
  for (const ElementData& data : data_) {
    if (!data.is_made.load(std::memory_order_acquire)) continue;
    bytes +=
        (data.field ? data.field->memory() : 0) +
        (data.spheres.size() + data.corners.size()) * (sizeof(PlacedSphere) + 3 * sizeof(float));
  }
  return bytes;
}

}  // namespace collision_pairs
