// How fast two links come nearer, and when they can touch at the earliest, beside what the exact
// check says of where they would be.
#include <cmath>

#include <gtest/gtest.h>

#include "collision_pairs/closing_motion.h"
#include "collision_pairs/collision_detector.h"
#include "motion_fixtures.h"
#include "random_inputs.h"
#include "test_shapes.h"

namespace collision_pairs::test_closing_motion {

using Eigen::AngleAxisd;
using Eigen::Isometry3d;
using Eigen::Vector3d;

constexpr double WINDOW = 0.1;

std::shared_ptr<const TriangleMesh> lShape(const std::string&, const Vector3d&) {
  return std::make_shared<const TriangleMesh>(LShape().mesh());
}

Isometry3d at(double x, double y, double z) {
  return Eigen::Translation3d(x, y, z) * Isometry3d::Identity();
}

std::string collision(const std::string& geometry, const std::string& xyz) {
  return "<collision><origin xyz='" + xyz + "'/><geometry>" + geometry + "</geometry></collision>";
}

/// `geometry`: of one element, or several collision().
std::string linkOf(const std::string& name, const std::string& geometry,
                   const std::string& origin = "") {
  return geometry.rfind("<collision>", 0) == 0 ? "<link name='" + name + "'>" + geometry + "</link>"
                                               : linkWith(name, geometry, origin);
}

/// Links a and b, wherever the test puts them, and perhaps objects.
class TwoLinks {
 public:
  TwoLinks(const std::string& geometry_a, const std::string& geometry_b,
           std::vector<RigidObject> objects = {}, double padding = 0.0,
           const std::string& origin_b = "") {
    SceneDescription description = described(
        RobotModel::fromUrdf("<robot name='r'>" + emptyLink("root") + linkOf("a", geometry_a) +
                                 linkOf("b", geometry_b, origin_b) +
                                 joint("to_a", "floating", "root", "a", "0 0 0", "") +
                                 joint("to_b", "floating", "root", "b", "0 0 0", "") + "</robot>",
                             lShape),
        std::move(objects));
    description.settings.padding = padding;
    scene_ = CollisionScene::build(description);
    detector_ = std::make_unique<CollisionDetector>(scene_);
    before.window = WINDOW;
    settings.alarm_distance = 0.5;
  }

  const CollisionReport& check(const Isometry3d& X_WA, const Isometry3d& X_WB) {
    now = {{X_WA, X_WB}, {1, 1}, {}};
    return detector_->detect(now, settings);
  }

  /// Of the only pair; it must be there.
  ClosingMotion closing(const Isometry3d& X_WA, const Isometry3d& X_WB,
                        const Isometry3d& X_WA_before, const Isometry3d& X_WB_before) {
    before.poses = {{X_WA_before, X_WB_before}, known_before, {}};
    const CollisionReport& report = check(X_WA, X_WB);
    EXPECT_EQ(report.pairs.size(), 1u);
    if (report.pairs.empty()) return {};
    return closingMotion(*scene_, report, report.pairs[0], now, before);
  }

  /// Of one pair of several; it must be there.
  ClosingMotion closingOf(const std::string& first, const std::string& second,
                          const Isometry3d& X_WA, const Isometry3d& X_WB,
                          const Isometry3d& X_WA_before, const Isometry3d& X_WB_before) {
    before.poses = {{X_WA_before, X_WB_before}, known_before, {}};
    const CollisionReport& report = check(X_WA, X_WB);
    for (const PairReport& pair : report.pairs) {
      if (scene_->models()[pair.first].name == first &&
          scene_->models()[pair.second].name == second)
        return closingMotion(*scene_, report, pair, now, before);
    }
    ADD_FAILURE() << "no pair of " << first << " and " << second;
    return {};
  }

  CheckSettings settings;
  BodyPoses now;
  EarlierPoses before;
  std::vector<char> known_before = {1, 1};

