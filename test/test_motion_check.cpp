// Motions between two states: what is certified, what is found, what is refused.
#include <cmath>

#include <gtest/gtest.h>
#include <sys/resource.h>

#include "collision_pairs/input_error.h"
#include "motion_fixtures.h"
#include "random_inputs.h"
#include "refusal.h"

namespace collision_pairs::test_motion_check {

/// Two bars of 1 m; the second is hinged at the end of the first.
std::shared_ptr<const RobotModel> foldingArm() {
  return robotFrom(emptyLink("root") + bar("upper", 1.0) + bar("lower", 1.0) +
                   hinge("shoulder", "root", "upper", "0 0 0") +
                   hinge("elbow", "upper", "lower", "1 0 0.03"));
}

TEST(MotionCheck, AThinPlateBetweenFreeEndsIsFound) {
  const auto scene = sceneOf(turningBar(), {boxAt("plate", {0.8, 0.0, 0.0}, {0.2, 0.002, 0.2})});
  const MotionReport report = checked(scene, {-1.0}, {1.3});
  EXPECT_EQ(report.verdict, Verdict::COLLISION);
  EXPECT_NEAR(report.contact_at, 1.0 / 2.3, 0.02);
  ASSERT_EQ(report.pairs.size(), 1u);
  EXPECT_EQ(scene->models()[report.pairs[0].first].name, "arm");
  EXPECT_EQ(scene->models()[report.pairs[0].second].name, "plate");
}

TEST(MotionCheck, WhatPassesBesideIsFreeWithATrueClearance) {
  // The bar's end passes the plate's edge at 1.05 - 1.0 m.
  const auto scene = sceneOf(turningBar(), {boxAt("plate", {1.15, 0.0, 0.0}, {0.2, 0.002, 0.2})});
  const MotionReport report = checked(scene, {-1.0}, {1.3});
  EXPECT_EQ(report.verdict, Verdict::FREE);
  EXPECT_GT(report.clearance, 0.0);
  EXPECT_LE(report.clearance, 0.05);
  EXPECT_TRUE(report.pairs.empty());
}

TEST(MotionCheck, AClearanceComesForFreeAlsoBesideLinksThatStandStill) {
  const auto scene =
      sceneOf(robotFrom(slidingBoxes(2)), {boxAt("plate", {5.0, 0.0, 0.0}, {0.002, 2.0, 2.0})});
  const MotionReport report = checked(scene, {0.0, 20.0}, {3.0, 20.0});
  EXPECT_EQ(report.verdict, Verdict::FREE);
  EXPECT_GT(report.clearance, 0.01);
  EXPECT_LE(report.clearance, 1.499);
  EXPECT_GT(checked(scene, {3.0, 20.0}, {3.0, 20.0}).clearance, 0.01);
}

TEST(MotionCheck, AClearanceIsCertifiedOrThePairIsNamed) {
  const auto scene = sceneOf(turningBar(), {boxAt("plate", {1.15, 0.0, 0.0}, {0.2, 0.002, 0.2})});
  MotionSettings settings;
  settings.clearance = 0.045;
  const MotionReport report = checked(scene, {-1.0}, {1.3}, settings);
  EXPECT_EQ(report.verdict, Verdict::FREE);
  EXPECT_GE(report.clearance, 0.045);
  settings.clearance = 0.055;
  const MotionReport nearer = checked(scene, {-1.0}, {1.3}, settings);
  EXPECT_EQ(nearer.verdict, Verdict::UNKNOWN);
  EXPECT_EQ(nearer.pairs.size(), 1u);
  EXPECT_EQ(nearer.clearance, 0.0);
}

TEST(MotionCheck, WhatStayedOpenInOneMotionIsNotOpenInTheNext) {
  MotionCheck check(sceneOf(turningBar(), {boxAt("plate", {1.15, 0.0, 0.0}, {0.2, 0.002, 0.2})}));
  MotionSettings settings;
  settings.clearance = 0.055;
  EXPECT_EQ(check.check({{-1.0}, {1.3}}, settings).verdict, Verdict::UNKNOWN);
  settings.clearance = 0.045;
  const MotionReport& next = check.check({{-1.0}, {1.3}}, settings);
  EXPECT_EQ(next.verdict, Verdict::FREE);
  EXPECT_TRUE(next.pairs.empty());
}

TEST(MotionCheck, APairThatIsTooNearDoesNotHideAContactElsewhere) {
  const auto scene = sceneOf(turningBar(), {boxAt("near", {1.15, 0.0, 0.0}, {0.2, 0.002, 0.2}),
                                            boxAt("hit", {0.0, 0.8, 0.0}, {0.002, 0.1, 0.2})});
  MotionSettings settings;
  settings.clearance = 0.1;
  EXPECT_EQ(checked(scene, {-1.0}, {1.5}, settings).verdict, Verdict::UNKNOWN);
  EXPECT_EQ(checked(scene, {-1.0}, {2.0}, settings).verdict, Verdict::COLLISION);
}

// Where a cube slides up to static plates: no plate may be passed over that is nearer than what is
// certified.
TEST(MotionCheck, TheClearanceFromStaticThingsHoldsToTheEndsOfTheWay) {
  for (double gap = 0.005; gap < 0.4; gap += 0.005) {
    const auto scene =
        sceneOf(slidingBox(), {boxAt("plate", {1.0 + gap, 0.0, 0.0}, {0.2, 0.2, 0.2})});
    const MotionReport report = checked(scene, {-0.4}, {0.4});
    EXPECT_EQ(report.verdict, Verdict::FREE) << gap;
    EXPECT_LE(report.clearance, gap);
  }
}

TEST(MotionCheck, WhatIsNearerThanTheClearanceIsNotCutDownToTheResolution) {
  // Slides by at 4 mm.
  const auto scene = sceneOf(slidingBox(), {boxAt("plate", {0.0, 0.505, 0.0}, {0.2, 0.002, 0.2})});
  MotionSettings settings;
  settings.clearance = 0.02;
  settings.resolution = 1e-6;
  const MotionReport report = checked(scene, {-2.0}, {2.0}, settings);
  EXPECT_EQ(report.verdict, Verdict::UNKNOWN);
  EXPECT_EQ(report.pairs.size(), 1u);
  // Not as many as the resolution would allow, but a few for each time the motion is halved.
  const double halvings = std::log2(4.0 / settings.resolution);
  EXPECT_LT(report.nb_checks, 5.0 * halvings);
  settings.from_start = true;
  const MotionReport from_start = checked(scene, {-2.0}, {2.0}, settings);
  EXPECT_EQ(from_start.verdict, Verdict::UNKNOWN);
  EXPECT_LT(from_start.nb_checks, 5.0 * halvings);
  const double until = (2.0 - 0.6 - std::sqrt(0.02 * 0.02 - 0.004 * 0.004)) / 4.0;
  EXPECT_LE(from_start.free_until, until);
  EXPECT_GE(from_start.free_until, until - settings.resolution);
}

TEST(MotionCheck, WhatIsNearerThanTheResolutionMayStayUnknownAndFinerOnesSettleIt) {
  // A ball of 1 mm more than nothing passes between two others, near both.
  const auto robot = robotFrom(emptyLink("root") + linkWith("ball", "<sphere radius='0.1'/>") +
                               joint("slide", "prismatic", "root", "ball", "0 0 0",
                                     "<axis xyz='1 0 0'/><limit lower='-9' upper='9'/>"));
  RigidObject post = boxAt("post", {0.0, 0.2 + 2e-5, 0.0}, {0.0, 0.0, 0.0});
  post.elements[0].shape = Sphere{0.1};
  const auto scene = sceneOf(robot, {post});
  MotionSettings settings;
  settings.resolution = 1e-5;
  const MotionReport fine = checked(scene, {-1.0}, {1.0}, settings);
  EXPECT_EQ(fine.verdict, Verdict::FREE);
  EXPECT_GT(fine.clearance, 0.0);
  EXPECT_LE(fine.clearance, 2e-5);
}

TEST(MotionCheck, PairsThatDoNotMoveAgainstEachOtherAreLookedAtOnce) {
  const auto robot = robotFrom(emptyLink("root") + bar("upper", 1.0) + bar("lower", 1.0) +
                               hinge("shoulder", "root", "upper", "0 0 0") +
                               hinge("elbow", "upper", "lower", "0 0 0"));
  SceneDescription description = described(robot, {});
  description.robots[0].srdf = Srdf{};
  const auto scene = CollisionScene::build(description);
  const MotionReport apart = checked(scene, {-3.0, 1.5}, {3.0, 1.5});
  EXPECT_EQ(apart.verdict, Verdict::COLLISION);  // they share the hinge
  EXPECT_EQ(apart.nb_checks, 1u);
  const auto folding = sceneOf(foldingArm(), {boxAt("far", {0.0, 9.0, 0.0}, {1.0, 1.0, 1.0})});
  const MotionReport still = checked(folding, {0.0, 1.0}, {0.0, 1.0});
  EXPECT_EQ(still.verdict, Verdict::FREE);
  EXPECT_EQ(still.nb_checks, 1u);
}

TEST(MotionCheck, AContactOverMuchOfTheWayIsFoundInAFewChecks) {
  const auto scene = sceneOf(turningBar(), {boxAt("block", {0.0, 0.8, 0.0}, {0.8, 0.4, 0.2})});
  for (const double from : {-1.0, 0.0, 0.5}) {
    const MotionReport report = checked(scene, {from}, {from + 3.0});
    EXPECT_EQ(report.verdict, Verdict::COLLISION);
    EXPECT_LE(report.nb_checks, 8u);
  }
}

/// A wedge 0.4 m long in y. Its slanted face looks along (1, 0, 1), or away from it.
std::shared_ptr<const TriangleMesh> wedge(bool looks_along) {
  const double corner = looks_along ? 0.0 : 1.0;
  TriangleMesh mesh;
  for (const double y : {-0.2, 0.2}) {
    mesh.vertices.insert(mesh.vertices.end(), {{corner, y, corner}, {1.0, y, 0.0}, {0.0, y, 1.0}});
  }
  mesh.triangles = {{0, 1, 2}, {3, 5, 4}, {0, 3, 4}, {0, 4, 1},
                    {1, 4, 5}, {1, 5, 2}, {2, 5, 3}, {2, 3, 0}};
  return std::make_shared<const TriangleMesh>(mesh);
}

// The boxes of the two overlap, and a distance of 2 mm certifies no more than 2 mm at a time.
TEST(MotionCheck, OneWedgeThatSlidesAlongAnotherIsCertifiedByThePlaneBetweenThem) {
  const auto robot = RobotModel::fromUrdf(
      "<robot name='wedges'>" + emptyLink("root") + linkWith("wedge", "<mesh filename='wedge'/>") +
          joint("slide", "prismatic", "root", "wedge", "0 0 0",
                "<axis xyz='0 1 0'/><limit lower='-9' upper='9'/>") +
          "</robot>",
      [](const std::string&, const Eigen::Vector3d&) { return wedge(true); });
  RigidObject other;
  other.name = "other";
  other.elements.push_back({Convex{wedge(false)}, Eigen::Isometry3d::Identity()});
  for (const double gap : {0.002, -0.002}) {
    other.X_PO = Eigen::Translation3d(gap * Eigen::Vector3d(1, 0, 1).normalized()) *
                 Eigen::Isometry3d::Identity();
    const MotionReport report = checked(sceneOf(robot, {other}), {-0.5}, {0.5});
    EXPECT_EQ(report.verdict, gap > 0.0 ? Verdict::FREE : Verdict::COLLISION);
    EXPECT_LE(report.nb_checks, 3u);
  }
}

TEST(MotionCheck, AFloorIsNotTouchedByWhatStaysAboveIt) {
  const auto robot = robotFrom(emptyLink("root") + bar("arm", 1.0) +
                               joint("lift", "revolute", "root", "arm", "0 0 0.5",
                                     "<axis xyz='0 1 0'/><limit lower='-3' upper='3'/>"));
  const auto scene = sceneOf(robot, {floorAt(0.0, {})});
  EXPECT_EQ(checked(scene, {0.5}, {-2.0}).verdict, Verdict::FREE);  // down to 0.02 m above it
  EXPECT_EQ(checked(scene, {0.55}, {-2.0}).verdict, Verdict::COLLISION);
  EXPECT_EQ(checked(scene, {-2.0}, {M_PI - 0.5}).verdict, Verdict::COLLISION);  // in between
}

TEST(MotionCheck, WithoutPairsNothingIsCertifiedUnlessThatIsPermitted) {
  SceneDescription description = described(turningBar(), {});
  MotionReport report = checked(CollisionScene::build(description), {-1.0}, {1.0});
  EXPECT_EQ(report.verdict, Verdict::UNKNOWN);
  EXPECT_EQ(report.clearance, 0.0);
  EXPECT_EQ(report.free_until, 0.0);
  description.settings.allow_empty_scene = true;
  report = checked(CollisionScene::build(description), {-1.0}, {1.0});
  EXPECT_EQ(report.verdict, Verdict::FREE);
  EXPECT_TRUE(std::isinf(report.clearance));
  EXPECT_EQ(report.free_until, 1.0);
}

TEST(MotionCheck, WhatIsSuspectIsNotFreeAndAContactIsCertainAllTheSame) {
  const auto scene = sceneOf(turningBar(), {boxAt("plate", {1.15, 0.0, 0.0}, {0.2, 0.002, 0.2})});
  MotionCheck check(scene);
  const MotionReport suspect = check.check({{-1.0}, {1.3}}, {}, {}, {}, {"the clock stands"});
  EXPECT_EQ(suspect.verdict, Verdict::UNKNOWN);
  EXPECT_EQ(suspect.unknown_because, std::vector<std::string>{"the clock stands"});
  EXPECT_EQ(suspect.free_until, 0.0);
  EXPECT_EQ(suspect.clearance, 0.0);
  EXPECT_EQ(check.check({{-1.0}, {1.3}}, {}).verdict, Verdict::FREE);
  MotionCheck touching(sceneOf(turningBar(), {boxAt("plate", {0.8, 0.0, 0.0}, {0.2, 0.002, 0.2})}));
  const MotionReport& hit = touching.check({{-1.0}, {1.3}}, {}, {}, {}, {"the clock stands"});
  EXPECT_EQ(hit.verdict, Verdict::COLLISION);
  EXPECT_EQ(hit.free_until, 0.0);
  EXPECT_TRUE(hit.unknown_because.empty());
}

TEST(MotionCheck, InputThatIsNoneIsRefusedWithTheReason) {
  const auto scene = sceneOf(turningBar(), {boxAt("plate", {0.8, 0.0, 0.0}, {0.2, 0.002, 0.2})});
  const auto message = [&](const std::vector<double>& from, const std::vector<double>& to,
                           const MotionSettings& settings) {
    return refusal([&] { checked(scene, from, to, settings); });
  };
  EXPECT_NE(message({0.0}, {NAN_POSITION}, {}).find("'turn'"), std::string::npos);
  EXPECT_NE(message({-1e308}, {1.7e308}, {}).find("'turn'"), std::string::npos);
  EXPECT_NE(message({0.0, 0.0}, {1.0}, {}).find("1 joints"), std::string::npos);
  MotionSettings settings;
  settings.clearance = -1.0;
  EXPECT_NE(message({0.0}, {1.0}, settings).find("clearance"), std::string::npos);
  settings.clearance = INFINITY;
  EXPECT_NE(message({0.0}, {1.0}, settings).find("clearance"), std::string::npos);
  settings.clearance = 0.0;
  settings.resolution = 0.0;
  EXPECT_NE(message({0.0}, {1.0}, settings).find("resolution"), std::string::npos);
  settings.resolution = NAN_POSITION;
  EXPECT_NE(message({0.0}, {1.0}, settings).find("resolution"), std::string::npos);
}

TEST(MotionCheck, AMotionBeyondMeasureEndsInUnknownAndNamesItsPairs) {
  const auto beside = boxAt("plate", {0.8, 3.0, 0.0}, {0.2, 0.002, 0.2});
  for (const double end : {1e9, 1e100, 1e307}) {
    const MotionReport report = checked(sceneOf(slidingBox(), {beside}), {0.0}, {end});
    EXPECT_EQ(report.verdict, Verdict::UNKNOWN) << end;
    EXPECT_EQ(report.pairs.size(), 1u) << end;
  }
}

TEST(MotionCheck, AContactIsFoundHoweverFarFromItAMotionBeginsOrEnds) {
  const auto with_plate = sceneOf(slidingBox(), {boxAt("plate", {0.0, 0.0, 0.0}, {0.2, 0.2, 0.2})});
  const auto two_boxes = sceneOf(robotFrom(slidingBoxes(2)), {});  // both at 0
  RandomInputs random;
  for (int i = 0; i < 6; ++i) {
    const double far = (random.integer(0, 1) ? 1.0 : -1.0) * std::pow(10.0, random.uniform(3, 307));
    MotionSettings settings;
    settings.from_start = random.integer(0, 1);
    for (const auto& scene : {with_plate, two_boxes}) {
      const std::vector<double> here = scene->robot().zeroPositions();
      std::vector<double> there = here;
      there.back() = far;
      EXPECT_NE(checked(scene, here, there, settings).verdict, Verdict::FREE) << far;
      EXPECT_NE(checked(scene, there, here, settings).verdict, Verdict::FREE) << far;
    }
  }
}

/// Within 1 GB of the process's memory: more throws std::bad_alloc. Sanitizers reserve more than
/// that.
MotionReport checkedInOneGigabyte(const std::shared_ptr<const CollisionScene>& scene,
                                  const std::vector<double>& from, const std::vector<double>& to) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  return checked(scene, from, to);
#endif
  rlimit before{};
  getrlimit(RLIMIT_AS, &before);
  const rlimit limited{rlim_t{1} << 30, before.rlim_max};
  setrlimit(RLIMIT_AS, &limited);
  const MotionReport report = checked(scene, from, to);
  setrlimit(RLIMIT_AS, &before);
  return report;
}

