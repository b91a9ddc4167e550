// The gradient of distances against differences of the distances themselves.
#include <cmath>

#include <gtest/gtest.h>

#include "collision_pairs/collision_detector.h"
#include "collision_pairs/distance_gradient.h"
#include "demo_scene.h"
#include "random_inputs.h"
#include "test_shapes.h"

namespace collision_pairs::test_distance_gradient {

using Eigen::Isometry3d;
using Eigen::Vector3d;

std::shared_ptr<const TriangleMesh> meshes(const std::string& uri, const Vector3d&) {
  TriangleMesh mesh = boxMesh({0.12, 0.1, 0.04});
  if (uri == "l") mesh = LShape().mesh();
  if (uri == "ball") mesh = bumpyBall(10, 0.12);
  return std::make_shared<const TriangleMesh>(mesh);
}

std::string turning(const std::string& child, const std::string& parent, const std::string& xyz,
                    const std::string& type = "revolute", const std::string& extra = "") {
  return joint("j_" + child, type, parent, child, xyz,
               "<axis xyz='0.2 1 -0.4'/><limit lower='-3' upper='3'/>" + extra);
}

/// Two arms of unlike links on one base, joints of every kind, and a joint that leads two others.
std::shared_ptr<const RobotModel> arms() {
  const std::string xml =
      linkWith("base", "<box size='0.3 0.2 0.1'/>") +
      linkWith("a1", "<sphere radius='0.08'/>", "<origin xyz='0.1 0 0'/>") +
      linkWith("a2", "<mesh filename='l'/>", "<origin xyz='0.1 0.05 0'/>") +
      linkWith("a3", "<cylinder radius='0.05' length='0.3'/>", "<origin xyz='0.2 0 0.1'/>") +
      linkWith("a4", "<mesh filename='ball'/>", "<origin xyz='0.2 0 0'/>") +
      linkWith("b1", "<box size='0.1 0.2 0.15'/>", "<origin xyz='-0.1 0 0.1'/>") +
      linkWith("b2", "<mesh filename='slab'/>", "<origin xyz='0.1 0.1 0.1'/>") +
      linkWith("b3", "<sphere radius='0.06'/>", "<origin xyz='0.1 -0.1 0.1'/>") +
      turning("a1", "base", "0.3 0 0") + turning("a2", "a1", "0.25 0 0.1", "continuous") +
      turning("a3", "a2", "0.2 0.1 0", "prismatic") + turning("a4", "a3", "0.2 0 0.2") +
      turning("b1", "base", "-0.2 0.3 0", "revolute",
              "<mimic joint='j_a1' multiplier='-1.5' offset='0.3'/>") +
      turning("b2", "b1", "0 0.3 0") +
      turning("b3", "b2", "0.3 0 0", "prismatic",
              "<mimic joint='j_a1' multiplier='0.4' offset='-0.1'/>");
  return RobotModel::fromUrdf("<robot name='arms'>" + xml + "</robot>", meshes);
}

const std::vector<std::string> NAMES = {"j_a1", "j_a2", "j_a3", "j_a4", "j_b2"};

SceneDescription describe(const std::shared_ptr<const RobotModel>& robot) {
  SceneDescription description;
  description.robots.push_back({robot, std::nullopt, ""});
  const auto at = [](double x, double y, double z) {
    return Isometry3d(Eigen::Translation3d(x, y, z));
  };
  const RigidObject box{"object", {{Box{{0.4, 0.3, 0.5}}, at(0, 0, 0)}}, "", at(0.2, 0.9, 0.1), {}};
  const RigidObject held{"held", {{Sphere{0.05}, at(0, 0, 0)}}, "a4", at(0.4, 0.1, 0), {}};
  description.objects = {box, held, floorAt(-0.5, {"base"})};
  return description;
}

/// Checks of one scene at joint states.
class Probe {
 public:
  Probe(const SceneDescription& description, const std::vector<std::string>& names)
      : scene_(CollisionScene::build(description)),
        columns_(names, scene_->robot()),
        detector_(scene_),
        gradient_(*scene_, columns_) {}

