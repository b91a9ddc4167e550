// What must not fool the bounds of a motion: each in a case where a simpler bound would be wrong.
#include <cmath>
#include <sstream>

#include <gtest/gtest.h>

#include "collision_pairs/collision_detector.h"
#include "motion_fixtures.h"
#include "random_inputs.h"
#include "test_shapes.h"

namespace collision_pairs::test_motion_pitfalls {

/// The oracle: is any of many states along the motion in contact?
bool isTouchedIn(const std::shared_ptr<const CollisionScene>& scene, const JointMotion& motion,
                 int nb_samples) {
  CollisionDetector detector(scene);
  std::vector<Eigen::Isometry3d> X_RB;
  BodyPoses poses;
  for (int k = 0; k <= nb_samples; ++k) {
    std::vector<double> q(motion.from.size());
    for (std::size_t i = 0; i < q.size(); ++i) {
      q[i] = motion.from[i] + (motion.to[i] - motion.from[i]) * k / nb_samples;
    }
    scene->robot().applyMimics(q);
    scene->robot().forwardKinematics(q, X_RB);
    scene->gatherPoses(X_RB, poses);
    if (detector.detect(poses, {}).verdict != Verdict::FREE) return true;
  }
  return false;
}

// Half-way the arm is folded, and no point of it is further than 0.1 m from the shoulder's axis: by
// that radius the arm would hardly move.
TEST(MotionPitfalls, TheRadiusAtOnePoseIsNoBoundForTheSegment) {
  const auto robot = robotFrom(emptyLink("root") + emptyLink("upper") + bar("lower", 1.0) +
                               hinge("shoulder", "root", "upper", "0 0 0") +
                               hinge("elbow", "upper", "lower", "1 0 0"));
  RandomInputs random;
  int nb_free = 0, nb_contacts = 0;
  for (int i = 0; i < 200; ++i) {
    const double angle = random.uniform(-3.0, 3.0), radius = random.uniform(0.3, 2.2);
    const auto scene =
        sceneOf(robot, {boxAt("post", {radius * std::cos(angle), radius * std::sin(angle), 0.0},
                              {0.02, 0.02, 0.2})});
    const JointMotion motion{{-1.0, M_PI - random.uniform(1.0, 3.0)},
                             {1.0, M_PI + random.uniform(1.0, 3.0)}};
    const MotionReport report = MotionCheck(scene).check(motion, {});
    const bool touched = isTouchedIn(scene, motion, 1000);
    EXPECT_FALSE(touched && report.verdict == Verdict::FREE) << "post " << i;
    if (report.verdict == Verdict::COLLISION) ++nb_contacts;
    if (report.verdict == Verdict::FREE) ++nb_free;
  }
  EXPECT_GT(nb_free, 20);
  EXPECT_GT(nb_contacts, 20);
}

TEST(MotionPitfalls, ASlidingJointLengthensTheRadius) {
  const auto robot = robotFrom(emptyLink("root") + emptyLink("turret") + bar("boom", 0.2) +
                               hinge("turn", "root", "turret", "0 0 0") +
                               joint("slide", "prismatic", "turret", "boom", "0 0 0",
                                     "<axis xyz='1 0 0'/><limit lower='0' upper='9'/>"));
  // Drawn in half-way, it is out at both ends and sweeps the plate there.
  const auto scene = sceneOf(robot, {boxAt("plate", {0.0, 2.9, 0.0}, {0.002, 0.5, 0.2})});
  EXPECT_EQ(checked(scene, {0.0, 0.0}, {2.0 * M_PI / 3.0, 4.0}).verdict, Verdict::COLLISION);
  EXPECT_EQ(checked(scene, {0.0, 0.0}, {2.0 * M_PI / 3.0, 2.0}).verdict, Verdict::FREE);
}

TEST(MotionPitfalls, JointsThatMimicMoveToo) {
  const std::string slide = "<axis xyz='1 0 0'/><limit lower='-100' upper='100'/>";
  const auto robot =
      robotFrom(emptyLink("root") + boxLink("leader", 0.1) + boxLink("follower", 0.1) +
                joint("lead", "prismatic", "root", "leader", "0 5 0", slide) +
                joint("follow", "prismatic", "root", "follower", "0 0 0",
                      slide + "<mimic joint='lead' multiplier='-20' offset='3'/>"));
  const auto scene = sceneOf(robot, {boxAt("plate", {0.0, 0.0, 0.0}, {0.002, 1.0, 1.0})});
  ASSERT_EQ(robot->findJoint("lead"), 1);
  // The follower goes from 3 to -3; what the motion says of it is not looked at.
  const MotionReport report = checked(scene, {0.0, 0.0}, {0.0, 0.3});
  EXPECT_EQ(report.verdict, Verdict::COLLISION);
  EXPECT_NEAR(report.contact_at, 0.5, 0.01);
  EXPECT_EQ(checked(scene, {NAN_POSITION, 0.0}, {7.0, 0.1}).verdict, Verdict::FREE);
}

TEST(MotionPitfalls, JointsThatTurnOnGoTheWayTheNumbersSay) {
  const auto scene = sceneOf(turningBar(), {boxAt("plate", {0.8, 0.0, 0.0}, {0.2, 0.002, 0.2})});
  EXPECT_EQ(checked(scene, {3.0}, {-3.0}).verdict, Verdict::COLLISION);         // through 0
  EXPECT_EQ(checked(scene, {3.0}, {2.0 * M_PI - 3.0}).verdict, Verdict::FREE);  // through pi
  const MotionReport twice = checked(scene, {1.0}, {1.0 + 4.0 * M_PI});
  EXPECT_EQ(twice.verdict, Verdict::COLLISION);
}

TEST(MotionPitfalls, FloatingAndPlanarJointsStandAtIdentityOrWhereTheyArePlaced) {
  for (const std::string type : {"floating", "planar"}) {
    const auto robot =
        robotFrom(emptyLink("root") + emptyLink("base") + bar("arm", 1.0) +
                  joint("float", type, "root", "base", "0 0 0", "<axis xyz='0 0 1'/>") +
                  hinge("turn", "base", "arm", "0 0 0"));
    const auto scene = sceneOf(robot, {boxAt("plate", {0.8, 0.0, 0.0}, {0.2, 0.002, 0.2})});
    EXPECT_EQ(checked(scene, {0.0, -1.0}, {0.0, 1.0}).verdict, Verdict::COLLISION) << type;
    // What stands there for the joint itself moves nothing.
    EXPECT_EQ(checked(scene, {0.0, 0.3}, {9.0, 1.0}).verdict, Verdict::FREE) << type;

    PlacedBodies placed(robot->bodies().size());
    const int base = robot->links()[robot->findLink("base")].body;
    placed[base] = Eigen::Translation3d(0.0, 0.0, 0.2) * Eigen::Isometry3d::Identity();
    EXPECT_EQ(checked(scene, {0.0, -1.0}, {0.0, 1.0}, {}, placed).verdict, Verdict::FREE) << type;
    placed[base] =
        Eigen::AngleAxisd(-2.0, Eigen::Vector3d::UnitZ()) * Eigen::Isometry3d::Identity();
    EXPECT_EQ(checked(scene, {0.0, 0.0}, {0.0, 1.5}, {}, placed).verdict, Verdict::FREE) << type;
    EXPECT_EQ(checked(scene, {0.0, 0.0}, {0.0, 2.5}, {}, placed).verdict, Verdict::COLLISION)
        << type;
  }
}

TEST(MotionPitfalls, AJointThatIsPlacedDoesNotMove) {
  const auto robot = turningBar();
  const auto scene = sceneOf(robot, {boxAt("plate", {0.8, 0.0, 0.0}, {0.2, 0.002, 0.2})});
  PlacedBodies placed(robot->bodies().size());
  placed[robot->links()[robot->findLink("arm")].body] =
      Eigen::AngleAxisd(1.0, Eigen::Vector3d::UnitZ()) * Eigen::Isometry3d::Identity();
  EXPECT_EQ(checked(scene, {-1.0}, {1.0}, {}, placed).verdict, Verdict::FREE);
}

TEST(MotionPitfalls, PlacedBodiesAreThoseOfTheRobotOrNone) {
  const auto scene = sceneOf(turningBar(), {boxAt("plate", {0.8, 0.0, 0.0}, {0.2, 0.002, 0.2})});
  const std::size_t nb_bodies = scene->robot().bodies().size();
  for (const std::size_t number : {nb_bodies - 1, nb_bodies + 1}) {
    EXPECT_THROW(checked(scene, {-1.0}, {1.0}, {}, PlacedBodies(number)), InputError) << number;
  }
  EXPECT_EQ(checked(scene, {-1.0}, {1.0}, {}, PlacedBodies(nb_bodies)).verdict, Verdict::COLLISION);
}

TEST(MotionPitfalls, AnAttachedObjectReachesFurtherThanItsLink) {
  RigidObject pole = boxAt("pole", {1.5, 0.0, 0.0}, {1.0, 0.02, 0.02});
  pole.attached_link = "arm";
  const RigidObject plate = boxAt("plate", {1.8, 0.0, 0.0}, {0.1, 0.002, 0.2});
  EXPECT_EQ(checked(sceneOf(turningBar(), {plate}), {-1.0}, {1.3}).verdict, Verdict::FREE);
  const auto scene = sceneOf(turningBar(), {plate, pole});
  const MotionReport report = checked(scene, {-1.0}, {1.3});
  EXPECT_EQ(report.verdict, Verdict::COLLISION);
  ASSERT_EQ(report.pairs.size(), 1u);
  EXPECT_EQ(scene->models()[report.pairs[0].second].name, "pole");
}

TEST(MotionPitfalls, PaddingIsTakenOffTheDistance) {
  // Slides by at 4 mm.
  const auto plate = boxAt("plate", {0.0, 0.505, 0.0}, {0.2, 0.002, 0.2});
  SceneDescription description = described(slidingBox(), {plate});
  const auto bare = CollisionScene::build(description);
  EXPECT_EQ(checked(bare, {-2.0}, {2.0}).verdict, Verdict::FREE);
  EXPECT_LE(checked(bare, {-2.0}, {2.0}).clearance, 0.004);
  description.settings.padding = 0.003;
  const auto padded = CollisionScene::build(description);
  EXPECT_EQ(checked(padded, {-2.0}, {2.0}).verdict, Verdict::FREE);
  EXPECT_LE(checked(padded, {-2.0}, {2.0}).clearance, 0.001);
  description.settings.padding = 0.005;
  EXPECT_EQ(checked(CollisionScene::build(description), {-2.0}, {2.0}).verdict, Verdict::COLLISION);
}

// In the hull of a mesh, where only the distance of the shapes is of use: it is sought up to what
// would be enough, and not a rounding less may be left of that.
TEST(MotionPitfalls, WhatStandsStillIsCertifiedWhereItKeepsTheClearanceAndTheResolution) {
  RandomInputs random;
  for (int i = 0; i < 2000; ++i) {
    const double gap = random.uniform(0.02, 0.2), wall = 0.5 + gap + 0.05;
    RigidObject channel;
    channel.name = "channel";
    channel.elements.push_back(
        {meshShape(joined(joined(movedBy(boxMesh({1.5, 0.05, 1}), {0, wall, 0}),
                                 movedBy(boxMesh({1.5, 0.05, 1}), {0, -wall, 0})),
                          movedBy(boxMesh({0.05, 1.2, 1}), {1.6, 0, 0}))),
         Eigen::Isometry3d::Identity()});
    SceneDescription description = described(slidingBox(), {channel});
    description.settings.padding = random.integer(0, 1) ? random.uniform(0.0, 0.01) : 0.0;
    MotionSettings settings;
    settings.clearance =
        random.uniform(0.0, gap - description.settings.padding - settings.resolution);
    const auto scene = CollisionScene::build(description);
    ASSERT_EQ(checked(scene, {0.0}, {0.0}, settings).verdict, Verdict::FREE) << i;
  }
}

TEST(MotionPitfalls, ZeroClearanceIsNeverCertified) {
  RandomInputs random;
  for (int i = 0; i < 100; ++i) {
    // A cube slides along a plate that it touches; both turned, so that rounding takes part.
    const Eigen::Isometry3d X = random.pose(random.uniform(0.0, 10.0));
    SceneDescription description =
        described(slidingBox(), {boxAt("plate", {0.0, 0.5 + 0.001, 0.0}, {0.2, 0.002, 0.2})});
    description.robots[0].X_WR = X;
    description.objects[0].X_PO = X * description.objects[0].X_PO;
    EXPECT_NE(checked(CollisionScene::build(description), {-2.0}, {2.0}).verdict, Verdict::FREE);
  }
}

TEST(MotionPitfalls, BoundsAreRoundedOutwardsFarFromTheOrigin) {
  RandomInputs random;
  for (int i = 0; i < 30; ++i) {
    // The gap is a micrometre, and 1e10 m away positions are no more exact than that.
    Eigen::Isometry3d X = random.pose(1.0);
    X.translation() *= 1e10;
    SceneDescription description =
        described(slidingBox(), {boxAt("plate", {0.0, 0.501001, 0.0}, {0.2, 0.002, 0.2})});
    EXPECT_EQ(checked(CollisionScene::build(description), {-2.0}, {2.0}).verdict, Verdict::FREE);
    description.robots[0].X_WR = X;
    description.objects[0].X_PO = X * description.objects[0].X_PO;
    EXPECT_NE(checked(CollisionScene::build(description), {-2.0}, {2.0}).verdict, Verdict::FREE);
  }
}

TEST(MotionPitfalls, BoundsAreRoundedOutwardsForJointsThatHaveTurnedFar) {
  // At 1e10 rad a joint's position is no more exact than 2e-6 rad; the gap is a micrometre.
  const auto scene =
      sceneOf(turningBar(), {boxAt("plate", {1.2, 0.0, 0.0111}, {1.0, 9.0, 0.0022 - 2e-6})});
  for (const double from : {0.0, 1e10}) {
    const Verdict verdict = checked(scene, {from}, {from + 0.5}).verdict;
    EXPECT_EQ(verdict == Verdict::FREE, from == 0.0) << from;
  }
}

// A cube that turns about its diagonal: its box grows on all three axes at once, so that the corner
// of the box is faster than any point of the cube.
TEST(MotionPitfalls, AnAlignedBoxMayGrowOnAllAxesAtOnce) {
  const Eigen::Vector3d diagonal = Eigen::Vector3d::Ones().normalized();
  const auto robot =
      robotFrom(emptyLink("root") + boxLink("cube", 1.0) +
                joint("turn", "continuous", "root", "cube", "0 0 0", "<axis xyz='1 1 1'/>"));
  const auto halfSizeAt = [&](double angle) {
    return 0.5 * Eigen::AngleAxisd(angle, diagonal).toRotationMatrix().row(0).cwiseAbs().sum();
  };
  constexpr double MIDDLE = 0.01;  // where it grows fastest, nearly
  MotionSettings settings;
  settings.fidelity = Fidelity::AABB;
  for (const double gap : {1e-3, 1e-2}) {  // on each axis
    const double corner = halfSizeAt(MIDDLE) + gap;
    const auto scene =
        sceneOf(robot, {boxAt("post", Eigen::Vector3d::Constant(corner + 0.5), {1.0, 1.0, 1.0})});
    double way = 0.0;  // to where the boxes meet
    while (halfSizeAt(MIDDLE + way) < corner) way += 1e-3 * gap;
    EXPECT_NE(checked(scene, {MIDDLE - way}, {MIDDLE + way}, settings).verdict, Verdict::FREE);
    EXPECT_EQ(checked(scene, {MIDDLE - way}, {MIDDLE + 0.5 * way}, settings).verdict,
              Verdict::FREE);
  }
}

TEST(MotionPitfalls, AHalfSpaceThatTurnsIsNeverCertified) {
  RigidObject wall = floorAt(-5.0, {});
  wall.attached_link = "arm";
  const auto scene = sceneOf(turningBar(), {wall, boxAt("box", {3.0, 0.0, 3.0}, {1.0, 1.0, 1.0})});
  try {
    EXPECT_NE(checked(scene, {-1.0}, {1.0}).verdict, Verdict::FREE);
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("floor"), std::string::npos);
  }
}

