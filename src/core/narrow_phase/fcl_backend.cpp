// How FCL is called (numbers: issues of flexible-collision-library/fcl; measured on 0.7.0).
//
// Never called, because the process may abort or the call may not return:
// - signed distance of pairs without a closed form: EPA throws (#319, #390, #398, #445, #493,
//   #529), its asserts abort (#322), and it may not terminate for round shapes;
// - collide() of such pairs: the MPR of libccd has unbounded loops (#243), and its depth is not the
//   smallest (#106);
// - GST_INDEP: wrong depths, and "apart" for overlaps below its tolerance;
// - planes and half-spaces: some pairs call a null pointer.
//
// Instead:
// - the closed forms for spheres, two capsules and two boxes;
// - GJK for all other convex pairs, with a bounded number of steps: the two functions that make up
//   FCL's own unsigned distance, compiled here so that their assert (doSimplex2) is disabled;
// - trees of triangles, OBBRSS for both queries, with the same GJK at their leaves.
#ifndef NDEBUG
#define NDEBUG
#endif
#include "fcl_backend.h"

#include <exception>
#include <type_traits>
#include <variant>
#include <vector>

#include <fcl/geometry/bvh/BVH_model.h>
#include <fcl/geometry/shape/convex.h>
#include <fcl/narrowphase/collision.h>
#include <fcl/narrowphase/detail/convexity_based_algorithm/gjk_libccd.h>
#include <fcl/narrowphase/detail/traversal/collision_node.h>
#include <fcl/narrowphase/detail/traversal/distance/bvh_shape_distance_traversal_node.h>
#include <fcl/narrowphase/distance.h>

#include "closed_forms.h"
#include "infinity.h"

namespace collision_pairs {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;
using Outcome = FclAnswer::Outcome;
using Formulas = fcl::detail::GJKSolver_libccd<double>;
using Tree = fcl::BVHModel<fcl::OBBRSSd>;

constexpr double UNITS = FCL_UNITS;
constexpr double CONVERGED = 1e-14;   // of the size of a pair: GJK ends at a smaller step
constexpr unsigned MAX_STEPS = 1000;  // of GJK: about 50 us

template <class T, class A, class B>
constexpr bool ARE_BOTH = std::is_same_v<A, T>&& std::is_same_v<B, T>;

template <class A, class B>
constexpr bool HAS_SPHERE_FORMULA = (std::is_same_v<A, fcl::Sphered> &&
                                     !std::is_same_v<B, fcl::Convexd>) ||
                                    (std::is_same_v<B, fcl::Sphered> &&
                                     !std::is_same_v<A, fcl::Convexd>);

/// In FCL's units.
struct FclObject : FclShape {
  std::variant<fcl::Boxd, fcl::Sphered, fcl::Cylinderd, fcl::Capsuled, fcl::Convexd, Tree> object;
  double size = 0.0;  ///< no point is further from the origin of its frame
};

/// Support function of a shape at a pose, for GJK.
struct Support {
  std::unique_ptr<void, void (*)(void*)> object;
  ccd_support_fn function;
};

template <class Shape>
Support supportOf(const Shape& shape, const Isometry3d& X = Isometry3d::Identity()) {
  using Init = fcl::detail::GJKInitializer<double, Shape>;
  return {{Init::createGJKObject(shape, X), &Init::deleteGJKObject}, Init::getSupportFunction()};
}

Support supportOfTriangle(const Tree& tree, int index) {
  using namespace fcl::detail;
  const fcl::Triangle& t = tree.tri_indices[index];
  const Vector3d* const v = tree.vertices;
  return {{triCreateGJKObject(v[t[0]], v[t[1]], v[t[2]]), &triDeleteGJKObject},
          triGetSupportFunction()};
}

/// FCL's GJK. It may miss an overlap, since it gives up on thin simplices. So a gap has to be
/// confirmed by the separating plane perpendicular to the line between its points, with the support
/// functions of both shapes.
class Gjk {
 public:
  Gjk(const Support& a, const Support& b) : a_(a.object.get()), b_(b.object.get()) {
    CCD_INIT(&ccd_);
    ccd_.support1 = a.function;
    ccd_.support2 = b.function;
    ccd_.max_iterations = MAX_STEPS;
  }