 private:
  std::shared_ptr<const CollisionScene> scene_;
  std::unique_ptr<CollisionDetector> detector_;
};

const std::string BALL = "<sphere radius='0.5'/>", CUBE = "<box size='1 1 1'/>";

TEST(ClosingMotion, TwoThatMeetHeadOnCloseByBothTheirSpeeds) {
  TwoLinks links(BALL, CUBE);
  const ClosingMotion closing =
      links.closing(at(0, 0, 0), at(1.3, 0, 0), at(-0.01, 0, 0), at(1.32, 0, 0));
  EXPECT_TRUE(closing.known);
  EXPECT_NEAR(closing.closing_speed, 0.3, 1e-9);
  EXPECT_NEAR(closing.time_to_contact, 1.0, 2e-5);
}

TEST(ClosingMotion, TwoThatPartAreNotSlowed) {
  TwoLinks links(CUBE, BALL);
  const ClosingMotion closing =
      links.closing(at(0, 0, 0), at(1.01, 0, 0), at(0, 0, 0), at(1.005, 0, 0));
  EXPECT_NEAR(closing.closing_speed, -0.05, 1e-9);
  EXPECT_EQ(closing.time_to_contact, ClosingMotion::HORIZON);
}

TEST(ClosingMotion, TwoThatMoveTogetherAreNotSlowedHoweverTheyTurn) {
  TwoLinks links(CUBE, CUBE);
  const Isometry3d X_WT = at(0.3, 2.0, 0.1) * AngleAxisd(1.1, Vector3d::UnitZ());
  const Isometry3d X_WT_before = AngleAxisd(0.7, Vector3d(1, 2, 3).normalized()) * at(0.2, 2, 0);
  const Isometry3d X_TA = at(4, 0, 0), X_TB = at(5.001, 0.2, 0);
  const ClosingMotion closing =
      links.closing(X_WT * X_TA, X_WT * X_TB, X_WT_before * X_TA, X_WT_before * X_TB);
  EXPECT_TRUE(closing.known);
  EXPECT_NEAR(closing.closing_speed, 0.0, 1e-9);
  EXPECT_NEAR(closing.time_to_contact, ClosingMotion::HORIZON, 1e-6);
}

TEST(ClosingMotion, OneThatSlidesAlongAWallIsNotSlowed) {
  TwoLinks links(CUBE, CUBE);
  const ClosingMotion closing =
      links.closing(at(0, 0, 0), at(1.01, 0, 0), at(0, 0, 0), at(1.01, -0.02, 0));
  EXPECT_NEAR(closing.closing_speed, 0.0, 1e-9);
  EXPECT_EQ(closing.time_to_contact, ClosingMotion::HORIZON);
}

TEST(ClosingMotion, ALinkThatTurnsClosesByItsAngleTimesItsRadius) {
  // Link b is nearest 0.5 m from where it turns about z: towards a at 0.2 rad/s.
  TwoLinks links(BALL, "<box size='2 0.1 0.1'/>");
  const Isometry3d X_WB_before = at(0.5, 1.0, 0) * AngleAxisd(0.02, Vector3d::UnitZ());
  const ClosingMotion turning =
      links.closing(at(0, 0, 0), at(0.5, 1.0, 0), at(0, 0, 0), X_WB_before);
  EXPECT_NEAR(turning.closing_speed, -0.1, 1e-9);
  const ClosingMotion back = links.closing(at(0, 0, 0), at(0.5, 1.0, 0), at(0, 0, 0),
                                           at(0.5, 1.0, 0) * AngleAxisd(-0.02, Vector3d::UnitZ()));
  EXPECT_NEAR(back.closing_speed, 0.1, 1e-9);
  EXPECT_GT(back.time_to_contact, 1.0);
  EXPECT_LT(back.time_to_contact, 0.45 / 0.1 + 1.0);
}

TEST(ClosingMotion, AFloorStandsStillAndPaddingIsKept) {
  TwoLinks links(BALL, BALL, {floorAt(0.0, {})}, 0.02);
  for (const double window : {WINDOW, 0.5}) {
    links.before.window = window;
    const ClosingMotion closing =
        links.closing(at(0, 0, 0.8), at(9, 0, 9), at(0, 0, 0.9), at(9, 0, 9));
    EXPECT_NEAR(closing.closing_speed, 0.1 / window, 1e-9);
    EXPECT_NEAR(closing.time_to_contact, 0.28 * window / 0.1, 2e-5);  // 0.3 m less the padding
  }
}

// It is over the floor by 5 cm where its circle of 3 m is highest, and level with the floor.
TEST(ClosingMotion, WhatCirclesOverAFloorComesDownAsItsCircleDoes) {
  TwoLinks links(BALL, BALL, {floorAt(0.0, {})}, 0.0, "<origin xyz='0 0 3'/>");
  const Isometry3d X_WB = at(0, 0, 0.55 - 3.0), X_WA = at(9, 0, 9);
  const ClosingMotion closing =
      links.closing(X_WA, X_WB, X_WA, X_WB * AngleAxisd(-0.2, Vector3d::UnitY()));
  EXPECT_NEAR(closing.closing_speed, 0.0, 1e-9);
  const double contact = std::acos(1.0 - 0.05 / 3.0) * WINDOW / 0.2;
  EXPECT_LT(closing.time_to_contact, contact);
  EXPECT_GT(closing.time_to_contact, 0.8 * contact);
}

TEST(ClosingMotion, InContactTheTimeIsZeroAndTheDepthGrows) {
  TwoLinks links(BALL, BALL);
  const ClosingMotion closing =
      links.closing(at(0, 0, 0), at(0.9, 0, 0), at(0, 0, 0), at(0.93, 0, 0));
  EXPECT_TRUE(closing.known);
  EXPECT_NEAR(closing.closing_speed, 0.3, 1e-9);
  EXPECT_EQ(closing.time_to_contact, 0.0);
}

TEST(ClosingMotion, WhatWasNotSeenAtBothInstantsIsUnknownAndZero) {
  const auto expectUnknown = [](TwoLinks& links) {
    const ClosingMotion closing =
        links.closing(at(0, 0, 0), at(1.3, 0, 0), at(-0.01, 0, 0), at(1.32, 0, 0));
    EXPECT_FALSE(closing.known);
    EXPECT_EQ(closing.closing_speed, 0.0);
    EXPECT_EQ(closing.time_to_contact, 0.0);
  };
  TwoLinks unseen(BALL, CUBE);
  unseen.known_before = {1, 0};
  expectUnknown(unseen);
  TwoLinks instant(BALL, CUBE);
  instant.before.window = 0.0;
  expectUnknown(instant);
  TwoLinks touching("<sphere radius='1'/>", CUBE);  // of a contact alone no place is known
  touching.settings.verdict_only = true;
  expectUnknown(touching);
}

TEST(ClosingMotion, WhatIsNoPoseAtOneOfTheInstantsIsUnknown) {
  for (const double scale : {-1.0, 0.0, 0.5, 0.998, 1.002, 2.0}) {
    TwoLinks links(BALL, CUBE);
    Isometry3d X_WB_before = at(1.32, 0, 0);
    EXPECT_TRUE(links.closing(at(0, 0, 0), at(1.3, 0, 0), at(0, 0, 0), X_WB_before).known);
    X_WB_before.linear() *= scale;
    EXPECT_FALSE(links.closing(at(0, 0, 0), at(1.3, 0, 0), at(0, 0, 0), X_WB_before).known)
        << scale;
  }
}

/// Where b would be after `t`, seen from a, by the words of ClosingMotion.
Isometry3d ahead(const Isometry3d& X_AB, const Isometry3d& X_AB_before, double t) {
  const AngleAxisd turn(X_AB.linear() * X_AB_before.linear().transpose());
  Isometry3d X = Isometry3d::Identity();
  X.linear() = AngleAxisd(turn.angle() * t / WINDOW, turn.axis()) * X_AB.linear();
  X.translation() =
      X_AB.translation() + (X_AB.translation() - X_AB_before.translation()) * (t / WINDOW);
  return X;
}

// Past the near ball of a into the one that is 1.5 m away.
TEST(ClosingMotion, AnElementThatIsOutOfReachMayBeMetFirst) {
  TwoLinks links(collision(BALL, "0 0 0") + collision(BALL, "2 1.04 0"), BALL);
  for (const double alarm_distance : {0.05, 0.5, 1.5}) {
    links.settings.alarm_distance = alarm_distance;
    const ClosingMotion closing =
        links.closing(at(0, 0, 0), at(0, 1.04, 0), at(0, 0, 0), at(-0.1, 1.04, 0));
    EXPECT_NEAR(closing.time_to_contact, 1.0, 2e-5) << alarm_distance;
  }
}

// The contacts of a with either come before those of b with the object in the report.
TEST(ClosingMotion, OfAPairIsTheSameBesideOtherPairs) {
  RandomInputs random;
  int nb_beside = 0, nb_before_the_horizon = 0;
  for (int i = 0; i < 300; ++i) {
    std::string of_b;
    RigidObject object = boxAt("object", random.vector(-0.6, 0.6), Vector3d(0.1, 0.2, 0.3));
    for (int k = 0; k < 2; ++k) {
      const Vector3d p = random.vector(-0.5, 0.5);
      of_b += collision("<box size='0.2 0.1 0.3'/>",
                        std::to_string(p.x()) + " " + std::to_string(p.y()) + " 0.3");
      object.elements.push_back({Box{Vector3d(0.3, 0.1, 0.2)}, random.pose(0.6)});
    }
    TwoLinks links(BALL, of_b, {object});
    const Isometry3d X_WB = random.pose(0.6), X_WB_before = X_WB * random.pose(0.05);
    const auto closingBeside = [&](const Isometry3d& X_WA) {
      return links.closingOf("b", "object", X_WA, X_WB, X_WA, X_WB_before);
    };
    if (links.check(at(50, 0, 0), X_WB).pairs.empty()) continue;
    const ClosingMotion expected = closingBeside(at(50, 0, 0)), found = closingBeside(at(0, 0, 0));
    EXPECT_EQ(found.closing_speed, expected.closing_speed) << i;
    EXPECT_EQ(found.time_to_contact, expected.time_to_contact) << i;
    nb_beside += links.check(at(0, 0, 0), X_WB).pairs.size() > 1;
    nb_before_the_horizon +=
        expected.time_to_contact > 0.0 && expected.time_to_contact < ClosingMotion::HORIZON;
  }
  EXPECT_GT(nb_beside, 50);
  EXPECT_GT(nb_before_the_horizon, 50);
}

TEST(ClosingMotion, NothingTouchesBeforeItsTime) {
  const std::string shapes[] = {BALL, CUBE, "<box size='0.5 0.1 0.002'/>",
                                "<cylinder radius='0.1' length='0.6'/>", "<mesh filename='l'/>"};
  RandomInputs random;
  int nb_pairs = 0, nb_before_the_horizon = 0, nb_tight = 0;
  for (int i = 0; i < 1000; ++i) {
    const auto geometry = [&] {
      const std::string one = shapes[random.integer(0, 4)], other = shapes[random.integer(0, 4)];
      const Vector3d p = random.vector(-1.0, 1.0);
      if (random.integer(0, 1)) return one;
      return collision(one, "0 0 0") +
             collision(other, std::to_string(p.x()) + " " + std::to_string(p.y()) + " 0.3");
    };
    TwoLinks links(geometry(), geometry());
    links.settings.alarm_distance = random.integer(0, 1) ? 0.5 : 0.1;
    const Isometry3d X_WA = random.pose(0.1), X_AB = random.pose(0.9);
    if (links.check(X_WA, X_WA * X_AB).pairs.empty()) continue;
    // Both move; what one sees of the other is drawn.
    const Vector3d turn = random.vector(-0.2, 0.2);
    Isometry3d X_AB_before = Isometry3d::Identity();
    X_AB_before.linear() = AngleAxisd(turn.norm(), turn.normalized()) * X_AB.linear();
    X_AB_before.translation() = X_AB.translation() + random.vector(-0.1, 0.1);
    const Isometry3d X_WA_before = random.pose(0.1);
    const ClosingMotion closing =
        links.closing(X_WA, X_WA * X_AB, X_WA_before, X_WA_before * X_AB_before);
    ASSERT_TRUE(closing.known);
    if (closing.time_to_contact == 0.0) continue;
    ++nb_pairs;
    const auto touches = [&](double t) {
      return links.check(X_WA, X_WA * ahead(X_AB, X_AB_before, t)).in_collision;
    };
    for (int k = 0; k <= 100; ++k) {
      const double t = closing.time_to_contact * (1.0 - 1e-6) * k / 100.0;
      ASSERT_FALSE(touches(t)) << "case " << i << " at " << t << " of " << closing.time_to_contact;
    }
    if (closing.time_to_contact == ClosingMotion::HORIZON) continue;
    ++nb_before_the_horizon;
    for (int k = 0; k <= 20; ++k) {
      if (!touches(closing.time_to_contact * (1.0 + 0.05 * k))) continue;
      ++nb_tight;
      break;
    }
  }
  EXPECT_GT(nb_pairs, 200);
  EXPECT_GT(nb_before_the_horizon, 100);
  EXPECT_GT(nb_tight, 30);
}

}  // namespace collision_pairs::test_closing_motion
