#include "collision_pairs/narrow_phase.h"

#include <fcl/geometry/bvh/BVH_model.h>
#include <fcl/geometry/geometric_shape_to_BVH_model.h>
#include <fcl/narrowphase/collision.h>
#include <fcl/narrowphase/distance.h>

namespace collision_pairs {
namespace {

using Bvh = fcl::BVHModel<fcl::OBBRSSd>;

struct FclShape : PreparedShape {
  explicit FclShape(const Shape& shape) : PreparedShape(shape) {}
  std::shared_ptr<fcl::CollisionGeometryd> geometry;
};

std::shared_ptr<fcl::CollisionGeometryd> toBvh(const TriangleMesh& mesh) {
  auto bvh = std::make_shared<Bvh>();
  bvh->beginModel(static_cast<int>(mesh.triangles.size()), static_cast<int>(mesh.vertices.size()));
  std::vector<fcl::Triangle> triangles;
  triangles.reserve(mesh.triangles.size());
  for (const auto& t : mesh.triangles) triangles.emplace_back(t[0], t[1], t[2]);
  bvh->addSubModel(mesh.vertices, triangles);
  bvh->endModel();
  return bvh;
}

struct ToFcl {
  using Result = std::shared_ptr<fcl::CollisionGeometryd>;
  Result operator()(const Box& box) const {
    auto bvh = std::make_shared<Bvh>();
    fcl::generateBVHModel(*bvh, fcl::Boxd(box.size), fcl::Transform3d::Identity());
    return bvh;
  }
  Result operator()(const Sphere& s) const { return std::make_shared<fcl::Sphered>(s.radius); }
  Result operator()(const Cylinder& c) const {
    return std::make_shared<fcl::Cylinderd>(c.radius, c.length);
  }
  Result operator()(const Capsule& c) const {
    return std::make_shared<fcl::Capsuled>(c.radius, c.length);
  }
  Result operator()(const HalfSpace&) const {
    return std::make_shared<fcl::Halfspaced>(Eigen::Vector3d::UnitZ(), 0.0);
  }
  Result operator()(const Convex& convex) const { return toBvh(*convex.mesh); }
  Result operator()(const Mesh& mesh) const { return toBvh(*mesh.mesh); }
};

}  // namespace

struct NarrowPhase::Scratch {};
NarrowPhase::NarrowPhase() : scratch_(std::make_unique<Scratch>()) {}
NarrowPhase::~NarrowPhase() = default;
NarrowPhase::NarrowPhase(NarrowPhase&&) noexcept = default;
NarrowPhase& NarrowPhase::operator=(NarrowPhase&&) noexcept = default;

std::shared_ptr<const PreparedShape> prepareShape(const Shape& shape) {
  validateShape(shape);
  auto prepared = std::make_shared<FclShape>(shape);
  prepared->geometry = std::visit(ToFcl{}, shape);
  return prepared;
}

bool NarrowPhase::touches(const PreparedShape& A, const PreparedShape& B,
                          const Eigen::Isometry3d& X_AB) {
  return distance(A, B, X_AB, 0.0).touches();
}

PairDistance NarrowPhase::distance(const PreparedShape& A, const PreparedShape& B,
                                   const Eigen::Isometry3d& X_AB, double max_distance) {
  const auto* a = static_cast<const FclShape&>(A).geometry.get();
  const auto* b = static_cast<const FclShape&>(B).geometry.get();
  const fcl::Transform3d identity = fcl::Transform3d::Identity();
  const fcl::Transform3d X_AB_fcl(X_AB.matrix());
  PairDistance result;
  fcl::CollisionRequestd ask_contact(1, true);
  fcl::CollisionResultd contact;
  if (fcl::collide(a, identity, b, X_AB_fcl, ask_contact, contact) > 0) {
    result.distance = -std::abs(contact.getContact(0).penetration_depth);
    result.p_ACa = result.p_ACb = contact.getContact(0).pos;
    result.certainty = Certainty::BOUND;
    return result;
  }
  fcl::DistanceRequestd ask_distance(true);
  fcl::DistanceResultd found;
  if (max_distance < 1e300) found.min_distance = max_distance;
  fcl::distance(a, identity, b, X_AB_fcl, ask_distance, found);
  result.distance = found.min_distance;
  result.p_ACa = found.nearest_points[0];
  result.p_ACb = found.nearest_points[1];
  if (result.distance >= max_distance) result.certainty = Certainty::BEYOND;
  result.nhat_AB_A = (result.p_ACb - result.p_ACa).normalized();
  return result;
}

}  // namespace collision_pairs