  FclGap run(const FclQuestion& question) {
    if (fcl::detail::libccd_extension::__ccdGJK(a_, b_, &ccd_, &simplex_) == 0) return FclGap();
    if (!question.max_distance) {
      const FclGap nearly = measure(INF);  // of GJK's final simplex
      if (confirmedGap(nearly) > 0.0) return nearly;
    }
    FclGap gap = measure(CONVERGED * question.size);
    const double confirmed = confirmedGap(gap);
    gap.settled = confirmed > 0.0 && confirmed >= gap.distance - FCL_CONFIRMED * question.size;
    return gap;
  }

 private:
  FclGap measure(double tolerance) {
    ccd_.dist_tolerance = tolerance;
    ccd_vec3_t p_a{}, p_b{};
    FclGap gap;
    gap.distance = fcl::detail::libccd_extension::_ccdDist(a_, b_, &ccd_, &simplex_, &p_a, &p_b);
    gap.p_a = Vector3d(p_a.v);
    gap.p_b = Vector3d(p_b.v);
    return gap;
  }

  double confirmedGap(const FclGap& gap) const {
    if (gap.touches()) return 0.0;  // it did not converge
    const Vector3d a_to_b = (gap.p_b - gap.p_a).normalized();
    ccd_vec3_t dir;
    ccdVec3Set(&dir, a_to_b[0], a_to_b[1], a_to_b[2]);
    ccd_support_t furthest;
    __ccdSupport(a_, b_, &dir, &ccd_, &furthest);
    return -Vector3d(furthest.v.v).dot(a_to_b);
  }

