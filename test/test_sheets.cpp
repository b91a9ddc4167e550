// A box without thickness is a thin sheet; a large one is a plane, as two half-spaces back to back.
#include <gtest/gtest.h>

#include "collision_pairs/collision_detector.h"
#include "every_shape.h"
#include "mixed_robot.h"
#include "motion_fixtures.h"

namespace collision_pairs::test_sheets {

using Eigen::Isometry3d;
using Eigen::Vector3d;

constexpr double INF = std::numeric_limits<double>::infinity();
constexpr double EDGE = 1000.0;      // metres
constexpr double OF_NATIVE = 1e-10;  // of the body's size, at least 10 mm
constexpr double OF_FCL = 1e-7;      // of the size of both

const Isometry3d UPSIDE_DOWN(Eigen::AngleAxisd(M_PI, Vector3d::UnitX()));

class SheetsBy : public testing::TestWithParam<NarrowPhaseMethod> {};

TEST_P(SheetsBy, AreAsFarFromABodyAsTheFurtherOfTwoHalfSpaces) {
  RandomInputs random;
  NarrowPhase narrow_phase;
  const auto sheet = prepareShape(Box{{EDGE, EDGE, 0.0}}, GetParam());
  const auto solid = prepareShape(HalfSpace{}, GetParam());
  const bool by_fcl = GetParam() == NarrowPhaseMethod::FCL;
  int nb_contacts = 0;
  for (const std::string& kind : EVERY_KIND) {
    for (int i = 0; i < 500; ++i) {
      const double size = std::pow(10.0, random.uniform(-2.0, 1.0));
      const auto body = prepareShape(shapeOfKind(random, kind, size), GetParam());
      Isometry3d X_SB = random.pose(0.4 * EDGE);
      X_SB.translation().z() = random.uniform(-2.0, 2.0) * size;
      const PairDistance below = narrow_phase.distance(*solid, *body, X_SB, INF);
      const PairDistance above = narrow_phase.distance(*solid, *body, UPSIDE_DOWN * X_SB, INF);
      const double expected = std::max(below.distance, above.distance);
      const PairDistance found = narrow_phase.distance(*sheet, *body, X_SB, INF);
      EXPECT_NEAR(found.distance, expected, by_fcl ? OF_FCL * EDGE : OF_NATIVE * size) << kind;
      const Vector3d nhat = found.nhat_AB_A * (X_SB.translation().z() > 0.0 ? 1.0 : -1.0);
      if (expected > 1e-3 * size) {
        EXPECT_NEAR(nhat.z(), 1.0, 1e-6) << kind;
      }
      EXPECT_EQ(narrow_phase.touches(*sheet, *body, X_SB), expected <= 0.0) << kind;
      nb_contacts += expected <= 0.0;
    }
  }
  EXPECT_GT(nb_contacts, 500);
}

INSTANTIATE_TEST_SUITE_P(NarrowPhases, SheetsBy,
                         testing::Values(NarrowPhaseMethod::NATIVE, NarrowPhaseMethod::FCL),
                         [](const auto& given) { return narrowPhaseName(given.param); });

/// Upright at x = 0.
RigidObject wall() {
  RigidObject object = boxAt("wall", Vector3d::Zero(), {EDGE, EDGE, 0.0});
  object.X_PO.linear() = Eigen::AngleAxisd(M_PI_2, Vector3d::UnitY()).toRotationMatrix();
  return object;
}

TEST(Sheets, MayPassBetweenTwoBodiesOfOneMesh) {
  const auto robot = RobotModel::fromUrdf(
      "<robot name='r'>" + linkWith("link", "<mesh filename='pair'/>") + "</robot>", testMesh);
  const auto scene = sceneOf(robot, {wall()});
  CollisionDetector detector(scene);
  BodyPoses poses;
  poses.resize(1);
  const auto verdictAt = [&](double x) {
    poses.X_WB[0].translation().x() = x;
    return detector.detect(poses, {}).verdict;
  };
  EXPECT_EQ(verdictAt(-0.12), Verdict::FREE);  // from -0.025 to 0.025, and about 0.3
  EXPECT_EQ(verdictAt(0.0), Verdict::COLLISION);
  EXPECT_EQ(verdictAt(-0.3), Verdict::COLLISION);
  EXPECT_EQ(verdictAt(-1.0), Verdict::FREE);
}

TEST(Sheets, AreNotPassedByAMotion) {
  RandomInputs random;
  const auto scene = sceneOf(robotFrom(slidingBoxes(1)), {wall()});
  for (int i = 0; i < 200; ++i) {
    const double from = random.uniform(-90.0, 90.0), to = random.uniform(-90.0, 90.0);
    if (std::min(std::abs(from), std::abs(to)) < 0.51) continue;
    const MotionReport report = checked(scene, {from}, {to});
    const bool crosses = from * to < 0.0;
    EXPECT_EQ(report.verdict, crosses ? Verdict::COLLISION : Verdict::FREE) << from << ", " << to;
  }
}

}  // namespace collision_pairs::test_sheets
