// The native narrow phase and FCL on the same poses: where they must agree, what FCL is not asked,
// and that no question ends the process.
#include <cstdlib>
#include <ctime>
#include <map>

#include <gtest/gtest.h>

#include "collision_pairs/batch_check.h"
#include "every_shape.h"
#include "mixed_robot.h"
#include "random_inputs.h"

namespace collision_pairs::test_native_and_fcl {

using Eigen::Isometry3d;
using Eigen::Vector3d;

constexpr double INF = std::numeric_limits<double>::infinity();
constexpr auto FCL = NarrowPhaseMethod::FCL;

bool isLong() { return std::getenv("COLLISION_PAIRS_LONG") != nullptr; }

bool isRound(const std::string& kind) {
  return kind == "sphere" || kind == "capsule" || kind == "cylinder";
}

/// Does FCL have the depth of such a pair?
bool fclHasDepth(const std::string& a, const std::string& b) {
  const auto is_primitive = [](const std::string& k) { return isRound(k) || k == "box"; };
  if (a == "capsule" && b == "capsule") return true;
  return (a == "sphere" && is_primitive(b)) || (b == "sphere" && is_primitive(a));
}

struct Prepared2 {
  Prepared2(const Shape& shape) : native(prepareShape(shape)), fcl(prepareShape(shape, FCL)) {}
  std::shared_ptr<const PreparedShape> native, fcl;
};

/// Calls check(kind_a, kind_b, size, gap, A, B, X_AB) for every pair of kinds of shapes, at every
/// size and gap (metres, negative: deep), `poses` times.
template <class Check>
void forEveryPairSizeAndGap(int poses, Check check) {
  RandomInputs random;
  NarrowPhase native;
  for (const double size : {1e-6, 1e-3, 0.2, 1e3, 1e6}) {
    for (const std::string& a : EVERY_KIND) {
      for (const std::string& b : EVERY_KIND) {
        if (b < a) continue;
        for (const double gap : {3.0, 0.1, 1e-3, 1e-6, 1e-9, 1e-12, 4e-15, 1e-15, 0.0, -1e-12,
                                 -1e-6, -1e-3, -1e-2, -INF}) {
          SCOPED_TRACE(a + "-" + b + " of " + std::to_string(size) + " m, gap " +
                       std::to_string(gap) + " sizes");
          for (int i = 0; i < poses; ++i) {
            const Prepared2 A(shapeOfKind(random, a, size)), B(shapeOfKind(random, b, size));
            const Isometry3d X_AB =
                poseWithGap(random, native, *A.native, *B.native, size, gap * size);
            check(a, b, size, A, B, X_AB);
            if (testing::Test::HasFatalFailure()) return;
          }
        }
      }
    }
  }
}

TEST(NativeAndFcl, AgreeOnYesOrNoAndDistanceForEveryPairOfShapesAtEverySizeAndGap) {
  NarrowPhase native, by_fcl;
  std::map<std::string, int> without_answer;
  forEveryPairSizeAndGap(
      isLong() ? 100 : 2, [&](const std::string& a, const std::string& b, double size,
                              const Prepared2& A, const Prepared2& B, const Isometry3d& X_AB) {
        const PairDistance truth = native.distance(*A.native, *B.native, X_AB, INF);
        const std::uint64_t natively_before = by_fcl.numAnsweredNatively();
        const PairDistance found = by_fcl.distance(*A.fcl, *B.fcl, X_AB, INF);
        const bool answered = by_fcl.numAnsweredNatively() == natively_before;
        ASSERT_NE(found.certainty, Certainty::DEGRADED);
        ASSERT_NEAR(found.nhat_AB_A.norm(), 1.0, 1e-12);
        ASSERT_TRUE(found.p_ACa.allFinite() && found.p_ACb.allFinite());
        ASSERT_EQ(found.touches(), truth.touches()) << truth.distance / size;
        ASSERT_EQ(by_fcl.touches(*A.fcl, *B.fcl, X_AB), truth.touches()) << truth.distance / size;
        ASSERT_EQ(found.certainty, truth.certainty);
        if (truth.certainty == Certainty::BOUND) {  // of meshes: any translation that separates
          Isometry3d X_apart = X_AB;
          X_apart.translation() += (1e-6 * size - found.distance) * found.nhat_AB_A;
          ASSERT_FALSE(native.touches(*A.native, *B.native, X_apart)) << found.distance / size;
        } else {
          ASSERT_NEAR(found.distance, truth.distance, 1e-6 * size);
        }
        if (!truth.touches()) without_answer[a + "-" + b] += !answered;
        if (truth.distance < -1e-8 * size) {
          ASSERT_EQ(answered, fclHasDepth(a, b)) << truth.distance / size;
        }
      });
  for (const auto& [pair, count] : without_answer) {
    if (count > 0) std::cout << "FCL has no answer of its own: " << pair << ' ' << count << '\n';
  }
}

// Else nobody would notice that FCL is no longer asked.
TEST(NativeAndFcl, FclAnswersForEveryPairThatIsClearlyApart) {
  RandomInputs random;
  NarrowPhase native;
  for (const std::string& a : EVERY_KIND) {
    for (const std::string& b : EVERY_KIND) {
      NarrowPhase by_fcl;
      for (int i = 0; i < 5; ++i) {
        const Prepared2 A(shapeOfKind(random, a, 0.2)), B(shapeOfKind(random, b, 0.2));
        const Isometry3d X_AB = poseWithGap(random, native, *A.native, *B.native, 0.2, 0.05);
        EXPECT_NEAR(by_fcl.distance(*A.fcl, *B.fcl, X_AB, INF).distance, 0.05, 1e-7);
        EXPECT_FALSE(by_fcl.touches(*A.fcl, *B.fcl, X_AB));
      }
      EXPECT_EQ(by_fcl.numAnsweredNatively(), 0u) << a << "-" << b;
    }
  }
}

TEST(NativeAndFcl, AgreeOnNormalsAndWitnessPointsOfBodiesApart) {
  NarrowPhase native, by_fcl;
  forEveryPairSizeAndGap(1, [&](const std::string&, const std::string&, double size,
                                const Prepared2& A, const Prepared2& B, const Isometry3d& X_AB) {
    const PairDistance truth = native.distance(*A.native, *B.native, X_AB, INF);
    if (truth.distance < 0.05 * size) return;
    const PairDistance found = by_fcl.distance(*A.fcl, *B.fcl, X_AB, INF);
    ASSERT_NEAR((found.p_ACb - found.p_ACa).norm(), found.distance, 1e-6 * size);
    ASSERT_NEAR((found.p_ACb - found.p_ACa).dot(found.nhat_AB_A), found.distance, 1e-6 * size);
    ASSERT_GT(found.nhat_AB_A.dot(truth.nhat_AB_A), 1.0 - 1e-4);
  });
}

TEST(NativeAndFcl, WhatIsBeyondTheLimitIsALowerBoundThatIsMoreThanTheLimit) {
  NarrowPhase native, by_fcl;
  RandomInputs random;
  forEveryPairSizeAndGap(1, [&](const std::string&, const std::string&, double size,
                                const Prepared2& A, const Prepared2& B, const Isometry3d& X_AB) {
    const double truth = native.distance(*A.native, *B.native, X_AB, INF).distance;
    const double limit = random.integer(0, 2) == 0 ? 0.0 : random.uniform(0.0, 4.0) * size;
    const PairDistance cut = by_fcl.distance(*A.fcl, *B.fcl, X_AB, limit);
    if (truth > limit + 1e-6 * size) {
      ASSERT_EQ(cut.certainty, Certainty::BEYOND);
      ASSERT_GT(cut.distance, limit);
      ASSERT_LE(cut.distance, truth + 1e-6 * size);
    } else if (truth < limit - 1e-6 * size) {
      ASSERT_NE(cut.certainty, Certainty::BEYOND);
      ASSERT_NEAR(cut.distance, truth, 1e-6 * size);
    }
  });
}

// Sizes from a micrometre to a thousand kilometres in one pair, poses without rotation, exact
// contact, one body upon another.
Isometry3d anyPose(RandomInputs& random, NarrowPhase& native, const Prepared2& A,
                   const Prepared2& B, double size) {
  Isometry3d X_AB = random.pose(2.0 * size);
  if (random.integer(0, 3) == 0) X_AB.linear().setIdentity();
  if (random.integer(0, 3) == 0) X_AB.translation().head<2>().setZero();
  if (random.integer(0, 7) == 0) X_AB.translation().setZero();
  if (random.integer(0, 3) == 0) {  // as far as doubles go
    const PairDistance gap = native.distance(*A.native, *B.native, X_AB, INF);
    X_AB.translation() -= gap.distance * gap.nhat_AB_A;
  }
  return X_AB;
}

// By more than a millionth of the larger body: where FCL says "apart", a body that is moved away by
// so much still touches.
bool verdictsDiffer(NarrowPhase& native, const Prepared2& A, const Prepared2& B, Isometry3d X_AB,
                    double size, const PairDistance& by_fcl) {
  const double sure = 1e-6 * size;
  if (by_fcl.touches()) return native.distance(*A.native, *B.native, X_AB, INF).distance > sure;
  X_AB.translation() += sure * by_fcl.nhat_AB_A;
  return native.touches(*A.native, *B.native, X_AB);
}

TEST(NativeAndFcl, NoPairOfShapesOfAnySizesEndsTheProcessOrGivesWhatIsNoAnswer) {
  RandomInputs random;
  NarrowPhase native, by_fcl;
  const auto anySize = [&] { return std::pow(10.0, random.uniform(-6.0, 6.0)); };
  const auto anyKind = [&] {
    return EVERY_KIND[random.integer(0, static_cast<int>(EVERY_KIND.size()) - 1)];
  };
  constexpr int POSES = 10;  // of each two bodies
  const int pairs = isLong() ? 1000000 : 10000;
  std::clock_t longest = 0;  // of the processor: others may be running
  for (int i = 0; i < pairs / POSES; ++i) {
    const double size_a = anySize(), size_b = random.integer(0, 1) == 0 ? size_a : anySize();
    const std::string a = anyKind(), b = anyKind();
    const Prepared2 A(shapeOfKind(random, a, size_a)), B(shapeOfKind(random, b, size_b));
    const double size = std::max(size_a, size_b);
    SCOPED_TRACE(a + "-" + b + " of " + std::to_string(size_a) + " and " + std::to_string(size_b));
    for (int k = 0; k < POSES; ++k) {
      const Isometry3d X_AB = anyPose(random, native, A, B, size);
      const std::clock_t start = std::clock();
      const PairDistance found = by_fcl.distance(*A.fcl, *B.fcl, X_AB, INF);
      const bool touches = by_fcl.touches(*A.fcl, *B.fcl, X_AB);
      longest = std::max(longest, std::clock() - start);
      ASSERT_TRUE(std::isfinite(found.distance));
      ASSERT_TRUE(found.p_ACa.allFinite() && found.p_ACb.allFinite());
      ASSERT_NEAR(found.nhat_AB_A.norm(), 1.0, 1e-12);
      ASSERT_TRUE(!touches || found.distance <= 1e-6 * size) << found.distance / size;
      ASSERT_FALSE(verdictsDiffer(native, A, B, X_AB, size, found)) << found.distance / size;
    }
  }
  std::cout << pairs << " pairs, the longest two questions together "
            << 1e3 * static_cast<double>(longest) / CLOCKS_PER_SEC << " ms\n";
}

TEST(NativeAndFcl, HalfSpacesAndWhatLiesInsideAMeshAreAnsweredNativelyAndCounted) {
  NarrowPhase by_fcl;
  const auto floor = prepareShape(HalfSpace{}, FCL), box = prepareShape(Box{{1, 1, 1}}, FCL);
  Isometry3d X = Isometry3d::Identity();
  X.translation().z() = 0.75;
  EXPECT_EQ(by_fcl.distance(*floor, *box, X, INF).distance, 0.25);
  EXPECT_FALSE(by_fcl.touches(*floor, *box, X));
  EXPECT_EQ(by_fcl.numAnsweredNatively(), 2u);

  const auto ball = prepareShape(meshShape(bumpyBall(12, 1.0)), FCL);
  const auto pea = prepareShape(Sphere{0.01}, FCL);
  const auto l = prepareShape(meshShape(LShape().mesh()), FCL);  // 30 cm
  for (const auto& inside : {pea, l}) {
    EXPECT_TRUE(by_fcl.touches(*ball, *inside, Isometry3d::Identity()));
    EXPECT_TRUE(by_fcl.touches(*inside, *ball, Isometry3d::Identity()));
    const PairDistance held = by_fcl.distance(*ball, *inside, Isometry3d::Identity(), 0.0);
    EXPECT_LT(held.distance, -0.5);
    EXPECT_EQ(held.certainty, Certainty::BOUND);
  }
  EXPECT_EQ(by_fcl.numAnsweredNatively(), 8u);
  X.translation().z() = 2.0;
  EXPECT_GT(by_fcl.distance(*ball, *l, X, INF).distance, 0.0);
  EXPECT_EQ(by_fcl.numAnsweredNatively(), 8u);
}

TEST(NativeAndFcl, ShapesPreparedForTheNativeNarrowPhaseAreNotAskedOfFcl) {
  NarrowPhase narrow_phase;
  const auto native = prepareShape(Box{{1, 1, 1}}), by_fcl = prepareShape(Box{{1, 1, 1}}, FCL);
  Isometry3d X = Isometry3d::Identity();
  X.translation().x() = 0.5;
  narrow_phase.distance(*native, *native, X, INF);
  narrow_phase.distance(*native, *by_fcl, X, INF);
  EXPECT_EQ(narrow_phase.numAnsweredNatively(), 0u);
  narrow_phase.distance(*by_fcl, *by_fcl, X, INF);  // FCL has no depth of two boxes
  EXPECT_EQ(narrow_phase.numAnsweredNatively(), 1u);
}

TEST(NativeAndFcl, AWholeCheckFindsTheSameAtEveryRungAndForTheVerdictOnly) {
  RandomInputs random;
  const auto robot = mixedRobot();
  SceneSettings of_fcl;
  of_fcl.narrow_phase = FCL;
  CollisionDetector native(CollisionScene::build(robot, Srdf{}, nullptr));
  CollisionDetector by_fcl(CollisionScene::build(robot, Srdf{}, nullptr, of_fcl));
  BodyPoses poses;
  poses.resize(native.scene().bodies().size());
  std::uint32_t natively = 0;
  for (int i = 0; i < 300; ++i) {
    throwAbout(random, 1.0, poses);
    CheckSettings settings;
    settings.fidelity = static_cast<Fidelity>(i % 4);
    settings.verdict_only = i % 3 == 0;
    settings.min_distance = i % 3 == 1;
    const CollisionReport &expected = native.detect(poses, settings),
                          &found = by_fcl.detect(poses, settings);
    ASSERT_EQ(found.verdict, expected.verdict);
    ASSERT_NEAR(found.min_distance, expected.min_distance, 1e-6);
    ASSERT_EQ(found.pairs.size(), expected.pairs.size());
    for (std::size_t k = 0; k < found.pairs.size(); ++k) {
      ASSERT_EQ(found.pairs[k].first, expected.pairs[k].first);
      ASSERT_EQ(found.pairs[k].second, expected.pairs[k].second);
      ASSERT_EQ(found.pairs[k].state, expected.pairs[k].state);
      ASSERT_NEAR(found.pairs[k].distance, expected.pairs[k].distance, 1e-6);
    }
    ASSERT_EQ(found.narrow_phase, FCL);
    ASSERT_EQ(expected.narrow_phase, NarrowPhaseMethod::NATIVE);
    ASSERT_EQ(expected.nb_answered_natively, 0u);
    natively += found.nb_answered_natively;
  }
  EXPECT_GT(natively, 0u);
}

}  // namespace collision_pairs::test_native_and_fcl