  const void *a_, *b_;
  ccd_t ccd_;
  ccd_simplex_t simplex_;
};

// The deepest point of a sphere is one radius from its centre; FCL's contact point depends on the
// type of pair.
template <class A, class B>
FclAnswer askFormula(const A& a, const B& b, const FclQuestion& question) {
  const Isometry3d X_A = Isometry3d::Identity();
  FclGap gap;
  Formulas().shapeDistance(a, X_A, b, question.X_AB, &gap.distance, &gap.p_a, &gap.p_b);
  if (!gap.touches()) return fclApart(gap, question);
  if (!question.max_distance) return Outcome::TOUCHING;
  if constexpr (ARE_BOTH<fcl::Capsuled, A, B>) {
    return fclDeep(gap.p_a, (gap.p_b - gap.p_a) / gap.distance, -gap.distance);
  } else {
    std::vector<fcl::ContactPointd> contact;
    Formulas().shapeIntersect(a, X_A, b, question.X_AB, &contact);
    if (contact.size() != 1) return Outcome::NONE;
    const Vector3d& nhat = contact[0].normal;
    const double depth = contact[0].penetration_depth;
    if constexpr (std::is_same_v<A, fcl::Sphered>) {
      return fclDeep(a.radius * nhat, nhat, depth);
    } else {
      return fclDeep(question.X_AB.translation() + (depth - b.radius) * nhat, nhat, depth);
    }
  }
}

// In metres, because FCL adds an absolute tolerance to the axes of two boxes. Its depth is not the
// smallest: the normal of a face is used unless that of two edges is better by 5 %.
bool boxesTouch(const fcl::Boxd& a, const fcl::Boxd& b, Isometry3d X_AB) {
  X_AB.translation() /= UNITS;
  return Formulas().shapeIntersect(fcl::Boxd(a.side / UNITS), Isometry3d::Identity(),
                                   fcl::Boxd(b.side / UNITS), X_AB, nullptr);
}

template <class A, class B>
FclAnswer askSolids(const A& a, const B& b, const FclQuestion& question) {
  if constexpr (HAS_SPHERE_FORMULA<A, B> || ARE_BOTH<fcl::Capsuled, A, B>) {
    return askFormula(a, b, question);
  } else {
    constexpr bool BOXES = ARE_BOTH<fcl::Boxd, A, B>;
    if constexpr (BOXES) {
      if (boxesTouch(a, b, question.X_AB)) return Outcome::TOUCHING;
      if (!question.max_distance) return Outcome::APART;
    }
    const FclGap gap = Gjk(supportOf(a), supportOf(b, question.X_AB)).run(question);
    if (!gap.touches() || !gap.settled) return fclApart(gap, question);
    return BOXES ? Outcome::NONE : Outcome::TOUCHING;  // FCL reported two boxes as apart
  }
}

// Contact first: splitting boxes finds it much faster than a distance query.
FclAnswer askTrees(const Tree& a, const Tree& b, const FclQuestion& question) {
  fcl::CollisionResultd contact;
  fcl::collide(&a, Isometry3d::Identity(), &b, question.X_AB, fcl::CollisionRequestd(1, false),
               contact);
  if (contact.isCollision()) return Outcome::TOUCHING;
  if (!question.max_distance) return Outcome::APART;
  fcl::DistanceResultd nearest(question.bound());
  fcl::distance(&a, Isometry3d::Identity(), &b, question.X_AB, fcl::DistanceRequestd(true, false),
                nearest);
  if (nearest.b1 < 0) return fclBeyond(question);
  return fclApart(
      {nearest.min_distance, nearest.nearest_points[0], nearest.nearest_points[1], true}, question);
}

/// Searches a tree for the triangle that is nearest to a solid, or touches it.
template <class Solid>
struct NearestTriangle : fcl::detail::BVHShapeDistanceTraversalNode<fcl::OBBRSSd, Solid> {
  NearestTriangle(const Tree& tree, const Solid& the_solid, const FclQuestion& the_question)
      : question(the_question), solid(supportOf(the_solid, question.X_AB)) {
    this->model1 = &tree;
    fcl::computeBV(the_solid, question.X_AB, this->model2_bv);
    nearest.distance = question.bound();
  }

  double BVTesting(int node, int) const override {
    return this->model1->getBV(node).bv.distance(this->model2_bv);
  }
  void leafTesting(int node, int) const override {
    const int triangle = this->model1->getBV(node).primitiveId();
    const FclGap gap = Gjk(supportOfTriangle(*this->model1, triangle), solid).run(question);
    settled = settled && gap.settled;
    if (gap.settled && gap.distance < nearest.distance) nearest = gap;
  }
  bool canStop(double bound) const override { return bound >= nearest.distance; }

