#include "surface_contact.h"

#include <algorithm>

#include "patch_hulls.h"

namespace collision_pairs {
namespace {

using Eigen::Isometry3d;

}  // namespace

// Children are written to the stack whether they overlap or not, and kept by moving its end: a
// branch for each would be mispredicted half of the time.
void SurfaceContact::push(const NodePair& parent, bool of_a, const TriangleTree::Node& split,
                          const FourGaps& gaps, double limit) {
  if (stack_.size() < size_ + BOX_LANES) stack_.resize(2 * stack_.size() + 64);
  for (std::uint32_t i = 0; i < BOX_LANES; ++i) {
    NodePair& place = stack_[size_];
    place.a = of_a ? split.children + i : parent.a;
    place.b = of_a ? parent.b : split.children + i;
    size_ += static_cast<std::size_t>((i < split.nb_children) & (gaps.of[i] <= limit));
  }
}

// The overlap of boxes does not tell which of them hold intersecting triangles, so they are not
// sorted, and hulls are not tested.
bool SurfaceContact::surfacesMeet(const PreparedMesh& A, const PreparedMesh& B,
                                  const Isometry3d& X_AB, double band) {
  const Isometry3d X_BA = X_AB.inverse(Eigen::Isometry);
  const OrientedBox box_a = A.tree.box(0), box_b = B.tree.box(0);
  const double limit = square(band);
  if (squaredBoxGap(box_a, box_b.movedBy(X_AB)) > limit) return false;
  ClosestPoints best{limit * (1.0 + 1e-15)};
  stack_.resize(std::max<std::size_t>(stack_.size(), 1));
  stack_[0] = {0, 0};
  size_ = 1;
  while (size_ > 0) {
    const NodePair pair = stack_[--size_];
    const TriangleTree::Node& a = A.tree.node(pair.a);
    const TriangleTree::Node& b = B.tree.node(pair.b);
    if (a.isLeaf() && b.isLeaf()) {
      const Corners t = cornersOf(*A.triangles, a.children);
      const Corners u = moved(cornersOf(*B.triangles, b.children), X_AB);
      if (planeKeepsApart(t, u, limit) || planeKeepsApart(u, t, limit)) continue;
      if (improveByTriangles(Triangle(t), Triangle(u), best)) return true;
      continue;
    }
    const bool split_a = !a.isLeaf() && (b.isLeaf() || a.size >= b.size);
    const FourGaps gaps = split_a ? A.tree.squaredGaps(a, B.tree, pair.b, X_AB)
                                  : B.tree.squaredGaps(b, A.tree, pair.a, X_BA);
    push(pair, split_a, split_a ? a : b, gaps, limit);
  }
  return false;
}

}  // namespace collision_pairs
