// Convex shapes a hair from contact, beside an oracle of 100 digits: one definition of contact for
// yes or no and for the distance, and distances as accurate as docs/accuracy.md says, at any sizes.
#include <gtest/gtest.h>

#include "close_pairs.h"
#include "closed_forms.h"
#include "cube_cells.h"
#include "double_double.h"
#include "epa.h"
#include "test_shapes.h"

namespace collision_pairs::test_convex_contact {

using Eigen::Isometry3d;
using Eigen::Vector3d;
constexpr double INF = std::numeric_limits<double>::infinity();

bool isLong() { return std::getenv("COLLISION_PAIRS_LONG") != nullptr; }

void expectRight(const ClosePair& pair, const std::string& about) {
  const CloseAnswer answer = ask(pair);
  ASSERT_FALSE(answer.wrong_verdict) << about << ", said " << answer.found.distance;
  ASSERT_FALSE(answer.contradiction) << about << ", said " << answer.found.distance;
  ASSERT_LE(answer.error, pair.goal()) << about << ", said " << answer.found.distance;
  ASSERT_NE(answer.found.certainty, Certainty::DEGRADED) << about;
}

TEST(ConvexContact, YesOrNoAndDistanceAreRightAHairFromContactAtAnySizesAndOffsets) {
  RandomInputs random;
  const int nb_pairs = isLong() ? 1000000 : 1000;
  for (int i = 0; i < nb_pairs; ++i) {
    const auto kind = [&] { return convexKinds()[static_cast<std::size_t>(random.integer(0, 4))]; };
    const std::string a = kind(), b = kind();
    const double ratio = std::pow(10.0, random.integer(0, 1) ? random.uniform(0.0, 12.0) : 0.0);
    const double offset = random.integer(0, 1) ? std::pow(10.0, random.uniform(0.0, 8.0)) : 0.0;
    const ClosePair pair = closePair(random, a, b, ratio, offset);
    ASSERT_NO_FATAL_FAILURE(expectRight(pair, a + "-" + b + " pair " + std::to_string(i)));
  }
}

// Sizes and signed distances at which boxes were FREE in an overlap, or EXACT and wrong.
TEST(ConvexContact, Issue30Regression_BoxesOfVeryDifferentSizes) {
  RandomInputs random;
  struct Case {
    double larger, smaller, distance;
  };
  for (const Case& c :
       {Case{11650.0, 0.157, -3.8e-10}, Case{1340.0, 1.4e-3, -8.6e-12}, Case{24.2, 3.3e-4, 1.3e-15},
        Case{337e3, 0.32, 1.1e-11}, Case{100.0, 1e-4, 8.7e-12}, Case{20.0, 2e-5, 2.9e-13}}) {
    for (int i = 0; i < 20; ++i) {
      for (const std::string kind : {"box", "convex"}) {
        ClosePair pair{scaled(randomShape(random, "box"), c.smaller / 0.2),
                       scaled(randomShape(random, kind), c.larger / 0.2),
                       {}};
        if (i % 2) std::swap(pair.a, pair.b);
        placeClose(random, c.distance, 0.0, pair);
        ASSERT_NO_FATAL_FAILURE(expectRight(pair, kind + " of " + std::to_string(c.larger)));
      }
    }
  }
}

/// All shapes that reach exactly to 0.5 along x, and their hulls of eight corners.
std::vector<Shape> halfAMetreAlongX(double size) {
  auto cube = std::make_shared<TriangleMesh>(boxMesh(Vector3d::Constant(0.5 * size)));
  return {Box{Vector3d::Constant(size)}, Sphere{0.5 * size}, Cylinder{0.5 * size, size},
          Capsule{0.5 * size, size}, Convex{cube}};
}

TEST(ConvexContact, WhatTouchesTouchesOneRoundingFurtherAndAFewBandsFurtherItDoesNot) {
  NarrowPhase narrow_phase;
  for (const double size : {0x1p-20, 1.0, 0x1p20}) {
    for (const double ratio : {1.0, 0x1p-10, 0x1p-30}) {
      for (const Shape& a : halfAMetreAlongX(size)) {
        for (const Shape& b : halfAMetreAlongX(size * ratio)) {
          SCOPED_TRACE(std::string(shapeName(a)) + "-" + shapeName(b) + " " +
                       std::to_string(ratio));
          const auto A = prepareShape(a), B = prepareShape(b);
          Isometry3d X_AB = Isometry3d::Identity();
          const double touch = 0.5 * (size + size * ratio);
          X_AB.translation().x() = touch;
          const PairDistance found = narrow_phase.distance(*A, *B, X_AB, INF);
          EXPECT_EQ(found.distance, 0.0);
          EXPECT_EQ(found.certainty, Certainty::EXACT);
          EXPECT_TRUE(narrow_phase.touches(*A, *B, X_AB));
          X_AB.translation().x() = std::nextafter(touch, INF);
          EXPECT_EQ(narrow_phase.distance(*A, *B, X_AB, INF).distance, 0.0);
          EXPECT_TRUE(narrow_phase.touches(*A, *B, X_AB));
          const double gap = 0x1p-46 * size;
          X_AB.translation().x() = touch + gap;
          EXPECT_NEAR(narrow_phase.distance(*A, *B, X_AB, INF).distance, gap, 0.25 * gap);
          EXPECT_FALSE(narrow_phase.touches(*A, *B, X_AB));
        }
      }
    }
  }
}

TEST(ConvexContact, AFloorAndWhatStandsOnItTouchWithinTheBandAndNotBeyondIt) {
  NarrowPhase narrow_phase;
  const auto floor = prepareShape(HalfSpace{});
  RandomInputs random;
  for (int i = 0; i < 2000; ++i) {
    const Shape shape = randomShape(random, convexKinds()[static_cast<std::size_t>(i % 5)]);
    const auto B = prepareShape(shape);
    Isometry3d X_AB = random.pose(1.0);
    for (int k = 0; k < 2; ++k) {
      X_AB.translation().z() -= narrow_phase.distance(*floor, *B, X_AB, INF).distance;
    }
    X_AB.translation().z() += std::pow(10.0, random.uniform(-18.0, -13.0));
    const OracleBody body = oracleBody(shape);
    V3<Digits> down;
    for (int k = 0; k < 3; ++k) down[k] = -Digits(X_AB.linear()(2, k));
    const bool is_round =
        std::holds_alternative<Sphere>(shape) || std::holds_alternative<Capsule>(shape);
    if (is_round) continue;  // their radius is not moved by the pose, but reach() moves it
    const Digits truth = X_AB.translation().z() - reach(body, down);
    const PairDistance found = narrow_phase.distance(*floor, *B, X_AB, INF);
    const double size = sizeOf(shape), most = 2.0 * size + X_AB.translation().lpNorm<1>();
    if (truth <= Digits(1e-15 * size)) {
      ASSERT_TRUE(found.touches()) << i << ' ' << found.distance;
    } else if (truth > Digits(1e-15 * most)) {
      ASSERT_FALSE(found.touches()) << i << ' ' << found.distance;
    }
    ASSERT_EQ(narrow_phase.touches(*floor, *B, X_AB), found.touches());
  }
}

/// Two thin rods end to end, along one axis of A, some roundings from contact.
ClosePair rodsEndToEnd(RandomInputs& random) {
  ClosePair pair;
  const int axis = random.integer(0, 2);
  const auto rod = [&] {
    Vector3d size = std::pow(10.0, random.uniform(-10.0, -3.0)) * random.vector(0.1, 1.0);
    size[axis] = random.uniform(0.1, 2.0);
    return size;
  };
  const Vector3d a = rod(), b = rod();
  pair.a = Box{a}, pair.b = Box{b};
  const Vector3d about = Vector3d::Unit(axis) + 1e-9 * random.vector(-1.0, 1.0);
  pair.X_AB = Eigen::AngleAxisd(random.uniform(-3.0, 3.0), about.normalized());
  pair.X_AB.translation() = 1e-11 * random.vector(-1.0, 1.0);
  pair.X_AB.translation()[axis] =
      0.5 * (a[axis] + b[axis]) * (1.0 + random.integer(-4, 4) * 1.2e-16);
  if (random.integer(0, 1)) pair.X_AB.translation()[axis] *= -1.0;
  return pair;
}

TEST(BoxesTouch, IsSureOfNothingThatIsNotTrueInExactArithmetic) {
  RandomInputs random;
  int nb_sure = 0, nb_told = 0;
  for (int i = 0; i < 2000; ++i) {
    const ClosePair pair = i % 2 == 0 ? rodsEndToEnd(random) : closePair(random, "box", "box", 1.0);
    const double band = i % 4 < 2 ? 0.0 : 1e-15 * pair.larger();
    const Vector3d half_a = 0.5 * std::get<Box>(pair.a).size;
    const Vector3d half_b = 0.5 * std::get<Box>(pair.b).size;
    const auto told = boxesTouch(half_a, half_b, pair.X_AB, band);
    const DistanceInterval truth = ExactDistance::of(
        oracleBody(pair.a), oracleBody(pair.b), pair.X_AB, Digits(pair.larger()) * Digits(1e-34));
    if (truth.lower > Digits(1e-12 * pair.larger())) {
      ASSERT_EQ(told, std::optional<bool>(false)) << i;
      ++nb_sure;
    }
    if (!told) continue;
    ++nb_told;
    if (*told) {
      ASSERT_TRUE(truth.touches()) << i << ' ' << truth.lower;
    } else {
      ASSERT_GT(truth.lower, Digits(band)) << i;
    }
  }
  EXPECT_GT(nb_sure, 100);
  EXPECT_GT(nb_told, 100);
}

// With a margin it is the distance that decides, and nothing beside it.
TEST(ConvexContact, AMarginIsKeptIfAndOnlyIfTheDistanceIsNotMore) {
  RandomInputs random;
  NarrowPhase narrow_phase;
  for (int i = 0; i < 1000; ++i) {
    const auto kind = [&] { return convexKinds()[static_cast<std::size_t>(random.integer(0, 4))]; };
    ClosePair pair = closePair(random, kind(), kind(), std::pow(10.0, random.integer(0, 6)));
    pair.X_AB.translation() *= 1.0 + std::pow(10.0, random.uniform(-14.0, 0.0));
    const auto A = prepareShape(pair.a), B = prepareShape(pair.b);
    const double distance = narrow_phase.distance(*A, *B, pair.X_AB, INF).distance;
    if (distance <= 0.0) {
      ASSERT_TRUE(narrow_phase.touches(*A, *B, pair.X_AB, 0.2 * pair.smaller())) << i;
      continue;
    }
    const double below = std::nextafter(distance, 0.0);
    ASSERT_TRUE(narrow_phase.touches(*A, *B, pair.X_AB, distance)) << i;
    ASSERT_FALSE(narrow_phase.touches(*A, *B, pair.X_AB, below)) << i;
    ASSERT_EQ(narrow_phase.distance(*A, *B, pair.X_AB, distance).distance, distance) << i;
    ASSERT_EQ(narrow_phase.distance(*A, *B, pair.X_AB, below).certainty, Certainty::BEYOND) << i;
  }
}

// The depth of two hulls is certain by it. Its plane is moved as far as its vertices may be off.
TEST(ConvexContact, APlaneWhoseVerticesAreOffIsAsFarFromTheOriginAsItsBound) {
  RandomInputs random;
  using Point = Eigen::Matrix<Digits, 3, 1>;
  int nb_bounds = 0, nb_tight = 0;
  for (int i = 0; i < 4000; ++i) {
    // Of any size, of a mesh of thin triangles, and beside the origin as often as in front of it.
    const double size = std::pow(10.0, random.uniform(-6.0, 3.0));
    const double thin = std::pow(10.0, random.uniform(-14.0, 0.0));
    const Vector3d p = size * random.vector(-1.0, 1.0);
    const Vector3d q = p + size * random.vector(-1.0, 1.0);
    const Vector3d r =
        p + random.uniform(-1.0, 1.0) * (q - p) + size * thin * random.vector(-1.0, 1.0);
    const double largest = std::max({p.norm(), q.norm(), r.norm()});
    const double rounding = 20.0 * std::numeric_limits<double>::epsilon() * largest;
    const double bound = leastPlaneDistance<double>(p, q, r, rounding);
    if (!std::isfinite(bound)) continue;
    ++nb_bounds;
    const Vector3d n = (q - p).cross(r - p).normalized();
    const Vector3d along = (q - p).normalized();
    const auto distance = [](const Point& a, const Point& b, const Point& c) {
      const Point normal = Point(b - a).cross(Point(c - a));
      return Digits(a.dot(normal) / sqrt(normal.squaredNorm()));
    };
    const auto exact = [](const Vector3d& v) { return Point(v.cast<Digits>()); };
    const Digits here = distance(exact(p), exact(q), exact(r));
    Digits least = here;
    for (int k = 0; k < 32; ++k) {
      const auto moved = [&](const Vector3d& vertex) {
        const Vector3d by = k < 16 ? n : k < 24 ? along : random.vector(-1.0, 1.0).normalized();
        return Point(exact(vertex) + exact((random.integer(0, 1) ? rounding : -rounding) * by));
      };
      least = std::min(least, distance(moved(p), moved(q), moved(r)));
    }
    ASSERT_LE(Digits(bound), least) << i;
    nb_tight += here - bound < 8 * (here - least);
  }
  EXPECT_GT(nb_bounds, 1000);
  EXPECT_GT(nb_tight, nb_bounds / 2) << nb_bounds;
}

// Such a direction once read beyond the table of start vertices.
TEST(DoubleDouble, DirectionsAHairFromTheBorderOfACellAreInOne) {
  const DoubleDouble hair = 0x1p-80;
  for (int axis = 0; axis < 3; ++axis) {
    for (const double sign : {-1.0, 1.0}) {
      using Direction = Eigen::Matrix<DoubleDouble, 3, 1>;
      Direction d = Direction::Constant(DoubleDouble(1.0) - hair);
      Eigen::Vector3d beside = Eigen::Vector3d::Constant(1.0 - 0x1p-40);
      d[axis] = beside[axis] = sign;
      EXPECT_EQ(cubeCell<DoubleDouble>(d), cubeCell<double>(beside));
    }
  }
}

TEST(DoubleDouble, IsAsAccurateAsItsEpsilonSays) {
  RandomInputs random;
  const auto exact = [](const DoubleDouble& x) {
    const auto high = static_cast<double>(x);
    return Digits(high) + static_cast<double>(x - DoubleDouble(high));
  };
  const auto number = [&] {
    const double scale = std::pow(10.0, random.uniform(-20.0, 20.0));
    return DoubleDouble(random.uniform(-1.0, 1.0) * scale) +
           DoubleDouble(random.uniform(-1e-16, 1e-16) * scale);
  };
  const Digits epsilon = exact(std::numeric_limits<DoubleDouble>::epsilon());
  for (int i = 0; i < 20000; ++i) {
    const DoubleDouble x = number();
    const DoubleDouble y =
        i % 2 ? number() : -x * DoubleDouble(1.0 + random.uniform(-1e-15, 1e-15));
    const auto expectNear = [&](const DoubleDouble& found, const Digits& truth) {
      ASSERT_LE(abs(exact(found) - truth), epsilon * abs(truth)) << i;
    };
    expectNear(x + y, exact(x) + exact(y));
    expectNear(x - y, exact(x) - exact(y));
    expectNear(x * y, exact(x) * exact(y));
    expectNear(x / y, exact(x) / exact(y));
    expectNear(sqrt(abs(x)), sqrt(abs(exact(x))));
    ASSERT_EQ(x < y, exact(x) < exact(y));
    ASSERT_EQ(x <= y, exact(x) <= exact(y));
  }
}

}  // namespace collision_pairs::test_convex_contact
