// What is certified around a configuration, beside distances measured along the motion.
#include <cmath>

#include <gtest/gtest.h>

#include "collision_pairs/collision_detector.h"
#include "demo_scene.h"
#include "pair_certifier.h"
#include "random_inputs.h"
#include "test_shapes.h"

namespace collision_pairs::test_pair_certifier {

using Outcome = PairCertifier::Outcome;

std::shared_ptr<const TriangleMesh> testMesh(const std::string& uri, const Eigen::Vector3d&) {
  return std::make_shared<const TriangleMesh>(uri == "l" ? LShape().mesh() : bumpyBall(10, 0.15));
}

/// Two arms of three joints, each with a shape of its own kind at its end, on a common turntable.
std::string arm(const std::string& name, const std::string& geometry, RandomInputs& random) {
  const auto axis = [&] {
    const Eigen::Vector3d u = random.rotation() * Eigen::Vector3d::UnitX();
    return "<axis xyz='" + std::to_string(u[0]) + " " + std::to_string(u[1]) + " " +
           std::to_string(u[2]) + "'/><limit lower='-9' upper='9'/>";
  };
  const auto offset = [&](double reach) {
    const Eigen::Vector3d p = random.vector(-reach, reach);
    return std::to_string(p[0]) + " " + std::to_string(p[1]) + " " + std::to_string(p[2]);
  };
  return emptyLink(name + "1") + emptyLink(name + "2") + linkWith(name, geometry) +
         joint(name + "_a", "revolute", "table", name + "1", offset(0.3), axis()) +
         joint(name + "_b", random.integer(0, 1) ? "revolute" : "prismatic", name + "1", name + "2",
               offset(0.2), axis()) +
         joint(name + "_c", "revolute", name + "2", name, offset(0.2), axis());
}

class CertifierCase {
 public:
  CertifierCase(RandomInputs& random, const std::string& geometry_a, const std::string& geometry_b,
                Fidelity fidelity, double padding) {
    robot_ = RobotModel::fromUrdf(
        "<robot name='r'>" + emptyLink("root") + emptyLink("table") +
            joint("turn", "continuous", "root", "table", "0 0 0", "<axis xyz='0 0 1'/>") +
            arm("a", geometry_a, random) + arm("b", geometry_b, random) + "</robot>",
        testMesh);
    SceneSettings settings;
    settings.max_hull_vertices = random.integer(0, 1) ? 8 : 0;
    settings.padding = padding;
    scene_ = CollisionScene::build(robot_, Srdf{}, nullptr, settings);
    settings_.fidelity = fidelity;
    for (std::size_t j = 0; j < robot_->joints().size(); ++j) {
      motion_.from.push_back(random.uniform(-3.0, 3.0));
      motion_.to.push_back(motion_.from.back() + random.uniform(-3.0, 3.0));
    }
  }

  /// As far as it is less than `reach`.
  double distanceAt(double fraction, double reach) {
    std::vector<double> q(motion_.from.size());
    for (std::size_t i = 0; i < q.size(); ++i) {
      q[i] = motion_.from[i] + fraction * (motion_.to[i] - motion_.from[i]);
    }
    robot_->forwardKinematics(q, X_RB_);
    scene_->gatherPoses(X_RB_, poses_);
    CheckSettings settings;
    settings.fidelity = settings_.fidelity;
    settings.alarm_distance = reach;
    if (!detector_) detector_ = std::make_unique<CollisionDetector>(scene_);
    return detector_->detect(poses_, settings).min_distance;  // or else the alarm distance
  }

  Outcome measure(double at, double half_width, double clearance, CertifiedInterval& certified) {
    const MotionPairs pairs(*scene_);
    EXPECT_EQ(pairs.pairs.size(), 1u);
    MotionState state(*scene_, pairs);
    PairCertifier pair_certifier(*scene_, state);
    settings_.clearance = clearance;
    pair_certifier.begin(settings_, {});
    state.begin(motion_, {});
    state.moveTo(at, half_width);
    OpenPair open;
    open.pair = {pairs.pairs[0].first, pairs.pairs[0].second};
    open.frame = pairs.pairs[0].frame;
    open.begin = at - half_width;
    open.end = at + half_width;
    open.clearance = clearance;
    return pair_certifier.measure(at, open, certified);
  }

 private:
  std::shared_ptr<const RobotModel> robot_;
  std::shared_ptr<const CollisionScene> scene_;
  std::unique_ptr<CollisionDetector> detector_;
  MotionSettings settings_;
  JointMotion motion_;
  std::vector<Eigen::Isometry3d> X_RB_;
  BodyPoses poses_;
};

void expectTrueIntervals(Fidelity fidelity, int nb_cases) {
  const std::string shapes[] = {"<box size='0.4 0.1 0.002'/>",
                                "<cylinder radius='0.1' length='0.3'/>", "<sphere radius='0.15'/>",
                                "<mesh filename='l'/>", "<mesh filename='ball'/>"};
  RandomInputs random;
  int nb_partly = 0, nb_contacts = 0;
  for (int i = 0; i < nb_cases; ++i) {
    const double padding = random.integer(0, 2) == 0 ? 0.01 : 0.0;
    CertifierCase one(random, shapes[random.integer(0, 4)], shapes[random.integer(0, 4)], fidelity,
                      padding);
    const double at = random.uniform(0.2, 0.8);
    const double half_width = std::pow(10.0, random.uniform(-2.0, -0.3));
    const double clearance = random.integer(0, 2) == 0 ? 0.02 : 0.0;
    CertifiedInterval certified;
    const Outcome outcome = one.measure(at, half_width, clearance, certified);
    const double here = one.distanceAt(at, 0.1);
    SCOPED_TRACE("case " + std::to_string(i) + ", distance " + std::to_string(here));
    if (outcome == Outcome::CONTACT) {
      ++nb_contacts;
      EXPECT_LE(here, 0.0);
      continue;
    }
    EXPECT_FALSE(outcome == Outcome::NEARER && here >= clearance);
    const double all = half_width * (1.0 - 1e-9);
    EXPECT_EQ(outcome == Outcome::CERTIFIED, certified.before >= all && certified.after >= all);
    if (certified.before < 0.0) continue;
    ASSERT_GT(certified.clearance, clearance);
    nb_partly += outcome == Outcome::OPEN ? 1 : 0;
    for (const double share : {0.1, 0.5, 0.9, 1.0}) {
      const double before = std::min(certified.before, half_width);
      const double after = std::min(certified.after, half_width);
      const double least = certified.clearance - 1e-8;
      ASSERT_GE(one.distanceAt(at - share * before, std::max(0.0, least)), least);
      ASSERT_GE(one.distanceAt(at + share * after, std::max(0.0, least)), least);
    }
  }
  EXPECT_GT(nb_partly, nb_cases / 20);
  EXPECT_GT(nb_contacts, nb_cases / 100);
}

TEST(PairCertifier, IsNoWiderThanThePairIsFreeAtMeshes) {
  expectTrueIntervals(Fidelity::MESH, 2000);
}
TEST(PairCertifier, IsNoWiderThanThePairIsFreeAtHulls) {
  expectTrueIntervals(Fidelity::CONVEX, 600);
}
TEST(PairCertifier, IsNoWiderThanThePairIsFreeAtBoxes) { expectTrueIntervals(Fidelity::OBB, 600); }
TEST(PairCertifier, IsNoWiderThanThePairIsFreeAtAlignedBoxes) {
  expectTrueIntervals(Fidelity::AABB, 600);
}

}  // namespace collision_pairs::test_pair_certifier