  std::size_t nbJoints() const { return columns_.size(); }

  const CollisionReport& at(const Eigen::VectorXd& q) {
    std::vector<double> positions = scene_->robot().zeroPositions();
    columns_.apply(q.data(), positions);
    scene_->robot().forwardKinematics(positions, X_WB_);
    scene_->gatherPoses(X_WB_, poses_);
    return detector_.detect(poses_, settings);
  }

  bool gradient(const PairReport& pair, Eigen::VectorXd& gradient) {
    constexpr double UNTOUCHED = 1234.5;
    const auto size = static_cast<Eigen::Index>(columns_.size());
    Eigen::VectorXd written = Eigen::VectorXd::Constant(size + 2, UNTOUCHED);
    const bool has = gradient_.compute(pair, detector_.report(), X_WB_, written.data() + 1);
    EXPECT_EQ(written[0], UNTOUCHED);
    EXPECT_EQ(written[size + 1], UNTOUCHED);
    gradient = written.segment(1, size);
    return has;
  }

  /// NaN where the pair is not measured.
  double distance(const Eigen::VectorXd& q, const PairReport& pair) {
    for (const PairReport& found : at(q).pairs) {
      if (found.first == pair.first && found.second == pair.second) return found.distance;
    }
    return NAN;
  }

  Isometry3d poseOf(const std::string& link, const Eigen::VectorXd& q) {
    at(q);
    return X_WB_[scene_->robot().links()[scene_->robot().findLink(link)].body];
  }

  const CollisionScene& scene() const { return *scene_; }

  CheckSettings settings;

