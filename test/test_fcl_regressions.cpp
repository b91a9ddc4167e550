// Configurations published because FCL answers them wrongly, throws or aborts. Numbers from the
// issues of flexible-collision-library/fcl; the truth from the oracle.
#include <gtest/gtest.h>

#include "signed_distance_oracle.h"

namespace collision_pairs::test_fcl_regressions {

constexpr double INF = std::numeric_limits<double>::infinity();

Eigen::Isometry3d pose(std::initializer_list<double> rows) {
  Eigen::Isometry3d X = Eigen::Isometry3d::Identity();
  auto value = rows.begin();
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 4; ++j) X(i, j) = *value++;
  }
  return X;
}

Eigen::Isometry3d at(double x, double y, double z) {
  return pose({1, 0, 0, x, 0, 1, 0, y, 0, 0, 1, z});
}

// The questions that FCL is asked here do not lead to what was published. Nearer to touching than
// the tolerance, its yes or no and its distance come from different algorithms.
void holdTruthByFcl(const Shape& a, const Shape& b, const Eigen::Isometry3d& X_AB,
                    double tolerance) {
  constexpr auto FCL = NarrowPhaseMethod::FCL;
  NarrowPhase narrow_phase;
  const auto A = prepareShape(a, FCL), B = prepareShape(b, FCL);
  const PairDistance result = narrow_phase.distance(*A, *B, X_AB, INF);
  const AnswerError error = judge(oracleBody(a), oracleBody(b), X_AB, result, tolerance);
  EXPECT_FALSE(error.wrong_verdict);
  EXPECT_LE(error.distance, std::max(tolerance, 1e-7));
  const bool sure = std::abs(result.distance) > tolerance;
  EXPECT_TRUE(!sure || narrow_phase.touches(*A, *B, X_AB) == result.touches());
}

PairDistance holdTruth(const Shape& a, const Eigen::Isometry3d& X_WA, const Shape& b,
                       const Eigen::Isometry3d& X_WB, double tolerance) {
  const Eigen::Isometry3d X_AB = X_WA.inverse() * X_WB;
  NarrowPhase narrow_phase;
  const auto A = prepareShape(a), B = prepareShape(b);
  const PairDistance result = narrow_phase.distance(*A, *B, X_AB, INF);
  const AnswerError error = judge(oracleBody(a), oracleBody(b), X_AB, result, tolerance);
  EXPECT_FALSE(error.wrong_verdict);
  EXPECT_LE(error.distance, tolerance);
  EXPECT_LE(error.normal, tolerance);
  EXPECT_NEAR(result.nhat_AB_A.norm(), 1.0, 1e-12);
  EXPECT_EQ(narrow_phase.numDegraded(), 0U);
  holdTruthByFcl(a, b, X_AB, tolerance);
  return result;
}

const Eigen::Isometry3d X_WB_POST = pose({6.1232339957367660359e-17, -1, 0, 0.8, 1,
                                          6.1232339957367660359e-17, 0, -0.4575, 0, 0, 1, 1.0225});

TEST(FclRegressions, Issue319RegressionBoxAndCylinder) {
  Eigen::Isometry3d X_WA = at(0.8, -0.385, 0.735), X_WB = at(0.4, -0.4, 0.93);
  X_WA.linear() = Eigen::Quaterniond(0.707107, 0, 0, 0.707107).normalized().toRotationMatrix();
  X_WB.linear() = Eigen::Quaterniond(0.991445, 0, 0, -0.130526).normalized().toRotationMatrix();
  const Shape box = Box{{0.05, 0.39, 1.47}}, cylinder = Cylinder{0.18, 0.18};
  EXPECT_FALSE(holdTruth(box, X_WA, cylinder, X_WB, 1e-9).touches());
}

TEST(FclRegressions, Issue319RegressionCylinderAgainstAPost) {
  const Eigen::Isometry3d X_WA =
      pose({-0.99999999997999022838, 6.2572835802045040178e-10, 6.3260669852976095481e-06,
            0.57500009756757608503, 6.3260669851683709551e-06, -6.3943303429958554955e-10,
            0.99999999997999056145, -0.42711963046787942977, 6.2573180158128459924e-10, 1,
            6.3942912945996747041e-10, 1.1867093358746836351});
  holdTruth(Cylinder{0.05, 0.06}, X_WA, Box{{0.025, 0.35, 1.845}}, X_WB_POST, 1e-9);
}

TEST(FclRegressions, Issue390RegressionTiltedCylinderAgainstAPost) {
  const Eigen::Isometry3d X_WA =
      pose({-0.97313010759279283679, -0.12202804064972551379, 0.19526123781136842106,
            0.87472781461138560122, 0.20950801135757171623, -0.11745920593569325607,
            0.97072639199619581429, -0.4038687881347159947, -0.095520609678929752073,
            0.98555187191549953329, 0.13986894183635001365, 1.5871328698116491385});
  holdTruth(Cylinder{0.05, 0.06}, X_WA, Box{{0.025, 0.35, 1.845}}, X_WB_POST, 1e-9);
}

