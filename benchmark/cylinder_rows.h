// Pairs with a cylinder that are hard to measure: the rows of a table of docs/accuracy.md. What
// they are judged by knows neither FCL nor the code under test.
#pragma once

#include <functional>

#include "accuracy_rows.h"
#include "certified_depth.h"
#include "collision_pairs/aabb.h"

namespace collision_pairs {

struct PosedPair {
  Shape a, b;
  Eigen::Isometry3d X_AB;
};

struct CylinderRow {
  std::string name;
  std::function<PosedPair(RandomInputs&, int)> make;  ///< the i-th pair
};

/// The largest extent, metres.
inline double extentOf(const Shape& shape) {
  const Aabb box = computeAabb(shape, Eigen::Isometry3d::Identity());
  return (box.max - box.min).maxCoeff();
}

inline double logUniform(RandomInputs& random, double low, double high) {
  return std::pow(10.0, random.uniform(low, high));
}

inline Eigen::Vector3d randomDirection(RandomInputs& random) {
  return random.rotation() * Eigen::Vector3d::UnitX();
}

/// Axes that enclose 1e-16 to 0.3 rad, or none; centres 1e-16 to 3e-2 m beside each other's axis,
/// or on it, and up to 0.1 m along it.
inline std::vector<CylinderRow> coaxialRows() {
  std::vector<CylinderRow> rows;
  for (const std::string kind : {"cylinder", "box", "capsule", "convex"}) {
    rows.push_back({"coaxial cylinder-" + kind, [kind](RandomInputs& random, int i) {
                      PosedPair pair{randomShape(random, "cylinder"), randomShape(random, kind),
                                     Eigen::Isometry3d::Identity()};
                      const double tilt = i % 7 == 0 ? 0.0 : logUniform(random, -16.0, -0.5);
                      const Eigen::Vector3d across =
                          Eigen::AngleAxisd(random.uniform(-3.0, 3.0), Eigen::Vector3d::UnitZ()) *
                          Eigen::Vector3d::UnitX();
                      pair.X_AB.linear() =
                          (Eigen::AngleAxisd(tilt, across) *
                           Eigen::AngleAxisd(random.uniform(-3.0, 3.0), Eigen::Vector3d::UnitZ()))
                              .toRotationMatrix();
                      const double beside = i % 5 == 0 ? 0.0 : logUniform(random, -16.0, -1.5);
                      const double along = i % 3 == 0 ? 0.0 : random.uniform(-0.1, 0.1);
                      const double angle = random.uniform(-3.0, 3.0);
                      pair.X_AB.translation() = Eigen::Vector3d(beside * std::cos(angle),
                                                                beside * std::sin(angle), along);
                      return pair;
                    }});
  }
  return rows;
}

/// Shifted by 1e-16 to 3e-2 m, and rotated by 1e-16 to 0.1 rad too.
inline std::vector<CylinderRow> uponItselfRows() {
  const auto row = [](const char* name, bool rotated, bool as_long_as_thick) {
    return CylinderRow{
        name, [=](RandomInputs& random, int) {
          Shape a = randomShape(random, "cylinder");
          if (as_long_as_thick) a = Cylinder{0.1, 0.2};
          PosedPair pair{a, a, Eigen::Isometry3d::Identity()};
          const double angle = rotated ? logUniform(random, -16.0, -1.0) : 0.0;
          pair.X_AB.linear() = Eigen::AngleAxisd(angle, randomDirection(random)).toRotationMatrix();
          pair.X_AB.translation() = logUniform(random, -16.0, -1.5) * randomDirection(random);
          return pair;
        }};
  };
  return {row("cylinder upon itself, shifted", false, false),
          row("cylinder upon itself, shifted and rotated", true, false),
          row("the same, as long as thick", true, true)};
}

/// The larger body `ratio` times 0.2 m; a quarter each up to 1 m apart, 1e-16 to 0.1 m apart or
/// deep, and up to 3 m or a tenth of the larger body deep.
inline std::vector<CylinderRow> mixedRows(double ratio) {
  const auto make = [ratio](const std::string& kind, bool cylinder_is_small, RandomInputs& random,
                            int i) {
    PosedPair pair{scaled(randomShape(random, "cylinder"), cylinder_is_small ? 1.0 : ratio),
                   scaled(randomShape(random, kind), cylinder_is_small ? ratio : 1.0),
                   random.pose(0.0)};
    NarrowPhase narrow_phase;
    const auto A = prepareShape(pair.a), B = prepareShape(pair.b);
    pair.X_AB.translation() = 4.0 * ratio * randomDirection(random);
    double wanted = random.uniform(0.0, 1.0);
    if (i % 4 == 1) wanted = logUniform(random, -16.0, -1.0);
    if (i % 4 == 2) wanted = -logUniform(random, -16.0, -1.0);
    if (i % 4 == 3) wanted = i % 8 == 3 ? -0.1 * ratio * wanted : -3.0 * wanted;
    for (int k = 0; k < 2; ++k) {  // the second time from near, where rounding is less
      const PairDistance found =
          narrow_phase.distance(*A, *B, pair.X_AB, std::numeric_limits<double>::infinity());
      pair.X_AB.translation() += (wanted - found.distance) * found.nhat_AB_A;
      if (i % 4 == 3) break;
    }
    return pair;
  };
  std::vector<CylinderRow> rows;
  for (const bool cylinder_is_small : {false, true}) {
    for (const std::string kind : {"cylinder", "box", "capsule", "convex"}) {
      char name[64];
      std::snprintf(name, sizeof name, "%s cylinder, %s %s, 1 : %g",
                    cylinder_is_small ? "small" : "large", cylinder_is_small ? "large" : "small",
                    kind.c_str(), ratio);
      rows.push_back({name, [=](RandomInputs& random, int i) {
                        return make(kind, cylinder_is_small, random, i);
                      }});
    }
  }
  return rows;
}

/// Plates, needles, discs and wires of aspect 1e6, at all separations of randomPose().
inline std::vector<CylinderRow> thinRows() {
  const auto row = [](const char* name, const Shape& thin) {
    return CylinderRow{name, [=](RandomInputs& random, int i) {
                         PosedPair pair{randomShape(random, "cylinder"), thin, {}};
                         NarrowPhase narrow_phase;
                         pair.X_AB =
                             randomPose(random, narrow_phase, *prepareShape(pair.a),
                                        *prepareShape(pair.b), static_cast<Separation>(i % 5));
                         return pair;
                       }};
  };
  return {row("cylinder, plate 1 : 1e6", Box{{1.0, 1e-6, 1.0}}),
          row("cylinder, needle 1 : 1e6", Box{{1e-6, 1e-6, 1.0}}),
          row("cylinder, disc 1 : 1e6", Cylinder{0.5, 1e-6}),
          row("cylinder, wire 1 : 1e6", Cylinder{5e-7, 1.0})};
}

/// Flat and thin bodies, 1e-14 to 1e-6 of their size deep in each other or apart, or at random.
inline PosedPair sliverPair(RandomInputs& random, NarrowPhase& narrow_phase, int i) {
  const auto thin = [&] { return logUniform(random, -7.0, -0.5); };
  const auto any = [&](int kind) -> Shape {
    if (kind == 0) return Cylinder{0.5 * thin(), random.uniform(0.1, 1.0)};
    if (kind == 1) return Cylinder{random.uniform(0.1, 0.5), thin()};
    if (kind == 2) return Box{{random.uniform(0.1, 1.0), thin(), thin()}};
    if (kind == 3) return Box{{random.uniform(0.1, 1.0), random.uniform(0.1, 1.0), thin()}};
    if (kind == 4) return Capsule{0.5 * thin(), random.uniform(0.1, 1.0)};
    return randomShape(random, "convex");
  };
  PosedPair pair{any(random.integer(0, 1)), any(random.integer(0, 5)), random.pose(0.3)};
  if (i % 2) std::swap(pair.a, pair.b);
  if (i % 3 == 0) return pair;
  const auto A = prepareShape(pair.a), B = prepareShape(pair.b);
  const PairDistance found =
      narrow_phase.distance(*A, *B, pair.X_AB, std::numeric_limits<double>::infinity());
  const double size = std::min(extentOf(pair.a), extentOf(pair.b));
  const double wanted = (i % 3 == 1 ? 1.0 : -1.0) * logUniform(random, -14.0, -6.0) * size;
  pair.X_AB.translation() += (wanted - found.distance) * found.nhat_AB_A;
  return pair;
}

/// Metres. Upper bounds of the true errors.
struct CylinderError {
  bool wrong_verdict = false;
  double distance = 0.0;
  double depth = 0.0;    ///< of a touching pair
  double witness = 0.0;  ///< as in AnswerError
};

/// The depth is closed in to `tolerance` (metres), or as far as so many cones of directions do. No
/// verdict within 1e-9 of the smaller body's size of touching is wrong.
inline CylinderError judgeCylinder(const PosedPair& pair, const PairDistance& result,
                                   double tolerance, int max_cones) {
  const OracleBody A = oracleBody(pair.a), B = oracleBody(pair.b);
  const double size_a = extentOf(pair.a), size_b = extentOf(pair.b);
  // A gap of 1e-15 of the coordinates is contact (docs/accuracy.md).
  const double of_coordinates =
      1e-15 * (2.0 * (size_a + size_b) + pair.X_AB.translation().lpNorm<1>());
  const double band = std::max(1e-9 * std::min(size_a, size_b), of_coordinates);
  CylinderError error;
  if (result.distance > 0.0) {
    const AnswerError apart = judge(A, B, pair.X_AB, result, band);
    error.wrong_verdict = apart.wrong_verdict;
    error.distance = apart.distance;
    error.witness = apart.witness;
    return error;
  }
  const V3<Exact> n = cast<Exact>(result.nhat_AB_A);
  const auto known = static_cast<long double>(height(A, B, pair.X_AB, n));
  const DepthInterval depth = CertifiedDepth(A, B, pair.X_AB).run(tolerance, max_cones, known);
  error.wrong_verdict = depth.upper < -band;
  // What touches is at least 0 deep.
  const auto lower = std::max(static_cast<double>(depth.lower), 0.0);
  error.depth =
      std::max(-result.distance - lower, static_cast<double>(depth.upper) + result.distance);
  error.witness = checkWitnesses(A, B, pair.X_AB, result).error(result.distance);
  return error;
}

}  // namespace collision_pairs
