// A report says what this check found and nothing of those before it, in any of its fields.
#include <gtest/gtest.h>

#include "collision_pairs/collision_detector.h"
#include "collision_pairs/input_error.h"
#include "collision_pairs/motion_check.h"
#include "everything_in.h"
#include "motion_fixtures.h"
#include "random_case.h"

namespace collision_pairs::test_report_alone {

CheckSettings randomSettings(RandomInputs& random,
                             const std::shared_ptr<const CollisionScene>& scene) {
  CheckSettings settings;
  const auto one = [&](int of) { return random.integer(1, of) == 1; };
  settings.alarm_distance = one(2) ? random.uniform(0.0, 0.3) : 0.0;
  const Fidelity all[] = {Fidelity::AABB, Fidelity::OBB, Fidelity::CONVEX, Fidelity::MESH,
                          Fidelity::SPHERES};
  if (one(2)) settings.fidelity = all[random.integer(0, one(8) ? 4 : 3)];
  if (one(4)) settings.tolerance = 0.01;
  settings.min_distance = one(2);
  settings.verdict_only = one(4);
  if (one(5)) settings.max_contacts = static_cast<std::uint32_t>(random.integer(1, 3));
  if (one(5)) settings.is_enough = [](const Contact& c) { return c.depth > 0.05; };
  if (one(3)) settings.time_budget = one(2) ? 1e9 : random.uniform(0.0, 60.0);
  settings.list_boxes = one(4);
  if (one(5)) settings.may_ignore = [](auto a, auto b) { return (a * 31 + b) % 3 == 0; };
  if (one(5) && !scene->models().empty()) {
    settings.selection = std::make_shared<PairSelection>(scene, Restriction{{}, {"left/*"}});
  }
  return settings;
}

/// As randomPosesOf(), or all a little further than before.
void moveOn(RandomInputs& random, const RandomCase& its, const CollisionScene& scene,
            BodyPoses& poses) {
  if (poses.X_WB.empty() || random.integer(0, 1)) poses = randomPosesOf(random, its, scene);
  for (Eigen::Isometry3d& X_WB : poses.X_WB) {
    X_WB.translation() += random.vector(-0.01, 0.01);
  }
  for (char& known : poses.known) known = random.integer(0, 15) > 0;
}

/// A clock that advances by a second each time it is read.
void setClock(CollisionDetector& detector) {
  detector.setClock([now = 0.0]() mutable { return now += 1.0; });
}

TEST(AReport, DependsOnTheScenePosesAndSettingsAlone) {
  RandomInputs random;
  std::size_t nb_pairs = 0, nb_nearest = 0, nb_unresolved = 0, nb_early = 0, nb_ignored = 0;
  for (int round = 0; round < 60; ++round) {
    RandomCase its(random);
    if (random.integer(0, 4) == 0) its.description.settings.narrow_phase = NarrowPhaseMethod::FCL;
    const auto scene = CollisionScene::build(its.description);
    CollisionDetector used(scene);
    BodyPoses poses;
    for (int check = 0; check < 12; ++check) {
      SCOPED_TRACE(std::to_string(round) + ", check " + std::to_string(check));
      moveOn(random, its, *scene, poses);
      const CheckSettings settings = randomSettings(random, scene);
      CollisionDetector fresh(scene);
      setClock(used), setClock(fresh);
      const CollisionReport& report = fresh.detect(poses, settings);
      ASSERT_EQ(everythingIn(used.detect(poses, settings)), everythingIn(report));
      nb_pairs += report.pairs.size(), nb_nearest += report.nearest.has_value();
      nb_unresolved += report.nb_unresolved, nb_early += report.ended_early;
      nb_ignored += report.ignored.size();
      if (check % 4 != 3) continue;
      used.beginNarrowPhase(poses, {});  // what was asked pair by pair is no longer
      if (!scene->models().empty()) used.addCollisionPair(0, 1);
      used.endNarrowPhase();
    }
  }
  for (const auto nb : {nb_pairs, nb_nearest, nb_unresolved, nb_early, nb_ignored}) {
    EXPECT_GT(nb, 20u);
  }
}

/// All fields but the time.
std::string everythingIn(const MotionReport& report) {
  std::ostringstream text;
  text << std::hexfloat << static_cast<int>(report.verdict) << ' ' << report.clearance << ' '
       << report.contact_at << ' ' << report.free_until << ' ' << report.unchecked << ' '
       << report.nb_checks << ' ' << report.nb_queries;
  for (const auto& [a, b] : report.pairs) text << "\npair " << a << ' ' << b;
  return text.str();
}

TEST(AReportOfAMotion, DependsOnTheSceneTheMotionAndTheSettingsAlone) {
  RandomInputs random;
  int nb[3] = {0, 0, 0};
  for (int round = 0; round < 40; ++round) {
    const RandomCase its(random);
    const auto scene = CollisionScene::build(its.description);
    MotionCheck used(scene);
    for (int check = 0; check < 6; ++check) {
      JointMotion motion;
      motion.from = randomPositions(random, scene->robot());
      motion.to = motion.from;
      for (double& x : motion.to) x += random.uniform(-0.2, 0.2);
      if (random.integer(0, 3) == 0) motion.deviation.assign(motion.from.size(), 0.001);
      MotionSettings settings;
      settings.resolution = 0.02;
      settings.clearance = random.integer(0, 1) ? 0.03 : 0.0;
      settings.from_start = random.integer(0, 1);
      settings.only_free = random.integer(0, 3) == 0;
      settings.only_moved = random.integer(0, 1);
      if (random.integer(0, 2) == 0) settings.fidelity = Fidelity::OBB;
      if (random.integer(0, 1) == 0) {
        const double kept = random.integer(0, 1) ? -1.0 : 0.01, most = settings.clearance;
        settings.clearance_of = [=](auto first, auto second) {
          return first + second == 1         ? std::min(kept, most)
                 : (first + second) % 2 == 0 ? most
                                             : 0.0;
        };
      }
      const CloudVoxels voxels = scene->clouds().empty() ? CloudVoxels() : its.voxels;
      MotionCheck fresh(scene);
      const MotionReport& report = fresh.check(motion, settings, {}, voxels);
      ASSERT_EQ(everythingIn(used.check(motion, settings, {}, voxels)), everythingIn(report))
          << round << ' ' << check;
      ++nb[static_cast<int>(report.verdict)];
    }
  }
  for (const int nb_of_verdict : nb) EXPECT_GT(nb_of_verdict, 0);
}

TEST(AReport, IsEmptyBeforeTheFirstCheck) {
  const auto isEmpty = [](const CollisionReport& report) {
    EXPECT_EQ(report.verdict, Verdict::UNKNOWN);
    EXPECT_TRUE(report.in_collision);
    EXPECT_EQ(report.min_distance, 0.0);
    EXPECT_TRUE(report.min_distance_is_bound);
    EXPECT_FALSE(report.nearest || report.ended_early || report.budget_spent);
    EXPECT_TRUE(report.unchecked.empty() && report.pairs.empty() && report.contacts.empty());
    EXPECT_TRUE(report.candidates.empty() && report.boxes.empty() && report.ignored.empty());
    EXPECT_TRUE(report.left_out.empty());
    EXPECT_EQ(report.tolerance, 0.0);
    for (const std::uint32_t nb : report.nb_settled) EXPECT_EQ(nb, 0u);
    for (const std::uint32_t nb :
         {report.nb_boxes, report.nb_unresolved, report.nb_degraded, report.nb_answered_natively}) {
      EXPECT_EQ(nb, 0u);
    }
    const StageTimes& times = report.times;
    for (const double t : {times.boxes, times.broad_phase, times.narrow_phase, times.total}) {
      EXPECT_EQ(t, 0.0);
    }
  };
  RandomInputs random;
  const auto scene = CollisionScene::build(RandomCase(random).description);
  isEmpty(CollisionDetector(scene).report());
  isEmpty(CollisionReport());
  EXPECT_EQ(everythingIn(MotionReport()), "2 0x0p+0 0x0p+0 0x0p+0  0 0");
  EXPECT_EQ(MotionReport().seconds, 0.0);
}

TEST(AReport, OfACheckThatWasRefusedIsUnknownAndNotTheOneBefore) {
  const auto scene = sceneOf(robotFrom(slidingBoxes(2)), {});
  CollisionDetector detector(scene);
  BodyPoses poses;
  poses.resize(scene->bodies().size());
  for (const double x : {0.5, 3.0}) {  // in contact, then free
    poses.X_WB[0].translation().x() = x;
    ASSERT_NE(detector.detect(poses, {}).verdict, Verdict::UNKNOWN);
    CheckSettings wrong;
    wrong.alarm_distance = -1.0;
    EXPECT_THROW(detector.detect(poses, wrong), InputError);
    EXPECT_EQ(detector.report().verdict, Verdict::UNKNOWN);
    EXPECT_TRUE(detector.report().in_collision);
    EXPECT_TRUE(detector.report().pairs.empty() && detector.report().contacts.empty());
    detector.beginNarrowPhase(poses, {});
    EXPECT_EQ(detector.report().verdict, Verdict::UNKNOWN);
    EXPECT_THROW(detector.addCollisionPair(0, 2), InputError);
    detector.addCollisionPair(0, 1);
    EXPECT_EQ(detector.endNarrowPhase().verdict, x < 1.0 ? Verdict::COLLISION : Verdict::FREE);
  }
}

}  // namespace collision_pairs::test_report_alone
