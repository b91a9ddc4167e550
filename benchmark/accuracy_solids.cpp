// Prints the second accuracy table of docs/accuracy.md, of meshes and half-spaces:
//   accuracy_solids [POSES_PER_ROW]
//
// The mesh is an L, whose surface is that of two boxes which overlap; the truth is the smaller of
// the distances of its two pieces, which are convex pairs of the first table (and so certified by
// the oracle there). A depth is right if moving the second body by it, along the normal, leaves no
// piece deeper than rounding. The truth for a half-space is the lowest point, in closed form.
#include <cmath>
#include <cstdio>
#include <cstdlib>

#include "accuracy_rows.h"
#include "test_shapes.h"

namespace collision_pairs {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;

constexpr double INF = std::numeric_limits<double>::infinity();
constexpr double BAND = 1e-9 * 0.2;  // metres: of the bodies' size

struct Worst {
  int wrong = 0, degraded = 0;
  double distance = 0.0, left_after_depth = 0.0, witness = 0.0;
};

/// Convex pieces with their poses in the body's frame.
struct Body {
  std::shared_ptr<const PreparedShape> whole;
  std::vector<std::pair<std::shared_ptr<const PreparedShape>, Isometry3d>> pieces;
};

Body makeBody(RandomInputs& random, const std::string& kind) {
  if (kind != "mesh") {
    const auto shape = prepareShape(randomShape(random, kind));
    return {shape, {{shape, Isometry3d::Identity()}}};
  }
  const LShape l;
  Body body{prepareShape(Mesh{std::make_shared<TriangleMesh>(l.mesh())}), {}};
  for (int i = 0; i < 2; ++i) {
    Isometry3d X = Isometry3d::Identity();
    X.translation() = l.piece_centers[i];
    body.pieces.emplace_back(prepareShape(Box{2.0 * l.piece_halves[i]}), X);
  }
  return body;
}

double ofPieces(NarrowPhase& narrow_phase, const Body& a, const Body& b, const Isometry3d& X_AB) {
  double least = INF;
  for (const auto& [A, X_AA] : a.pieces) {
    for (const auto& [B, X_BB] : b.pieces) {
      const Isometry3d X = X_AA.inverse() * X_AB * X_BB;
      least = std::min(least, narrow_phase.distance(*A, *B, X, INF).distance);
    }
  }
  return least;
}

Worst measureMesh(RandomInputs& random, const std::string& kind, int poses) {
  Worst worst;
  NarrowPhase narrow_phase;
  for (int i = 0; i < poses; ++i) {
    const Body a = makeBody(random, "mesh"), b = makeBody(random, kind);
    const Isometry3d X_AB =
        randomPose(random, narrow_phase, *a.whole, *b.whole, static_cast<Separation>(i % 5));
    const PairDistance found = narrow_phase.distance(*a.whole, *b.whole, X_AB, INF);
    const double truth = ofPieces(narrow_phase, a, b, X_AB);
    worst.degraded += found.certainty == Certainty::DEGRADED;
    worst.wrong += found.touches() != (truth <= 0.0) && std::abs(truth) > BAND;
    if (found.touches()) {
      Isometry3d moved = X_AB;
      moved.translation() -= found.distance * found.nhat_AB_A;
      const double left = -ofPieces(narrow_phase, a, b, moved);
      worst.left_after_depth = std::max(worst.left_after_depth, left);
    } else if (truth > 0.0) {
      worst.distance = std::max(worst.distance, std::abs(found.distance - truth));
      const double apart = (found.p_ACb - found.p_ACa).norm();
      worst.witness = std::max(worst.witness, std::abs(apart - truth));
    }
  }
  return worst;
}

/// The lowest z of the shape at that pose.
double lowest(const Shape& shape, const Isometry3d& X) {
  const Vector3d up = X.linear().row(2);  // z of each of its axes
  const double z = X.translation().z(), side = std::hypot(up.x(), up.y());
  if (const auto* box = std::get_if<Box>(&shape)) return z - 0.5 * up.cwiseAbs().dot(box->size);
  if (const auto* sphere = std::get_if<Sphere>(&shape)) return z - sphere->radius;
  if (const auto* c = std::get_if<Cylinder>(&shape)) {
    return z - c->radius * side - 0.5 * c->length * std::abs(up.z());
  }
  if (const auto* c = std::get_if<Capsule>(&shape)) {
    return z - c->radius - 0.5 * c->length * std::abs(up.z());
  }
  const auto* convex = std::get_if<Convex>(&shape);
  const TriangleMesh& mesh = convex ? *convex->mesh : *std::get<Mesh>(shape).mesh;
  double least = INF;
  for (const Vector3d& v : mesh.vertices) least = std::min(least, z + up.dot(v));
  return least;
}

Worst measureHalfSpace(RandomInputs& random, const std::string& kind, int poses) {
  Worst worst;
  NarrowPhase narrow_phase;
  const auto floor = prepareShape(HalfSpace{});
  for (int i = 0; i < poses; ++i) {
    const Body body = makeBody(random, kind);
    Isometry3d X = random.pose(0.0);
    X.translation() = random.vector(-1.0, 1.0);
    // A third each: anywhere, nearly touching, 2 mm deep.
    const double wanted = i % 3 == 1 ? std::pow(10.0, random.uniform(-16.0, -2.0)) : -0.002;
    if (i % 3 != 0) X.translation().z() += wanted - lowest(body.whole->shape(), X);
    const PairDistance found = narrow_phase.distance(*floor, *body.whole, X, INF);
    const double truth = lowest(body.whole->shape(), X);
    worst.degraded += found.certainty == Certainty::DEGRADED;
    worst.wrong += found.touches() != (truth <= 0.0) && std::abs(truth) > BAND;
    double& error = found.touches() ? worst.left_after_depth : worst.distance;
    error = std::max(error, std::abs(found.distance - truth));
    const double apart = (found.p_ACb - found.p_ACa).dot(found.nhat_AB_A);
    worst.witness = std::max(worst.witness, std::abs(apart - truth));
  }
  return worst;
}

void print(const std::string& pair, const Worst& worst) {
  std::printf("| %s | %d | %d | %.1e | %.1e | %.1e |\n", pair.c_str(), worst.wrong, worst.degraded,
              worst.distance, worst.left_after_depth, worst.witness);
  std::fflush(stdout);
}

}  // namespace
}  // namespace collision_pairs

int main(int argc, char** argv) {
  using namespace collision_pairs;
  const int poses = argc > 1 ? std::atoi(argv[1]) : 10000;
  RandomInputs random;
  std::printf(
      "| pair | wrong yes/no | degraded | distance | depth | witness points |\n"
      "|---|---|---|---|---|---|\n");
  const char* const KINDS[] = {"box", "sphere", "cylinder", "capsule", "convex", "mesh"};
  for (const char* kind : KINDS) {
    print(std::string("mesh-") + kind, measureMesh(random, kind, poses));
  }
  for (const char* kind : KINDS) {
    print(std::string("half-space-") + kind, measureHalfSpace(random, kind, poses));
  }
  return 0;
}