TEST(FclRegressions, Issue529RegressionThinCylindersMeetingRimToRim) {
  const double c_a = 0.070736898150081176095, s_a = 0.99749500812791291882;
  const double c_b = 0.070736898153116234411, s_b = 0.99749500812769764657;
  const Eigen::Isometry3d X_WA =
      pose({c_a, 0, -s_a, 0.24874750406395645941, 0, 1, 0, 0, s_a, 0, c_a, -0.5 * c_a});
  const Eigen::Isometry3d X_WB =
      pose({c_b, 0, s_b, -0.24874750406384882329, 0, 1, 0, 0, -s_b, 0, c_b, -0.5 * c_b});
  holdTruth(Cylinder{0.01, 1.0}, X_WA, Cylinder{0.01, 1.0}, X_WB, 1e-8);
}

TEST(FclRegressions, Issue275RegressionWitnessPointsOfSpheres) {
  const PairDistance result = holdTruth(Sphere{20}, at(0, 0, 0), Sphere{10}, at(0, 40, 0), 1e-13);
  EXPECT_DOUBLE_EQ(result.distance, 10.0);
  EXPECT_EQ(result.p_ACa, Eigen::Vector3d(0, 20, 0));
  EXPECT_EQ(result.p_ACb, Eigen::Vector3d(0, 30, 0));
}

TEST(FclRegressions, Issue375RegressionCylinderStandingOnABoxHasANormal) {
  const Eigen::Isometry3d X_WA = pose({0, -1, 0, -0.25, 1, 0, 0, 0, 0, 0, 1, 0});
  const PairDistance result =
      holdTruth(Box{{0.49, 0.63, 0.015}}, X_WA, Cylinder{0.08, 0.002}, at(0, 0, 0.0085), 1e-9);
  EXPECT_NEAR(result.distance, 0.0, 1e-16);
  EXPECT_NEAR(result.nhat_AB_A[2], 1.0, 1e-12);
}

TEST(FclRegressions, Issue388RegressionNearlyParallelBoxes) {
  const Eigen::Isometry3d X_WA =
      pose({-3.0627937852578681533e-08, -0.99999999999999888978, -2.8893865161583314238e-08,
            0.63499979627350811029, 0.9999999999999980016, -3.0627939739957803544e-08,
            6.4729926918527511769e-08, -0.48500002215636439651, -6.4729927722963847085e-08,
            -2.8893863029448751323e-08, 0.99999999999999711342, 1.0778146458339641356});
  holdTruth(Box{{0.03, 0.12, 0.1}}, X_WA, Box{{0.025, 0.35, 1.845}}, X_WB_POST, 1e-13);
}

TEST(FclRegressions, Issue395RegressionTriangleOfNoSize) {
  const Eigen::Isometry3d X_WB =
      pose({0.10758262492983036718, -0.6624881850015212903, -0.74130653817877356637,
            -0.42677133002999478872, 0.22682184885125472595, -0.709614040775253474,
            0.6670830248314786326, -0.76596851247746788882, -0.96797615037608542021,
            -0.23991106241273435495, 0.07392465377049164954, 0.80746731400091054098});
  holdTruth(Box{{0.46, 0.48, 0.01}}, at(-0.721, -0.772, 0.81), Box{{0.049521, 0.146, 0.0725}}, X_WB,
            1e-13);
}

TEST(FclRegressions, Issue398RegressionDeepAlignedBoxes) {
  for (const double thickness : {0.037, 0.37}) {
    const PairDistance result = holdTruth(Box{{0.614, 3, thickness}}, at(-0.675, 0, 0.9115),
                                          Box{{0.494, 0.552, 0.01}}, at(-0.692, 0, 0.935), 1e-13);
    EXPECT_NEAR(result.distance, 0.0235 - thickness / 2 - 0.005, 1e-13);
  }
}

TEST(FclRegressions, Issue399RegressionBoxBesideAPlank) {
  const Eigen::Isometry3d X_WA = pose(
      {-0.099432387353076273628, 0.99504432079443971837, 0, 0.29526406526565551758,
       -0.99504432079443971837, -0.099432387353076273628, 0, -0.013230856508016586304, 0, 0, 1, 0});
  const Eigen::Isometry3d X_WB = pose(
      {0.99506598442099225554, 0.099215354901756730444, 0, 0.22759585694545214629,
       -0.099215354901756730444, 0.99506598442099225554, 0, 0.14974093549228112421, 0, 0, 1, 0});
  holdTruth(Box{{0.23768037557601928711, 0.15702305734157562256, 0.25}}, X_WA,
            Box{{0.01, 0.78165709972381591797, 0.25}}, X_WB, 1e-13);
}

