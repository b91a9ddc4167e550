#include "fcl_backend.h"

#include <exception>
#include <vector>

#include <fcl/geometry/bvh/BVH_model.h>
#include <fcl/narrowphase/collision.h>

namespace collision_pairs {

struct FclMesh::Impl {
  fcl::BVHModel<fcl::OBBd> model;
};

FclMesh::FclMesh() = default;
FclMesh::~FclMesh() = default;
FclMesh::FclMesh(FclMesh&&) noexcept = default;
FclMesh& FclMesh::operator=(FclMesh&&) noexcept = default;

FclMesh::FclMesh(const TriangleMesh& mesh) {
  std::vector<fcl::Triangle> triangles;
  triangles.reserve(mesh.triangles.size());
  for (const auto& t : mesh.triangles) triangles.emplace_back(t[0], t[1], t[2]);
  try {
    auto impl = std::make_unique<Impl>();
    impl->model.beginModel(static_cast<int>(triangles.size()),
                           static_cast<int>(mesh.vertices.size()));
    const bool filled = impl->model.addSubModel(mesh.vertices, triangles) == fcl::BVH_OK;
    if (filled && impl->model.endModel() == fcl::BVH_OK) impl_ = std::move(impl);
  } catch (const std::exception&) {
    impl_ = nullptr;
  }
}

FclAnswer fclSurfacesMeet(const FclMesh& A, const FclMesh& B, const Eigen::Isometry3d& X_AB) {
  FclAnswer answer;
  if (A.empty() || B.empty()) return answer;
  try {
    const fcl::CollisionRequestd request(1, false);
    fcl::CollisionResultd result;
    fcl::collide(&A.impl_->model, fcl::Transform3d::Identity(), &B.impl_->model,
                 fcl::Transform3d(X_AB.matrix()), request, result);
    answer.settled = true;
    answer.meet = result.isCollision();
    if (answer.meet) {
      answer.triangle_a = result.getContact(0).b1;
      answer.triangle_b = result.getContact(0).b2;
    }
  } catch (const std::exception&) {
    answer.settled = false;
  }
  return answer;
}

}  // namespace collision_pairs