 private:
  std::shared_ptr<const CollisionScene> scene_;
  JointColumns columns_;
  CollisionDetector detector_;
  DistanceGradient gradient_;
  std::vector<Isometry3d> X_WB_;
  BodyPoses poses_;
};

Eigen::VectorXd randomState(RandomInputs& random, std::size_t size) {
  const auto each = [&] { return random.uniform(-3.0, 3.0); };
  return Eigen::VectorXd::NullaryExpr(static_cast<Eigen::Index>(size), each);
}

/// d(distance)/dq by differences of fourth order in the step h.
Eigen::VectorXd differences(Probe& probe, const PairReport& pair, const Eigen::VectorXd& q,
                            double h) {
  Eigen::VectorXd slopes(q.size());
  for (Eigen::Index i = 0; i < q.size(); ++i) {
    const auto at = [&](double step) {
      return probe.distance(q + step * Eigen::VectorXd::Unit(q.size(), i), pair);
    };
    slopes[i] = (8.0 * (at(h) - at(-h)) - (at(2.0 * h) - at(-2.0 * h))) / (12.0 * h);
  }
  return slopes;
}

struct Tally {
  int compared = 0, without_derivative = 0;
  double worst = 0.0;
  std::string worst_pair;
};

using Kind = bool (*)(const PairReport&);
bool isApart(const PairReport& pair) { return pair.distance > 0.0; }
bool isDepth(const PairReport& pair) {
  return pair.distance <= 0.0 && pair.certainty == Certainty::EXACT;
}
bool isBoundOfDepth(const PairReport& pair) { return pair.certainty == Certainty::BOUND; }

/// Compares where two steps of the difference agree: there the distance has a derivative.
Tally compare(Probe& probe, int nb_states, Kind kind, RandomInputs& random) {
  Tally tally;
  for (int state = 0; state < nb_states; ++state) {
    const Eigen::VectorXd q = randomState(random, probe.nbJoints());
    const std::vector<PairReport> pairs = probe.at(q).pairs;
    std::vector<Eigen::VectorXd> gradients(pairs.size());
    std::vector<bool> given(pairs.size());
    for (std::size_t i = 0; i < pairs.size(); ++i)
      given[i] = probe.gradient(pairs[i], gradients[i]);
    for (std::size_t i = 0; i < pairs.size(); ++i) {
      if (!kind(pairs[i]) || !given[i]) continue;
      const Eigen::VectorXd slopes = differences(probe, pairs[i], q, 2e-5);
      double difference = 0.0;  // where the nearest features change, the steps disagree
      for (const double step : {1e-5, 5e-5}) {
        const Eigen::VectorXd other = differences(probe, pairs[i], q, step);
        difference = std::max(difference, (slopes - other).cwiseAbs().maxCoeff());
      }
      if (!(difference < 3e-7)) {
        ++tally.without_derivative;
        continue;
      }
      ++tally.compared;
      const double error = (gradients[i] - slopes).cwiseAbs().maxCoeff();
      if (!(error <= tally.worst)) {
        tally.worst = error;
        const auto& models = probe.scene().models();
        tally.worst_pair = models[pairs[i].first].name + "|" + models[pairs[i].second].name;
      }
    }
  }
  std::cout << tally.compared << " compared, " << tally.without_derivative
            << " without a derivative, worst error " << tally.worst << " (" << tally.worst_pair
            << ")\n";
  return tally;
}

void expectSlopes(const Tally& tally, int at_least) {
  EXPECT_GT(tally.compared, at_least);
  EXPECT_LT(tally.without_derivative, tally.compared / 20);
  EXPECT_LT(tally.worst, 1e-6) << tally.worst_pair;
}

class GradientOfDistance : public testing::Test {
 protected:
  RandomInputs random_;
};

TEST_F(GradientOfDistance, IsTheDifferenceQuotientOfPairsThatAreApart) {
  Probe probe(describe(arms()), NAMES);
  probe.settings.alarm_distance = 0.3;
  expectSlopes(compare(probe, 60, isApart, random_), 300);
}

SceneDescription cylinderBeside(const std::string& geometry) {
  const std::string xml = linkWith("base", geometry) + emptyLink("arm") +
                          linkWith("tip", "<cylinder radius='0.08' length='0.1'/>") +
                          turning("arm", "base", "0 0 0.3") + turning("tip", "arm", "0.2 0.1 -0.1");
  SceneDescription description;
  description.robots.push_back(
      {RobotModel::fromUrdf("<robot name='r'>" + xml + "</robot>", meshes), Srdf(), ""});
  return description;
}

// Hulls of few vertices do not decide, but the exact ones do, beside the triangles.
TEST_F(GradientOfDistance, IsNotThatOfSimplifiedHulls) {
  SceneDescription description = cylinderBeside("<mesh filename='l'/>");
  description.settings.max_hull_vertices = 4;
  Probe probe(description, {"j_arm", "j_tip"});
  probe.settings.alarm_distance = 1.0;
  expectSlopes(compare(probe, 400, isApart, random_), 100);
}

// A cylinder near a box, at its rim mostly, where GJK alone would be off by up to 3e-5. The truth
// is sought otherwise: from one to the nearest point of the other, to and fro.
class GradientAtTheRim : public GradientOfDistance, public testing::WithParamInterface<double> {};

TEST_P(GradientAtTheRim, OfACylinderIsRightAlsoWithinThePadding) {
  const Cylinder cylinder{0.08, 0.1};
  const Vector3d half(0.1, 0.15, 0.2);
  SceneDescription description = cylinderBeside("<box size='0.2 0.3 0.4'/>");
  description.settings.padding = 0.5 * GetParam();
  Probe probe(description, {"j_arm", "j_tip"});
  probe.settings.alarm_distance = std::max(0.03 - GetParam(), 0.0);
  int nb_compared = 0;
  for (int i = 0; i < 3000; ++i) {
    const Eigen::VectorXd q = randomState(random_, 2);
    const std::vector<PairReport> pairs = probe.at(q).pairs;
    if (pairs.empty() || pairs[0].distance + GetParam() < 1e-3) continue;
    Eigen::VectorXd gradient;
    ASSERT_TRUE(probe.gradient(pairs[0], gradient));
    const Isometry3d X_WT = probe.poseOf("tip", q);
    Vector3d p_TC(0, 0, 0), p_WC, before;
    do {
      before = p_TC;
      p_WC = (X_WT * p_TC).cwiseMax(-half).cwiseMin(half);
      p_TC = X_WT.inverse() * p_WC;
      const double off_axis = std::max(p_TC.head<2>().norm() / cylinder.radius, 1.0);
      p_TC.head<2>() /= off_axis;
      p_TC[2] = std::clamp(p_TC[2], -0.5 * cylinder.length, 0.5 * cylinder.length);
    } while ((p_TC - before).norm() > 1e-14);
    const Vector3d nhat_W = (X_WT * p_TC - p_WC).normalized();
    for (Eigen::Index j = 0; j < 2; ++j) {
      const Eigen::VectorXd step = 1e-5 * Eigen::VectorXd::Unit(2, j);
      const Vector3d moved =
          probe.poseOf("tip", q + step) * p_TC - probe.poseOf("tip", q - step) * p_TC;
      EXPECT_NEAR(gradient[j], nhat_W.dot(moved) / 2e-5, 1e-8) << "distance " << pairs[0].distance;
    }
    ++nb_compared;
  }
  EXPECT_GT(nb_compared, 200);
}

INSTANTIATE_TEST_SUITE_P(Plain, GradientAtTheRim, testing::Values(0.0));
INSTANTIATE_TEST_SUITE_P(Padded, GradientAtTheRim, testing::Values(0.03));

TEST_F(GradientOfDistance, IsThatOfTheDistanceLessPaddingAndOfCapsules) {
  SceneDescription description = describe(arms());
  description.settings.padding = 0.03;
  description.settings.cylinder_as_capsule = {"a3"};
  Probe probe(description, NAMES);
  probe.settings.alarm_distance = 0.3;
  expectSlopes(compare(probe, 30, isApart, random_), 150);
}

TEST_F(GradientOfDistance, IsThatOfTheGeometryThatDecided) {
  SceneDescription description = describe(arms());
  description.settings.max_hull_vertices = 8;
  Probe probe(description, NAMES);
  probe.settings.alarm_distance = 0.3;
  for (const Fidelity fidelity : {Fidelity::CONVEX, Fidelity::OBB}) {
    probe.settings.fidelity = fidelity;
    expectSlopes(compare(probe, 30, isApart, random_), 100);
  }
}

TEST_F(GradientOfDistance, OfADepthIsItsSlope) {
  Probe probe(describe(arms()), NAMES);
  expectSlopes(compare(probe, 300, isDepth, random_), 300);
}

TEST_F(GradientOfDistance, OfADepthThatIsABoundIsTheSlopeOfThatBound) {
  Probe probe(describe(arms()), NAMES);
  expectSlopes(compare(probe, 800, isBoundOfDepth, random_), 120);
}

TEST_F(GradientOfDistance, IsZeroForJointsThatMoveBothAlikeAndForOneThatMimics) {
  std::vector<std::string> names = NAMES;
  names.push_back("j_b1");  // -1.5 j_a1 + 0.3
  Probe probe(describe(arms()), names);
  probe.settings.alarm_distance = 2.0;
  int nb_pairs = 0;
  for (int i = 0; i < 60; ++i) {
    Eigen::VectorXd q = randomState(random_, names.size()), gradient;
    q[5] = -1.5 * q[0] + 0.3;
    for (const PairReport& pair : probe.at(q).pairs) {
      ASSERT_TRUE(probe.gradient(pair, gradient));
      EXPECT_EQ(gradient[5], 0.0);
      const std::string first = probe.scene().models()[pair.first].name;
      const std::string second = probe.scene().models()[pair.second].name;
      if (first != "a2" || second != "a4") continue;
      ++nb_pairs;
      EXPECT_EQ(gradient[0], 0.0);
      EXPECT_EQ(gradient[1], 0.0);
      EXPECT_NE(gradient[3], 0.0);
    }
  }
  EXPECT_GT(nb_pairs, 10);
}

// A lift with a table top, parallel to a ceiling; and it tilts.
TEST_F(GradientOfDistance, ForSomeOfTheJointsIsThatOfAllWithoutTheOthers) {
  Probe all(describe(arms()), NAMES), some(describe(arms()), {"j_a4", "j_a1"});
  all.settings.alarm_distance = some.settings.alarm_distance = 2.0;
  int nb_pairs = 0;
  for (int i = 0; i < 20; ++i) {
    const Eigen::VectorXd of_some = randomState(random_, 2);
    Eigen::VectorXd of_all = Eigen::VectorXd::Zero(5);
    of_all[3] = of_some[0];
    of_all[0] = of_some[1];
    all.at(of_all);
    for (const PairReport& pair : some.at(of_some).pairs) {
      Eigen::VectorXd found, expected;
      if (!some.gradient(pair, found)) continue;
      for (const PairReport& same : all.at(of_all).pairs) {
        if (same.first != pair.first || same.second != pair.second) continue;
        ASSERT_TRUE(all.gradient(same, expected));
        EXPECT_EQ(found[0], expected[3]);
        EXPECT_EQ(found[1], expected[0]);
        ++nb_pairs;
      }
    }
  }
  EXPECT_GT(nb_pairs, 100);
}

TEST_F(GradientOfDistance, AtParallelFacesBoundsEveryChangeOfTheDistance) {
  const std::string xml = emptyLink("root") + emptyLink("tilted") +
                          linkWith("ceiling", "<box size='2 2 0.1'/>") +
                          linkWith("top", "<box size='0.6 0.4 0.1'/>") +
                          joint("fix", "fixed", "root", "ceiling", "0 0 1", "") +
                          joint("lift", "prismatic", "root", "tilted", "0 0 0",
                                "<axis xyz='0 0 1'/><limit lower='-2' upper='2'/>") +
                          joint("tilt", "revolute", "tilted", "top", "0 0 0",
                                "<axis xyz='0 1 0'/><limit lower='-2' upper='2'/>");
  SceneDescription description;
  description.robots.push_back({robotFrom(xml), std::nullopt, ""});
  Probe probe(description, {"lift", "tilt"});
  probe.settings.alarm_distance = 2.0;
  const Eigen::VectorXd level = Eigen::VectorXd::Zero(2);
  const PairReport pair = probe.at(level).pairs.at(0);
  EXPECT_NEAR(pair.distance, 0.9, 1e-15);
  Eigen::VectorXd gradient;
  ASSERT_TRUE(probe.gradient(pair, gradient));
  EXPECT_NEAR(gradient[0], -1.0, 1e-12);  // unique: whichever the witness points are
  EXPECT_LE(std::abs(gradient[1]), 0.3 + 1e-12);
  for (int i = 0; i < 100; ++i) {
    const Eigen::VectorXd step = 1e-6 * Eigen::VectorXd(random_.vector(-1.0, 1.0).head<2>());
    EXPECT_LE(probe.distance(step, pair), pair.distance + gradient.dot(step) + 1e-11);
  }
}

TEST_F(GradientOfDistance, IsNoneWhereThereIsNoDistance) {
  Probe probe(describe(arms()), NAMES);
  Eigen::VectorXd gradient;
  const auto expectNone = [&](const char* why) {
    int nb_pairs = 0;
    for (int i = 0; i < 20; ++i) {
      for (const PairReport& pair : probe.at(randomState(random_, NAMES.size())).pairs) {
        ++nb_pairs;
        EXPECT_FALSE(probe.gradient(pair, gradient)) << why;
        EXPECT_TRUE(gradient.array().isNaN().all()) << why;
      }
    }
    EXPECT_GT(nb_pairs, 5) << why;
  };
  probe.settings.verdict_only = true;
  expectNone("only the verdict");
  probe.settings = {};
  probe.settings.fidelity = Fidelity::AABB;
  expectNone("boxes that do not turn");
  probe.settings = {};
  probe.settings.time_budget = 1e-12;
  expectNone("no time");
}

}  // namespace collision_pairs::test_distance_gradient