TEST(FclRegressions, Issue408RegressionSphereTouchesABoxEdgeOn) {
  const Eigen::Isometry3d X_WA =
      pose({-0.99999999999999955591, -4.4637642593504144998e-09, 0, 1.7855056639081962376e-10,
            4.4637642593504144998e-09, -0.99999999999999955591, 0, 0.04, 0, 0,
            1.0000000000000008882, 0.33000000000000012657});
  const PairDistance result =
      holdTruth(Sphere{0.06}, X_WA, Box{{0.1, 0.1, 0.1}}, at(0.05, 0.15, 0.35), 1e-13);
  EXPECT_NEAR(result.distance, 0.0, 1e-9);
}

TEST(FclRegressions, Issue415RegressionVertexInLineWithAnEdge) {
  const Eigen::Isometry3d X_WA =
      pose({4.8966386501092529215e-12, -1, 0, -0.44, 1, 4.8966386501092529215e-12, 0,
            -0.61499999999858001587, 0, 0, 1, 0.355});
  const Eigen::Isometry3d X_WB =
      pose({0.83512153565236335595, -0.55006546945762568868, -9.4542360608233572896e-16,
            -0.40653441507331000704, 0.55006546945762568868, 0.83512153565236313391,
            1.1787444236552387666e-15, -0.69166166923735727945, 1.2902271444330665572e-16,
            -1.4878153530113264589e-15, 1, 0.43057093858718892276});
  holdTruth(Box{{0.49, 0.05, 0.21}}, X_WA, Box{{0.035, 0.12, 0.03}}, X_WB, 1e-13);
}

TEST(FclRegressions, Issue428RegressionAlignedBoxes) {
  holdTruth(Box{{0.2, 0.33, 0.1}}, at(-0.071, -0.772, 0.8), Box{{0.452, 0.27, 0.6}},
            at(0.121, -0.78769605692727695523, 0.53422044196125151316), 1e-13);
}

TEST(FclRegressions, Issue493RegressionTiltedCubesKissing) {
  Eigen::Matrix3d R_WF;
  R_WF << 0.94096063217417758029, 0.29296840037289501035, 0.16959541586174811667,
      -0.23569836841299879326, 0.92661523595848427348, -0.29296840037289506586,
      -0.2429801799032638987, 0.23569836841299884878, 0.94096063217417758029;
  for (const double size : {0.01, 0.25, 0.5, 10.0, 1000.0}) {
    for (const double gap : {-1e-15, -1e-16, 0.0, 1e-16, 2.5e-16, 1e-15}) {
      Eigen::Isometry3d X_WA = at(0, 0, 5 * size), X_WB = X_WA;
      X_WA.linear() = X_WB.linear() = R_WF;
      X_WB.translation() += R_WF * Eigen::Vector3d(0, size + gap * std::max(1.0, size), 0);
      const Shape cube = Box{{size, size, size}};
      const PairDistance result = holdTruth(cube, X_WA, cube, X_WB, 1e-13 * size);
      EXPECT_NEAR(std::abs(result.nhat_AB_A[1]), 1.0, 1e-9) << size << " " << gap;
    }
  }
}

TEST(FclRegressions, Issue493RegressionBoxesAsPublished) {
  const Eigen::Isometry3d X_WA =
      pose({0.96193976625564348026, 0.15401279915737359216, 0.22572537250328919556,
            2.0770063995786869349, -0.19134171618254486313, 0.96936494951283913579,
            0.15401279915737359216, 0.48468247475641951239, -0.19509032201612822033,
            -0.19134171618254486313, 0.96193976625564348026, 1.1543291419087275962});
  Eigen::Isometry3d X_WB = X_WA;
  X_WB.translation() = Eigen::Vector3d(2, 0, 1.25);
  holdTruth(Box{{0.5, 0.5, 0.5}}, X_WA, Box{{0.5, 0.5, 0.5}}, X_WB, 1e-13);
}

TEST(FclRegressions, Issue492RegressionABodyInsideAMeshIsAContact) {
  auto cube = std::make_shared<TriangleMesh>();
  for (int i = 0; i < 8; ++i) {
    cube->vertices.emplace_back(i & 1 ? 1.0 : -1.0, i & 2 ? 1.0 : -1.0, i & 4 ? 1.0 : -1.0);
  }
  cube->triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                     {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  NarrowPhase narrow_phase;
  const auto A = prepareShape(Mesh{cube}), B = prepareShape(Sphere{0.1});
  const PairDistance result = narrow_phase.distance(*A, *B, at(0.5, 0.0, 0.0), INF);
  EXPECT_NEAR(result.distance, -0.6, 1e-15);
  EXPECT_EQ(result.certainty, Certainty::EXACT);
}

}  // namespace collision_pairs::test_fcl_regressions
