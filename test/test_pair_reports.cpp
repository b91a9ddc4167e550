// What a report says of single pairs: state, distance, fidelity, witness points.
#include <algorithm>
#include <array>
#include <cmath>

#include <gtest/gtest.h>

#include "collision_pairs/collision_detector.h"
#include "found_pairs.h"
#include "mixed_robot.h"

namespace collision_pairs::test_pair_reports {

CheckSettings alarm(double distance) {
  CheckSettings settings;
  settings.alarm_distance = distance;
  return settings;
}

/// Spheres a and b of radius 0.5 on the x axis: their distance is exact.
class TwoSpheres : public testing::Test {
 protected:
  const CollisionReport& at(double x, const CheckSettings& settings) {
    BodyPoses poses;
    poses.resize(2);
    poses.X_WB[1].translation().x() = x;
    return detector_.detect(poses, settings);
  }
  static std::shared_ptr<const CollisionScene> spheres() {
    std::string xml = emptyLink("root");
    for (const std::string name : {"a", "b"}) {
      xml += linkWith(name, "<sphere radius='0.5'/>") +
             joint("to_" + name, "floating", "root", name, "0 0 0", "");
    }
    return CollisionScene::build(robotFrom(xml), std::nullopt, nullptr);
  }
  CollisionDetector detector_{spheres()};
};

TEST_F(TwoSpheres, ThatTouchExactlyAreInContact) {
  const CollisionReport& report = at(1.0, alarm(0.1));
  ASSERT_EQ(report.pairs.size(), 1u);
  EXPECT_EQ(report.pairs[0].distance, 0.0);
  EXPECT_EQ(report.pairs[0].state, PairState::CONTACT);
  EXPECT_EQ(report.verdict, Verdict::COLLISION);
}

// At AABB the boxes are larger than the spheres by rounding, so the pose is searched for at which
// their faces coincide: there a distance and a direction cannot be computed from each other.
TEST_F(TwoSpheres, WhoseBoxesTouchExactlyHaveANormalAndPointsOnTheCommonFace) {
  CheckSettings settings = alarm(0.1);
  settings.fidelity = Fidelity::AABB;
  int nb_exact = 0;
  for (const double side : {-1.0, 1.0}) {
    double x = 1.0;
    for (int step = 0; step < 400; ++step, x = std::nextafter(x, 2.0)) {
      const CollisionReport& report = at(side * x, settings);
      ASSERT_EQ(report.contacts.size(), 1u);
      const Contact& contact = report.contacts[0];
      EXPECT_EQ(contact.nhat_W, side * Eigen::Vector3d::UnitX()) << "at " << side * x;
      EXPECT_NEAR(contact.p_WFirst.x(), 0.5 * side, 1e-12);
      EXPECT_NEAR(contact.p_WSecond.x(), 0.5 * side, 1e-12);
      EXPECT_EQ(report.pairs[0].state,
                report.pairs[0].distance > 0.0 ? PairState::NEAR : PairState::CONTACT);
      nb_exact += report.pairs[0].distance == 0.0;
    }
  }
  EXPECT_GT(nb_exact, 0);
}

TEST_F(TwoSpheres, ExactlyAtTheAlarmDistanceAreNearAndTheirDistanceIsNoBound) {
  const CollisionReport& report = at(1.25, alarm(0.25));
  ASSERT_EQ(report.pairs.size(), 1u);
  EXPECT_EQ(report.pairs[0].state, PairState::NEAR);
  EXPECT_EQ(report.min_distance, 0.25);
  EXPECT_FALSE(report.min_distance_is_bound);
}

TEST_F(TwoSpheres, WithVerdictOnlyHaveNoAlarmDistanceAndNoContacts) {
  CheckSettings settings = alarm(0.25);
  settings.verdict_only = true;
  const CollisionReport& apart = at(1.125, settings);
  EXPECT_EQ(apart.verdict, Verdict::FREE);
  EXPECT_TRUE(apart.candidates.empty());
  EXPECT_EQ(apart.min_distance, 0.0);
  const CollisionReport& in_contact = at(0.5, settings);
  ASSERT_EQ(in_contact.pairs.size(), 1u);
  EXPECT_EQ(in_contact.pairs[0].nb_contacts, 0u);
  EXPECT_TRUE(in_contact.contacts.empty());
}

TEST_F(TwoSpheres, AtPosesThatAreNoneAreLeftOutOrCountedAsNotSettled) {
  BodyPoses poses;
  poses.resize(2);
  poses.X_WB[1].translation().x() = 0.5;
  EXPECT_EQ(detector_.detect(poses, alarm(0.0)).nb_degraded, 0u);
  poses.X_WB[1].linear().row(1) << 0.6, 0.8, 0.0;  // a shear
  EXPECT_EQ(detector_.detect(poses, alarm(0.0)).nb_degraded, 1u);
  EXPECT_EQ(detector_.report().verdict, Verdict::UNKNOWN);
  poses.X_WB[1].linear() = 1.01 * Eigen::Matrix3d::Identity();
  const CollisionReport& report = detector_.detect(poses, alarm(0.0));
  EXPECT_EQ(report.nb_degraded, 0u);
  EXPECT_EQ(report.left_out.size(), 1u);
  EXPECT_EQ(report.verdict, Verdict::UNKNOWN);
}

/// Links of every shape, ten metres from each other along y, but for those that are moved.
class MixedLinks : public testing::Test {
 protected:
  MixedLinks() {
    poses_.resize(scene_->bodies().size());
    for (std::size_t i = 0; i < poses_.X_WB.size(); ++i) {
      poses_.X_WB[i].translation().y() = 10.0 * static_cast<double>(i + 1);
    }
  }
  Eigen::Isometry3d& poseOf(const char* link) {
    return poses_.X_WB[scene_->models()[scene_->findModel(link)].body];
  }
  std::shared_ptr<const CollisionScene> scene_ =
      CollisionScene::build(mixedRobot(), std::nullopt, nullptr);
  CollisionDetector detector_{scene_};
  BodyPoses poses_;
};

TEST_F(MixedLinks, WithTwoElementsAndNoPoseAreLeftOutOnce) {
  const int z = scene_->findModel("z");  // a mesh and a sphere
  poses_.known[scene_->models()[z].body] = 0;
  EXPECT_EQ(detector_.detect(poses_, alarm(0.0)).left_out,
            (std::vector<std::uint32_t>{static_cast<std::uint32_t>(z)}));
}

// Whichever of them is compared first.
TEST(TwoElementsOfALink, OfWhichOneIsInContactAreInContact) {
  const std::string ball = "<geometry><sphere radius='0.5'/></geometry>";
  const auto robot = robotFrom(emptyLink("root") + "<link name='a'><collision>" + ball +
                               "</collision><collision>" + "<origin xyz='3 0 0'/>" + ball +
                               "</collision></link>" + linkWith("b", "<sphere radius='0.5'/>") +
                               joint("to_a", "floating", "root", "a", "0 0 0", "") +
                               joint("to_b", "floating", "root", "b", "0 0 0", ""));
  CollisionDetector detector(CollisionScene::build(robot, std::nullopt, nullptr));
  BodyPoses poses;
  poses.resize(2);
  for (const double x : {0.75, 2.25}) {
    poses.X_WB[1].translation().x() = x;
    const CollisionReport& report = detector.detect(poses, alarm(2.0));
    ASSERT_EQ(report.pairs.size(), 1u);
    EXPECT_EQ(report.pairs[0].nb_contacts, 2u);
    EXPECT_EQ(report.pairs[0].state, PairState::CONTACT);
    EXPECT_EQ(report.pairs[0].distance, -0.25);
    EXPECT_EQ(report.verdict, Verdict::COLLISION);
  }
}

/// A link of three elements beside one of one: near, open and touching in each order.
TEST(ElementsOfALink, ThatTouchPrevailOverThoseThatAreOpenAndThoseOverNearOnes) {
  std::string elements;
  for (int i = 0; i < 3; ++i) {
    elements += "<collision><geometry><sphere radius='0.5'/></geometry></collision>";
  }
  const auto robot = robotFrom(emptyLink("root") + "<link name='a'>" + elements + "</link>" +
                               linkWith("b", "<sphere radius='0.5'/>") +
                               joint("to_a", "floating", "root", "a", "0 0 0", "") +
                               joint("to_b", "floating", "root", "b", "0 0 0", ""));
  const auto scene = CollisionScene::build(robot, std::nullopt, nullptr);
  struct Found {
    double distance;
    Certainty certainty;
    PairState state;
    Verdict verdict;
  };
  const Found kinds[] = {
      {0.25, Certainty::EXACT, PairState::NEAR, Verdict::FREE},
      {-0.5, Certainty::UNFINISHED, PairState::UNRESOLVED, Verdict::UNKNOWN},
      {-0.75, Certainty::DEGRADED, PairState::UNRESOLVED, Verdict::UNKNOWN},
      {-0.125, Certainty::EXACT, PairState::CONTACT, Verdict::COLLISION},
  };
  for (int i = 0; i < 64; ++i) {
    const std::array<int, 3> of = {i % 4, i / 4 % 4, i / 16};
    FoundPairs found;
    for (std::uint32_t k = 0; k < 3; ++k) {
      PairDistance distance;
      distance.distance = kinds[of[k]].distance;
      distance.certainty = kinds[of[k]].certainty;
      found.add(*scene, {k, 3}, distance, Fidelity::MESH, Eigen::Vector3i::Zero());
    }
    const Found& worst = kinds[*std::max_element(of.begin(), of.end())];
    const Found* nearest = &kinds[of[0]];
    for (const int one : of) {
      if (kinds[one].distance < nearest->distance) nearest = &kinds[one];
    }
    CollisionReport report;
    report.min_distance = 1.0;
    found.assemble(*scene, true, true, {}, report);
    ASSERT_EQ(report.pairs.size(), 1u);
    EXPECT_EQ(report.pairs[0].state, worst.state) << i;
    EXPECT_EQ(report.verdict, worst.verdict) << i;
    EXPECT_EQ(report.pairs[0].distance, nearest->distance) << i;
    EXPECT_EQ(report.pairs[0].certainty, nearest->certainty) << i;
    EXPECT_EQ(report.pairs[0].nb_contacts, 3u);
  }
}

TEST_F(MixedLinks, HaveTheFidelityOfTheElementsThatAreNearest) {
  poseOf("z").setIdentity();
  poseOf("c") = Eigen::Translation3d(0.55, 0, 0) * Eigen::Isometry3d::Identity();
  const CollisionReport& report = detector_.detect(poses_, alarm(0.5));
  ASSERT_EQ(report.pairs.size(), 1u);
  EXPECT_EQ(report.pairs[0].nb_contacts, 2u);  // the mesh is 0.25 m away, which its hull tells
  EXPECT_NEAR(report.pairs[0].distance, 0.1, 1e-12);  // and the sphere 0.1
  EXPECT_EQ(report.pairs[0].fidelity, Fidelity::MESH);
}

TEST_F(MixedLinks, ThatTheirHullsSettleAreReportedAsConvex) {
  poseOf("d").setIdentity();  // a mesh that reaches to x = 0.15
  poseOf("c") = Eigen::Translation3d(0.4, 0, 0) * Eigen::Isometry3d::Identity();
  const CollisionReport& report = detector_.detect(poses_, alarm(0.5));
  ASSERT_EQ(report.pairs.size(), 1u);
  EXPECT_NEAR(report.pairs[0].distance, 0.1, 1e-12);
  EXPECT_EQ(report.pairs[0].fidelity, Fidelity::CONVEX);
  EXPECT_EQ(report.nb_settled[static_cast<int>(Fidelity::CONVEX)], 1u);
}

TEST_F(MixedLinks, AtEveryRungHaveWitnessPointsThatAreAsFarApartAsTheDistanceSays) {
  RandomInputs random;
  SceneSettings of_scene;
  of_scene.max_hull_vertices = 8;
  const auto scene = CollisionScene::build(mixedRobot(), std::nullopt, nullptr, of_scene);
  CollisionDetector detector(scene);
  for (int round = 0; round < 50; ++round) {
    throwAbout(random, 0.6, poses_);
    for (const Fidelity rung : {Fidelity::AABB, Fidelity::OBB, Fidelity::CONVEX, Fidelity::MESH}) {
      CheckSettings settings = alarm(0.2);
      settings.fidelity = rung;
      for (const Contact& contact : detector.detect(poses_, settings).contacts) {
        const double along = contact.nhat_W.dot(contact.p_WSecond - contact.p_WFirst);
        EXPECT_NEAR(along, -contact.depth, 1e-6) << fidelityName(rung);
      }
    }
  }
}

// All numbers are exact in binary. The boxes and spheres about them are larger, by little.
TEST(TwoOfAShape, ExactlyAtTheAlarmDistanceAreListedAtEveryRung) {
  const auto cube = [](const std::string&, const Eigen::Vector3d&) {
    return std::make_shared<const TriangleMesh>(boxMesh({0.5, 0.5, 0.5}));
  };
  for (const char* const shape :
       {"<sphere radius='0.5'/>", "<box size='1 1 1'/>", "<mesh filename='cube'/>"}) {
    std::string xml = emptyLink("root");
    for (const std::string name : {"a", "b"}) {
      xml += linkWith(name, shape) + joint("to_" + name, "floating", "root", name, "0 0 0", "");
    }
    CollisionDetector detector(
        CollisionScene::build(RobotModel::fromUrdf("<robot name='two'>" + xml + "</robot>", cube),
                              std::nullopt, nullptr));
    BodyPoses poses;
    poses.resize(2);
    poses.X_WB[1].translation().x() = 1.25;
    for (const Fidelity rung :
         {Fidelity::AABB, Fidelity::SPHERES, Fidelity::OBB, Fidelity::CONVEX, Fidelity::MESH}) {
      CheckSettings settings = alarm(0.25);
      settings.fidelity = rung;
      const CollisionReport& report = detector.detect(poses, settings);
      ASSERT_EQ(report.pairs.size(), 1u) << shape << " at " << fidelityName(rung);
      EXPECT_LE(report.pairs[0].distance, 0.25) << shape << " at " << fidelityName(rung);
      EXPECT_NEAR(report.pairs[0].distance, 0.25, 0.001) << shape << " at " << fidelityName(rung);
    }
  }
}

// Along an axis of both, the boxes about two spheres are as far apart as the spheres, but for
// rounding.
TEST(TinySpheres, ExactlyAtTheAlarmDistanceAreFoundHoweverTheyAreTurned) {
  std::string xml = emptyLink("root");
  for (const std::string name : {"a", "b"}) {
    xml += linkWith(name, "<sphere radius='1e-5'/>") +
           joint("to_" + name, "floating", "root", name, "0 0 0", "");
  }
  CollisionDetector detector(CollisionScene::build(robotFrom(xml), std::nullopt, nullptr));
  RandomInputs random;
  for (int round = 0; round < 1000; ++round) {
    const Eigen::Isometry3d X_WA = random.pose(0.1);
    BodyPoses poses;
    poses.resize(2);
    poses.X_WB[0] = X_WA;
    poses.X_WB[1] = X_WA * Eigen::Translation3d(random.uniform(1.0, 2.0), 0, 0);
    const double distance = detector.detect(poses, alarm(3.0)).min_distance;
    EXPECT_EQ(detector.detect(poses, alarm(distance)).pairs.size(), 1u) << distance;
  }
}

}  // namespace collision_pairs::test_pair_reports