// Each of the ways that are left open names all that is static, once and not once a way.
TEST(MotionCheck, AMotionBeyondMeasureBesideManyThingsKeepsToItsMemory) {
  std::vector<RigidObject> plates;
  for (int i = 0; i < 300; ++i) {
    plates.push_back(boxAt("plate" + std::to_string(i), {1.1, 0.01 * i, 0.0}, {0.1, 0.002, 0.2}));
  }
  const auto scene = sceneOf(slidingBox(), std::move(plates));
  const MotionReport report = checkedInOneGigabyte(scene, {2e8}, {1e9});
  EXPECT_EQ(report.verdict, Verdict::UNKNOWN);
  EXPECT_EQ(report.pairs.size(), 300u);
}

// Each cut leaves as many pairs open, on both sides.
TEST(MotionCheck, AMotionBeyondMeasureOfManyLinksKeepsToItsMemory) {
  constexpr int NB_LINKS = 30;
  std::string xml = emptyLink("root");
  for (int i = 0; i < NB_LINKS; ++i) {
    const std::string name = "arm" + std::to_string(i);
    xml += bar(name, 1.0) +
           hinge("turn" + std::to_string(i), "root", name, std::to_string(2.2 * i) + " 0 0");
  }
  const auto scene = CollisionScene::build(robotFrom(xml), Srdf{}, nullptr);
  const std::vector<double> from(NB_LINKS, 0.0), to(NB_LINKS, 1e9);
  const MotionReport report = checkedInOneGigabyte(scene, from, to);
  EXPECT_EQ(report.verdict, Verdict::UNKNOWN);
  EXPECT_EQ(report.pairs.size(), NB_LINKS * (NB_LINKS - 1u) / 2u);
}

