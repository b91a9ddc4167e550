// The distance of two triangles against CGAL's exact kernel: on grids, where they touch, share
// corners and planes and have parallel edges, and thin ones.
#include <CGAL/Exact_predicates_exact_constructions_kernel.h>
#include <CGAL/Triangle_3.h>
#include <CGAL/intersections.h>
#include <gtest/gtest.h>

#include "random_inputs.h"
#include "triangle_distance.h"

namespace collision_pairs::test_triangle_distance {

using Eigen::Vector3d;
using Kernel = CGAL::Exact_predicates_exact_constructions_kernel;

constexpr double INF = std::numeric_limits<double>::infinity();
constexpr double ROUNDING = 4e-15;  // of the size

Kernel::Point_3 exactly(const Vector3d& p) { return {p.x(), p.y(), p.z()}; }

Kernel::Triangle_3 exactly(const Corners& t) {
  return {exactly(t[0]), exactly(t[1]), exactly(t[2])};
}

double rootOf(const Kernel::FT& squared) { return std::sqrt(CGAL::to_double(squared)); }

double exactDistance(const Kernel::Triangle_3& t, const Kernel::Point_3& p) {
  return rootOf(CGAL::squared_distance(t, p));
}

/// CGAL before 5.5 has it of a corner and a triangle, and of two edges, but not of two triangles.
double exactDistance(const Kernel::Triangle_3& a, const Kernel::Triangle_3& b) {
  if (CGAL::do_intersect(a, b)) return 0.0;
  Kernel::FT least = CGAL::squared_distance(a.vertex(0), b);
  for (int i = 0; i < 3; ++i) {
    least = std::min(least, CGAL::squared_distance(a.vertex(i), b));
    least = std::min(least, CGAL::squared_distance(b.vertex(i), a));
    for (int j = 0; j < 3; ++j) {
      const Kernel::Segment_3 edge_a(a.vertex(i), a.vertex(i + 1)),
          edge_b(b.vertex(j), b.vertex(j + 1));
      least = std::min(least, CGAL::squared_distance(edge_a, edge_b));
    }
  }
  return rootOf(least);
}

/// Returns whether they meet. `rounding`: metres.
bool expectRight(const Corners& a, const Corners& b, double rounding) {
  const Kernel::Triangle_3 s = exactly(a), t = exactly(b);
  const double exact = exactDistance(s, t);
  ClosestPoints best{INF};
  EXPECT_TRUE(improveByTriangles(Triangle(a), Triangle(b), best));
  EXPECT_NEAR(std::sqrt(best.squared), exact, rounding);
  EXPECT_NEAR((best.on_a - best.on_b).norm(), exact, rounding);
  EXPECT_LE(exactDistance(s, exactly(best.on_a)), rounding);
  EXPECT_LE(exactDistance(t, exactly(best.on_b)), rounding);
  best.squared = std::pow(exact + 2.0 * rounding, 2);
  EXPECT_TRUE(improveByTriangles(Triangle(a), Triangle(b), best)) << "passed over";
  return exact == 0.0;
}

TEST(TriangleDistance, OnAGridIsExactToRounding) {
  RandomInputs random;
  int met = 0;
  for (int i = 0; i < 20000 && !testing::Test::HasFailure(); ++i) {
    // Doubles hold whole numbers exactly, but only roughly what is parallel in decimals.
    const double steps[] = {1.0, 1.0, 0.1, 0.0035}, step = steps[random.integer(0, 3)];
    const auto corner = [&] {
      return Vector3d(step * random.integer(0, 4), step * random.integer(0, 4),
                      step * random.integer(0, 2));
    };
    const Corners a{corner(), corner(), corner()}, b{corner(), corner(), corner()};
    if (exactly(a).is_degenerate() || exactly(b).is_degenerate()) continue;
    SCOPED_TRACE(i);
    met += expectRight(a, b, ROUNDING * step);
  }
  EXPECT_GT(met, 1000);
}

// Down to where nothing but rounding is left of their planes.
TEST(TriangleDistance, OfSliversIsExactToRounding) {
  RandomInputs random;
  const auto triangle = [&](bool is_sliver) -> Corners {
    const Vector3d a = random.vector(-1.0, 1.0), b = random.vector(-1.0, 1.0);
    if (!is_sliver) return {a, b, random.vector(-1.0, 1.0)};
    const double thickness = std::pow(10.0, random.uniform(-17.0, -3.0));
    return {a, b, a + random.uniform(0.1, 0.9) * (b - a) + thickness * random.vector(-1.0, 1.0)};
  };
  for (int i = 0; i < 20000 && !testing::Test::HasFailure(); ++i) {
    SCOPED_TRACE(i);
    const Corners a = triangle(true), b = triangle(random.integer(0, 1));
    if (exactly(a).is_degenerate() || exactly(b).is_degenerate()) continue;
    expectRight(a, b, ROUNDING);
  }
}

TEST(TriangleDistance, TrianglesWithoutAreaAreSegmentsAndPoints) {
  const Triangle segment({0, 0, 0}, {1, 0, 0}, {2, 0, 0}), point({3, 4, 0}, {3, 4, 0}, {3, 4, 0});
  ClosestPoints best{INF};
  ASSERT_TRUE(improveByTriangles(segment, point, best));
  EXPECT_DOUBLE_EQ(best.squared, 17.0);
}

TEST(TriangleDistance, APlaneKeepsApartOnlyWhatIsApart) {
  RandomInputs random;
  int apart = 0;
  for (int i = 0; i < 20000; ++i) {
    Corners a, b;
    for (Corners* t : {&a, &b}) {  // a small grid: many touch, lie in a plane or have no area
      for (Vector3d& v : *t)
        v = Vector3d(random.integer(0, 4), random.integer(0, 4), random.integer(0, 2));
    }
    const double limit = random.integer(0, 3);
    if (!planeKeepsApart(a, b, limit)) continue;
    ClosestPoints best{INF};
    improveByTriangles(Triangle(a), Triangle(b), best);
    ASSERT_GT(best.squared, limit) << i;
    ++apart;
  }
  EXPECT_GT(apart, 1000);
}

}  // namespace collision_pairs::test_triangle_distance
