// The point of a simplex that is closest to the origin, by what makes it the closest.
#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "random_inputs.h"
#include "simplex.h"

namespace collision_pairs::test_simplex {

using Eigen::Vector3d;

/// In general position, around the origin and beside it. Where triangles and tetrahedra are flat
/// but for rounding, the point may be another one: who searches with it looks at what it found.
Simplex<double> randomSimplex(RandomInputs& random) {
  Simplex<double> simplex;
  simplex.size = random.integer(1, 4);
  const Vector3d centre = random.vector(-1.0, 1.0) * random.integer(0, 2);
  for (int i = 0; i < simplex.size; ++i) {
    simplex.vertex[i].w = centre + random.vector(-1.0, 1.0);
  }
  if (simplex.size == 2 && random.integer(0, 9) == 0) simplex.vertex[0] = simplex.vertex[1];
  return simplex;
}

/// Weights of its vertices, and no other numbers.
void expectMixture(const Simplex<double>& reduced) {
  ASSERT_GE(reduced.size, 1);
  double sum = 0.0;
  for (int k = 0; k < reduced.size; ++k) {
    ASSERT_GE(reduced.lambda[k], 0.0);
    sum += reduced.lambda[k];
  }
  ASSERT_NEAR(sum, 1.0, 1e-12);
}

// A point v of a convex set is the closest to the origin if and only if the plane through v with
// normal v leaves the whole set behind it.
TEST(Simplex, TheClosestPointIsAMixtureOfItsVerticesWithThemAllBehindIt) {
  RandomInputs random;
  int nb_inside = 0, nb_with_all = 0;
  for (int i = 0; i < 200000; ++i) {
    const Simplex<double> given = randomSimplex(random);
    Simplex<double> reduced = given;
    reduceToClosest(reduced);
    ASSERT_NO_FATAL_FAILURE(expectMixture(reduced)) << i;
    const Vector3d v = reduced.closest();
    for (int k = 0; k < given.size; ++k) {
      ASSERT_GE(given.vertex[k].w.dot(v), v.squaredNorm() - 1e-7) << i;
    }
    nb_inside += v.norm() < 1e-12;
    nb_with_all += reduced.size == given.size;
  }
  EXPECT_GT(nb_inside, 1000);
  EXPECT_GT(nb_with_all, 1000);
}

// On a line or in a plane to the last bit, where the volumes that decide are zero or rounding.
TEST(Simplex, TheClosestPointOfAFlatOneIsAMixtureOfItsVerticesToo) {
  RandomInputs random;
  for (int i = 0; i < 200000; ++i) {
    const int dimension = random.integer(1, 2);
    const auto wholeVector = [&] {
      return Vector3d(random.integer(-9, 9), random.integer(-9, 9), random.integer(-9, 9));
    };
    const Vector3d origin = wholeVector(), along = wholeVector(), across = wholeVector();
    Simplex<double> given;
    given.size = random.integer(2, 4);
    for (int k = 0; k < given.size; ++k) {
      given.vertex[k].w = origin + random.integer(-9, 9) * along;
      if (dimension == 2) given.vertex[k].w += random.integer(-9, 9) * across;
    }
    Simplex<double> reduced = given;
    reduceToClosest(reduced);
    ASSERT_NO_FATAL_FAILURE(expectMixture(reduced)) << i;
    double nearest = INFINITY;  // of the edges, for those on a line: of what they span
    for (int k = 0; k < given.size; ++k) {
      for (int j = 0; j < given.size; ++j) {
        const Vector3d p = given.vertex[k].w, edge = given.vertex[j].w - p;
        const double share = edge.isZero() ? 0.0 : -p.dot(edge) / edge.squaredNorm();
        nearest = std::min(nearest, (p + std::clamp(share, 0.0, 1.0) * edge).norm());
      }
    }
    ASSERT_LE(reduced.closest().norm(), nearest + 1e-7) << i;
    if (dimension == 1) {
      ASSERT_NEAR(reduced.closest().norm(), nearest, 1e-7) << i;
    }
  }
}

}  // namespace collision_pairs::test_simplex