TEST(MotionCheck, SegmentsAreTheSameOnAnyNumberOfThreads) {
  const auto scene = sceneOf(foldingArm(), {boxAt("a", {1.2, 0.4, 0.0}, {0.1, 0.1, 0.2}),
                                            boxAt("b", {-0.5, 0.9, 0.0}, {0.1, 0.1, 0.2})});
  RandomInputs random;
  std::vector<std::vector<double>> waypoints;
  for (int i = 0; i < 60; ++i) {
    waypoints.push_back({random.uniform(-3.0, 3.0), random.uniform(-2.5, 2.5)});
  }
  SegmentOptions options;
  options.threads = 1;
  const auto alone = checkSegments(scene, waypoints, {}, options);
  ASSERT_EQ(alone.size(), 59u);
  for (const unsigned threads : {2u, 5u, 0u}) {
    std::size_t last_done = 0;
    options.threads = threads;
    options.done = [&](std::size_t nb_done) { EXPECT_EQ(nb_done, ++last_done); };
    const auto reports = checkSegments(scene, waypoints, {}, options);
    EXPECT_EQ(last_done, 59u);
    for (std::size_t i = 0; i < alone.size(); ++i) {
      EXPECT_EQ(reports[i].verdict, alone[i].verdict);
      EXPECT_EQ(reports[i].clearance, alone[i].clearance);
      EXPECT_EQ(reports[i].contact_at, alone[i].contact_at);
      EXPECT_EQ(reports[i].pairs, alone[i].pairs);
      EXPECT_EQ(reports[i].nb_checks, alone[i].nb_checks);
      EXPECT_EQ(reports[i].nb_queries, alone[i].nb_queries);
    }
  }
  options.done = nullptr;
  waypoints[7][0] = NAN_POSITION;
  EXPECT_THROW(checkSegments(scene, waypoints, {}, options), InputError);
  EXPECT_TRUE(checkSegments(scene, {waypoints[0]}, {}, {}).empty());
}

// Never FREE for what there was no time to look at.
TEST(MotionCheck, ThatHasNoTimeLeavesOpenWhatItHasNotCertified) {
  const auto scene = sceneOf(turningBar(), {boxAt("post", {0.5, 0.6, 0.0}, {0.1, 0.1, 0.1})});
  MotionSettings settings;
  EXPECT_EQ(checked(scene, {-1.0}, {0.2}, settings).verdict, Verdict::FREE);
  settings.time_budget = 3600.0;
  EXPECT_EQ(checked(scene, {-1.0}, {0.2}, settings).verdict, Verdict::FREE);
  settings.time_budget = 1e-9;
  for (const bool only_free : {false, true}) {
    settings.only_free = only_free;
    const MotionReport report = checked(scene, {-1.0}, {0.2}, settings);
    EXPECT_EQ(report.verdict, Verdict::UNKNOWN);
    EXPECT_FALSE(report.pairs.empty());
    EXPECT_EQ(report.free_until, 0.0);
  }
  for (const double budget : {-1.0, std::nan(""), HUGE_VAL}) {
    settings.time_budget = budget;
    EXPECT_THROW(checked(scene, {-1.0}, {0.2}, settings), InputError);
  }
}

}  // namespace collision_pairs::test_motion_check
