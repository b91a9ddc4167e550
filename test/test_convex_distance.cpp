// The accuracy table in short, against an oracle that shares nothing with the code under test.
#include <dlfcn.h>
#include <gtest/gtest.h>

#include "benchmark/accuracy_rows.h"
#include "convex_distance.h"
#include "convex_hull.h"
#include "random_inputs.h"
#include "test_shapes.h"

namespace collision_pairs::test_convex_distance {

constexpr double INF = std::numeric_limits<double>::infinity();
constexpr double SIZE = 0.2;

bool hasFormula(const std::string& a, const std::string& b) {
  if (a == "cylinder" || b == "cylinder") return a == "sphere" || b == "sphere";
  return true;
}

void holdRow(const std::string& kind_a, const std::string& kind_b, int poses) {
  SCOPED_TRACE(kind_a + "-" + kind_b);
  RandomInputs random;
  NarrowPhase narrow_phase;
  const double tolerance = hasFormula(kind_a, kind_b) ? 1e-9 * SIZE : 1e-6;
  for (const Separation separation : {Separation::APART, Separation::NEAR, Separation::SLIGHT,
                                      Separation::DEEP, Separation::TWO_MILLIMETRES}) {
    for (int i = 0; i < poses; ++i) {
      const Shape a = randomShape(random, kind_a), b = randomShape(random, kind_b);
      const auto A = prepareShape(a), B = prepareShape(b);
      const Eigen::Isometry3d X_AB = randomPose(random, narrow_phase, *A, *B, separation);
      const PairDistance result = narrow_phase.distance(*A, *B, X_AB, INF);
      const AnswerError error = judge(oracleBody(a), oracleBody(b), X_AB, result, 1e-9 * SIZE);
      ASSERT_FALSE(error.wrong_verdict) << name(separation) << " pose " << i;
      ASSERT_LE(error.distance, tolerance) << name(separation) << " pose " << i;
      ASSERT_LE(error.normal, tolerance) << name(separation) << " pose " << i;
      ASSERT_LE(error.witness, 1e-4 * SIZE) << name(separation) << " pose " << i;
      ASSERT_NEAR(result.nhat_AB_A.norm(), 1.0, 1e-12);
      ASSERT_NE(result.certainty, Certainty::DEGRADED);
    }
  }
}

TEST(ConvexDistance, OfEveryPairIsRightToRoundingWhereThereIsAFormulaAndElseMeetsTheGoal) {
  const std::vector<std::string> kinds{"box", "sphere", "cylinder", "capsule", "convex"};
  for (std::size_t a = 0; a < kinds.size(); ++a) {
    for (std::size_t b = a; b < kinds.size(); ++b)
      holdRow(kinds[a], kinds[b], kinds[b] == "box" ? 60 : 20);
  }
}

TEST(ConvexDistance, StopsWhenALowerBoundExceedsTheLimit) {
  NarrowPhase narrow_phase;
  const auto A = prepareShape(Box{{0.2, 0.2, 0.2}}), B = prepareShape(Cylinder{0.1, 0.2});
  Eigen::Isometry3d X_AB = Eigen::Isometry3d::Identity();
  X_AB.translation() = Eigen::Vector3d(0.5, 0.0, 0.0);
  const PairDistance result = narrow_phase.distance(*A, *B, X_AB, 0.1);
  EXPECT_EQ(result.certainty, Certainty::BEYOND);
  EXPECT_GT(result.distance, 0.1);
  EXPECT_LE(result.distance, 0.3);
  EXPECT_EQ(narrow_phase.distance(*A, *B, X_AB, 0.31).certainty, Certainty::EXACT);
}

// To be at the limit means to touch: the search ends early only where the distance is certainly
// beyond.
TEST(ConvexDistance, WhatIsAtTheLimitIsNotBeyondIt) {
  RandomInputs random;
  NarrowPhase narrow_phase;
  const auto A = prepareShape(Box{{2e4, 2e4, 2e4}}), B = prepareShape(Cylinder{1e-3, 1e-3});
  for (int i = 0; i < 1000; ++i) {
    Eigen::Isometry3d X_AB = random.pose(100.0);
    X_AB.translation().x() += 1e4 + 200.0;
    const double limit = narrow_phase.distance(*A, *B, X_AB, INF).distance;
    ASSERT_NE(narrow_phase.distance(*A, *B, X_AB, limit).certainty, Certainty::BEYOND) << i;
    const double below = std::nextafter(limit, 0.0);
    const PairDistance beyond = narrow_phase.distance(*A, *B, X_AB, below);
    ASSERT_EQ(beyond.certainty, Certainty::BEYOND) << i;
    ASSERT_GT(beyond.distance, below) << i;
  }
}

TEST(ConvexDistance, DepthFromAnOverlapIsTheDepth) {
  RandomInputs random;
  const auto randomHull = [&] {
    std::vector<Eigen::Vector3d> points(60);
    for (auto& p : points) p = random.vector(-0.1, 0.1);
    return convexHull(points);
  };
  const auto coreOf = [](const ConvexHull& hull) {
    ConvexCore core;
    core.kind = ConvexCore::Kind::POINTS;
    core.points = hull.points.vertices.data();
    core.nb_points = static_cast<int>(hull.points.vertices.size());
    core.extent = 0.2;
    core.edges = &hull.points;
    return core;
  };
  int overlaps = 0;
  for (int i = 0; i < 300; ++i) {
    const ConvexHull a = randomHull(), b = randomHull();
    const ConvexCore A = coreOf(a), B = coreOf(b);
    const Eigen::Isometry3d X_AB = random.pose(0.15);
    CoreOverlap overlap;
    const PairDistance gap = convexGap(A, B, X_AB, INF, 0.0, &overlap);
    const PairDistance whole = convexDistance(A, B, X_AB, INF);
    ASSERT_EQ(overlap.found(), gap.touches());
    if (!overlap.found()) continue;
    const PairDistance depth = convexDepth(A, B, X_AB, overlap, 0.0);
    ASSERT_NEAR(depth.distance, whole.distance, 1e-15);
    ASSERT_TRUE(depth.nhat_AB_A.isApprox(whole.nhat_AB_A, 1e-12));
    // Where a plane keeps the two apart after all, it is the distance.
    const Eigen::Isometry3d X_apart = Eigen::Translation3d(1.0, 0.0, 0.0) * X_AB;
    const double apart = convexDistance(A, B, X_apart, INF).distance;
    ASSERT_NEAR(convexDepth(A, B, X_apart, CoreOverlap(), 0.0).distance, apart, 1e-15);
    ++overlaps;
  }
  EXPECT_GT(overlaps, 50);
}

// A triangle that is almost, but not quite, across an axis of the coordinates.
TEST(Simplex, TheClosestPointOfATriangleIsAsAccurateHoweverItIsTurned) {
  RandomInputs random;
  for (int i = 0; i < 3000; ++i) {
    const int axis = i % 3;
    std::array<Eigen::Vector3d, 3> w;
    const Eigen::Vector3d tilt = std::pow(10.0, random.uniform(-15.0, -1.0)) *
                                 Eigen::Vector3d::Unit((axis + random.integer(1, 2)) % 3);
    const Eigen::AngleAxisd turn(tilt.norm(), tilt.normalized());
    const double height = random.uniform(0.1, 1.0);
    for (int k = 0; k < 3; ++k) {
      const double angle = 2.0 * M_PI * (k + random.uniform(-0.2, 0.2)) / 3.0;
      w[k][axis] = height;
      w[k][(axis + 1) % 3] = std::cos(angle);
      w[k][(axis + 2) % 3] = std::sin(angle);
      w[k] = turn * w[k];
    }
    const auto share = simplex_detail::closestOnTriangle<double>(w);
    const Eigen::Vector3d found = share[0] * w[0] + share[1] * w[1] + share[2] * w[2];
    const Eigen::Vector3d foot = turn * Eigen::Vector3d(height * Eigen::Vector3d::Unit(axis));
    ASSERT_LT((found - foot).norm(), 1e-14) << tilt.transpose();
  }
}

TEST(ConvexDistance, OfParallelFacesTheDeepestPointsAreTheDepthApart) {
  RandomInputs random;
  NarrowPhase narrow_phase;
  const auto A = prepareShape(Convex{std::make_shared<TriangleMesh>(boxMesh({0.3, 0.2, 0.4}))});
  const auto B = prepareShape(Convex{std::make_shared<TriangleMesh>(boxMesh({0.2, 0.3, 0.3}))});
  for (int i = 0; i < 300; ++i) {
    Eigen::Isometry3d X_AB = Eigen::Isometry3d::Identity();
    X_AB.translation() = random.vector(-0.4, 0.4);
    const PairDistance found = narrow_phase.distance(*A, *B, X_AB, INF);
    ASSERT_LT(found.distance, 0.0);
    const Eigen::Vector3d apart = found.p_ACb - found.p_ACa;
    ASSERT_LT((apart - found.distance * found.nhat_AB_A).norm(), 1e-12) << i;
    ASSERT_LT(((found.p_ACa.cwiseAbs() - Eigen::Vector3d(0.3, 0.2, 0.4)).maxCoeff()), 1e-12);
    const Eigen::Vector3d p_BCb = found.p_ACb - X_AB.translation();
    ASSERT_LT((p_BCb.cwiseAbs() - Eigen::Vector3d(0.2, 0.3, 0.3)).maxCoeff(), 1e-12);
  }
}

TEST(CubeCells, ADirectionIsNearTheCentreOfItsCell) {
  RandomInputs random;
  for (int i = 0; i < 20000; ++i) {
    const Eigen::Vector3d d =
        random.uniform(1e-9, 1e9) * (random.rotation() * Eigen::Vector3d::UnitX());
    const int cell = cubeCell<double>(d);
    ASSERT_GE(cell, 0);
    ASSERT_LT(cell, NUM_CUBE_CELLS);
    ASSERT_GT(d.normalized().dot(cubeCellCenter(cell).normalized()), std::cos(0.18));
  }
}

TEST(CubeCells, WhatIsNoDirectionHasACellToo) {
  const double nan = std::nan("");
  for (const double x : {0.0, 1e-320, 1.0, INF, nan}) {
    for (const double y : {0.0, -1e-320, 1.0, -INF, nan}) {
      for (const double z : {0.0, 1e-320, -1.0, INF, nan}) {
        const int cell = cubeCell<double>({x, y, z});
        EXPECT_TRUE(cell >= 0 && cell < NUM_CUBE_CELLS) << x << ' ' << y << ' ' << z;
      }
    }
  }
}

void expectSupportOfAll(const ConvexHull& hull, const std::vector<Eigen::Vector3d>& points,
                        RandomInputs& random) {
  ASSERT_FALSE(hull.points.neighbours.empty());
  ConvexCore core;
  core.kind = ConvexCore::Kind::POINTS;
  core.points = hull.points.vertices.data();
  core.nb_points = static_cast<int>(hull.points.vertices.size());
  core.edges = &hull.points;
  for (int i = 0; i < 2000; ++i) {
    const Eigen::Vector3d d = random.rotation() * Eigen::Vector3d::UnitX();
    double best = -INF;
    for (const Eigen::Vector3d& p : points) best = std::max(best, p.dot(d));
    ASSERT_NEAR(support<double>(core, d).dot(d), best, 1e-15);
  }
}

TEST(ConvexHullOfManyPoints, ClimbsToTheSameSupportPointAsLookingAtAll) {
  RandomInputs random;
  std::vector<Eigen::Vector3d> points;
  for (int i = 0; i < 2000; ++i) {
    points.push_back(random.uniform(0.5, 1.0) * (random.rotation() * Eigen::Vector3d::UnitX()));
  }
  expectSupportOfAll(convexHull(points), points, random);
}

TEST(ConvexHullOfFewPoints, WithoutVolumeIsTheseWithoutDuplicates) {
  const Eigen::Vector3d a(0.1, 0.2, 0.3), b(0.5, 0.2, 0.3), c(0.1, 0.9, 0.3), d(0.7, 0.8, 0.3);
  using Points = std::vector<Eigen::Vector3d>;
  for (const Points& points : {Points{a}, Points{a, b}, Points{a, c, b}, Points{a, c, d, b}}) {
    Points twice = points;
    twice.insert(twice.end(), points.begin(), points.end());
    const ConvexHull hull = convexHull(twice);
    EXPECT_EQ(hull.volume, 0.0);
    EXPECT_TRUE(hull.faces.empty());
    EXPECT_TRUE(std::is_permutation(points.begin(), points.end(), hull.points.vertices.begin(),
                                    hull.points.vertices.end()));
  }
}

// Of a face with more than three corners no corner may be lost. Beside the faces of the prism the
// dome over it has triangles.
TEST(ConvexHullOfManyPoints, OfAPrismUnderADomeKeepsTheCornersOfThePrism) {
  RandomInputs random;
  std::vector<Eigen::Vector3d> points;
  constexpr int SIDES = 64;
  for (int i = 0; i < SIDES; ++i) {
    const double angle = 2.0 * M_PI * i / SIDES;
    for (const double z : {-0.5, 0.0}) points.emplace_back(std::cos(angle), std::sin(angle), z);
  }
  const std::size_t nb_of_prism = points.size();
  for (int i = 0; i < 200; ++i) {
    Eigen::Vector3d p = 0.9 * (random.rotation() * Eigen::Vector3d::UnitX());
    p.z() = std::abs(p.z());
    points.push_back(p);
  }
  const ConvexHull hull = convexHull(points);
  expectSupportOfAll(hull, points, random);
  const double of_prism = 0.5 * 0.5 * SIDES * std::sin(2.0 * M_PI / SIDES);
  EXPECT_GT(hull.volume, of_prism);
  points.resize(nb_of_prism);
  EXPECT_NEAR(convexHull(points).volume, of_prism, 1e-12);
}

// Else the calls of others to libqhull_r, geometric_shapes among them, would end the process
// (test_qhullcpp_loaded).
TEST(ConvexHullOfManyPoints, PutsNoOtherLibraryBeforeThatOfQhullInC) {
  convexHull({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}});
  Dl_info info;
  void* const symbol = dlsym(RTLD_DEFAULT, "qh_fprintf");
  ASSERT_NE(symbol, nullptr);
  ASSERT_NE(dladdr(symbol, &info), 0);
  EXPECT_NE(std::string(info.dli_fname).find("libqhull_r"), std::string::npos) << info.dli_fname;
}

}  // namespace collision_pairs::test_convex_distance
