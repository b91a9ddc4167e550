// FCL, behind one door: the only file of the package that includes it is fcl_backend.cpp.
#pragma once

#include <memory>

#include <Eigen/Geometry>

#include "collision_pairs/shape.h"

namespace collision_pairs {

/// A mesh as FCL's tree of oriented boxes. Empty if FCL refused it.
class FclMesh {
 public:
  FclMesh();
  explicit FclMesh(const TriangleMesh& mesh);
  ~FclMesh();
  FclMesh(FclMesh&&) noexcept;
  FclMesh& operator=(FclMesh&&) noexcept;

  bool empty() const { return impl_ == nullptr; }

 private:
  friend struct FclAnswer fclSurfacesMeet(const FclMesh&, const FclMesh&, const Eigen::Isometry3d&);
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Do two surfaces meet? `settled` is false if FCL threw.
struct FclAnswer {
  bool settled = false;
  bool meet = false;
  int triangle_a = -1;  ///< where they meet
  int triangle_b = -1;
};

/// Surfaces only: one wholly inside the other is "no" here. B's pose is given in A's frame. Of
/// FCL's calls this is the one used because it is right on sound triangles, fast, and free of
/// asserts and of GJK: BVHModel<OBB> against BVHModel<OBB>, one contact.
FclAnswer fclSurfacesMeet(const FclMesh& A, const FclMesh& B, const Eigen::Isometry3d& X_AB);

}  // namespace collision_pairs