// As the contact points of a foot. Relative to their size every motion is large.
TEST(MotionPitfalls, ElementsOfNoSizeAreCertifiedAtOnceWhateverWasAskedBefore) {
  for (const double radius : {0.0, 1e-9, 1e-6, 1e-3}) {
    std::ostringstream sphere;
    sphere << "<sphere radius='" << radius << "'/>";
    const auto robot =
        robotFrom(emptyLink("root") + linkWith("tip", sphere.str()) + boxLink("foot", 0.1) +
                  joint("x", "prismatic", "root", "tip", "0 0 0",
                        "<axis xyz='1 0 0'/><limit lower='-1' upper='1'/>") +
                  joint("fixed", "fixed", "tip", "foot", "0 0 0.2"));
    RigidObject pin = boxAt("pin", {0.0, 2.0 * radius + 4e-4, 0.0}, {1.0, 1.0, 1.0});
    pin.elements[0].shape = Sphere{radius};
    MotionCheck check(sceneOf(robot, {pin}));
    MotionSettings settings;
    settings.only_free = true;
    const auto verdict = [&](double clearance) {
      settings.clearance = clearance;
      const MotionReport& report = check.check({{-0.3, 0.0}, {0.12, 0.0}}, settings);
      EXPECT_LT(report.nb_checks, 300u) << radius;
      return report.verdict;
    };
    EXPECT_EQ(verdict(0.0), Verdict::FREE);
    EXPECT_EQ(verdict(0.001), Verdict::UNKNOWN);
    RandomInputs random;
    settings.clearance = 0.0;
    for (int i = 0; i < 20000; ++i) {  // until the batch stage is made
      check.check({{random.uniform(-1.0, 1.0), 0.0}, {random.uniform(-1.0, 1.0), 0.0}}, settings);
    }
    EXPECT_EQ(verdict(0.0), Verdict::FREE);
  }
}

}  // namespace collision_pairs::test_motion_pitfalls