  const FclQuestion& question;
  Support solid;
  mutable FclGap nearest;
  mutable bool settled = true;
};

template <class Solid>
FclAnswer askTree(const Tree& a, const Solid& b, const FclQuestion& question) {
  NearestTriangle<Solid> search(a, b, question);
  fcl::detail::distance<double>(&search);
  if (search.nearest.touches()) return Outcome::TOUCHING;
  if (!search.settled) return Outcome::NONE;
  if (!question.max_distance) return Outcome::APART;
  const bool found = search.nearest.distance < question.bound();
  return found ? fclApart(search.nearest, question) : fclBeyond(question);
}

FclAnswer ask(const FclObject& A, const FclObject& B, const Isometry3d& X_AB,
              const FclQuestion& question) {
  const auto ask_both = [&](const auto& a, const auto& b) {
    constexpr bool is_tree_a = std::is_same_v<std::decay_t<decltype(a)>, Tree>;
    constexpr bool is_tree_b = std::is_same_v<std::decay_t<decltype(b)>, Tree>;
    if constexpr (is_tree_a && is_tree_b) {
      return askTrees(a, b, question);
    } else if constexpr (is_tree_a) {
      return askTree(a, b, question);
    } else if constexpr (is_tree_b) {
      FclQuestion from_b = question;
      from_b.X_AB = question.X_AB.inverse(Eigen::Isometry);
      FclAnswer answer = askTree(b, a, from_b);
      answer.found = exchanged(answer.found, X_AB);
      return answer;
    } else {
      return askSolids(a, b, question);
    }
  };
  return std::visit(ask_both, A.object, B.object);
}

/// False if FCL has no such solid, or refuses it.
struct MakeObject {
  bool operator()(const Box& box) { return make<fcl::Boxd>(UNITS * box.size); }
  bool operator()(const Sphere& sphere) { return make<fcl::Sphered>(UNITS * sphere.radius); }
  bool operator()(const Cylinder& c) {
    return make<fcl::Cylinderd>(UNITS * c.radius, UNITS * c.length);
  }
  bool operator()(const Capsule& c) {
    return make<fcl::Capsuled>(UNITS * c.radius, UNITS * c.length);
  }
  bool operator()(const HalfSpace&) { return false; }
  bool operator()(const Convex&) { return makeHull(); }
  bool operator()(const Mesh& shape) { return is_convex ? makeHull() : makeTree(*shape.mesh); }

  // Without faces FCL compares all vertices; with faces it walks along edges if there are many.
  bool makeHull() {
    auto faces = std::make_shared<std::vector<int>>();
    for (const auto& corners : hull.faces) {
      faces->push_back(3);
      faces->insert(faces->end(), corners.begin(), corners.end());
    }
    const auto points = std::make_shared<std::vector<Vector3d>>(inUnits(hull.points.vertices));
    return make<fcl::Convexd>(points, static_cast<int>(hull.faces.size()), faces);
  }

  bool makeTree(const TriangleMesh& mesh) {
    std::vector<fcl::Triangle> triangles;
    for (const auto& t : mesh.triangles) triangles.emplace_back(t[0], t[1], t[2]);
    Tree& tree = made.object.emplace<Tree>();
    tree.beginModel(static_cast<int>(triangles.size()), static_cast<int>(mesh.vertices.size()));
    return tree.addSubModel(inUnits(mesh.vertices), triangles) == fcl::BVH_OK &&
           tree.endModel() == fcl::BVH_OK;
  }

  static std::vector<Vector3d> inUnits(std::vector<Vector3d> points) {
    for (Vector3d& p : points) p *= UNITS;
    return points;
  }

  template <class Object, class... Sizes>
  bool make(const Sizes&... sizes) {
    made.object.emplace<Object>(sizes...);
    return true;
  }

  const ConvexHull& hull;
  bool is_convex;
  FclObject& made;
};

}  // namespace

std::unique_ptr<const FclShape> makeFclShape(const Shape& shape, const ConvexHull& hull,
                                             bool is_convex) {
  auto made = std::make_unique<FclObject>();
  try {
    if (!std::visit(MakeObject{hull, is_convex, *made}, shape)) return nullptr;
    const auto measure = [&](auto& object) {
      object.computeLocalAABB();
      made->size = object.aabb_center.norm() + object.aabb_radius;
    };
    std::visit(measure, made->object);
  } catch (const std::exception&) {
    return nullptr;
  }
  return made;
}

FclAnswer askFcl(const FclShape& A, const FclShape& B, const Isometry3d& X_AB,
                 std::optional<double> max_distance) noexcept {
  const auto &a = static_cast<const FclObject&>(A), &b = static_cast<const FclObject&>(B);
  FclQuestion question{X_AB, 0.0, max_distance};
  question.X_AB.translation() *= UNITS;
  question.size = a.size + b.size + question.X_AB.translation().norm();
  try {
    return ask(a, b, X_AB, question);
  } catch (const std::exception&) {
    return Outcome::NONE;
  }
}

}  // namespace collision_pairs
