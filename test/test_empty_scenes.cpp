// Where nothing is checked no way of asking gives FREE, unless the scene's settings permit it.
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "collision_pairs/batch_check.h"
#include "collision_pairs/motion_check.h"
#include "demo_scene.h"
#include "random_inputs.h"

namespace collision_pairs::test_empty_scenes {

struct Case {
  std::string words;  ///< CollisionScene::unchecked()
  SceneDescription description;
};

RigidObject boxAround(const std::string& name) {
  RigidObject box;
  box.name = name;
  box.elements.push_back({Box{Eigen::Vector3d::Constant(50.0)}, Eigen::Isometry3d::Identity()});
  return box;
}

SceneDescription sceneOf(const std::string& links_and_joints) {
  SceneDescription description;
  description.robots.push_back({robotFrom(links_and_joints), std::nullopt, ""});
  return description;
}

const std::string BARE = emptyLink("root") + emptyLink("a") + joint("j", "revolute", "root", "a");

/// Every kind of scene in which nothing is checked, some with obstacles that nothing meets.
std::vector<Case> emptyScenes() {
  const std::string none = "there is no pair to check";
  std::vector<Case> cases;
  cases.push_back({"the robot has no collision geometry", sceneOf(BARE)});
  Case one_link{none, sceneOf(boxLink("root", 1.0))};
  cases.push_back(one_link);
  Case by_srdf{none, sceneOf(slidingBoxes(2))};
  by_srdf.description.robots[0].srdf = Srdf();
  by_srdf.description.robots[0].srdf->disabled_pairs = {{"a", "b"}};
  cases.push_back(by_srdf);
  Case by_rule{none, sceneOf(slidingBoxes(3))};
  by_rule.description.settings.pair_rules = {{PairRule::Verdict::DENY, "*", "*"}};
  by_rule.description.objects.push_back(boxAround("box"));
  cases.push_back(by_rule);
  Case ignored{none, sceneOf(slidingBoxes(3))};
  ignored.description.settings.ignored_links = {"*"};
  cases.push_back(ignored);
  Case no_self{none, sceneOf(slidingBoxes(3))};
  no_self.description.check_self = false;
  cases.push_back(no_self);
  Case restricted{"group and links leave no pair to check", sceneOf(slidingBoxes(3))};
  restricted.description.restriction.names = {"d*"};
  cases.push_back(restricted);
  return cases;
}

/// Verdicts of all ways of asking. Adds obstacles, and moves what there is.
class EmptyScene {
 public:
  EmptyScene(const SceneDescription& description, std::mt19937& random)
      : scene_(CollisionScene::build(description)), random_(random) {}

  const CollisionScene& scene() const { return *scene_; }

  void expect(Verdict verdict, const std::string& words) {
    EXPECT_EQ(scene_->unchecked(), words);
    CollisionDetector detector(scene_);
    for (int i = 0; i < 20; ++i) {
      const CollisionReport& report = detector.detect(poses(), randomSettings());
      expectReport(report, verdict, words);
    }
    detector.beginNarrowPhase(poses(), randomSettings());
    expectReport(detector.endNarrowPhase(), verdict, words);
    expectBatches(verdict, words);
    expectMotions(verdict, words);
  }

 private:
  std::vector<double> positions() {
    std::vector<double> q = scene_->robot().zeroPositions();
    for (double& position : q) position = std::uniform_real_distribution<double>(-3, 3)(random_);
    return q;
  }

  BodyPoses poses() {
    std::vector<Eigen::Isometry3d> X_RB;
    scene_->robot().forwardKinematics(positions(), X_RB);
    BodyPoses poses;
    scene_->gatherPoses(X_RB, poses);
    return poses;
  }

  CheckSettings randomSettings() {
    CheckSettings settings;
    settings.verdict_only = random_() % 2;
    settings.min_distance = random_() % 2;
    settings.list_boxes = random_() % 2;
    settings.time_budget = random_() % 2 ? 1.0 : 0.0;
    settings.tolerance = random_() % 2 ? 0.01 : 0.0;
    settings.fidelity = static_cast<Fidelity>(random_() % 5);
    return settings;
  }

  void expectReport(const CollisionReport& report, Verdict verdict, const std::string& words) {
    EXPECT_EQ(report.verdict, verdict);
    EXPECT_EQ(report.in_collision, verdict != Verdict::FREE);
    EXPECT_EQ(report.unchecked, words);
    if (verdict != Verdict::UNKNOWN || !scene_->models().empty()) return;
    EXPECT_EQ(report.min_distance, 0.0);
    EXPECT_TRUE(report.min_distance_is_bound);
  }

  void expectBatches(Verdict verdict, const std::string& words) {
    BatchCheck batch(scene_, 1);
    CheckSettings settings;
    settings.verdict_only = true;
    const auto take = [&](std::size_t, const CollisionReport& report) {
      EXPECT_EQ(report.verdict, verdict);
      EXPECT_EQ(report.unchecked, words);
    };
    batch.run(
        20, settings, [&](std::size_t, BodyPoses& p) { p = poses(); }, take);
    // As many as would be settled by spheres, which do not look at the scene.
    batch.runJoints(
        BatchCheck::STATES_WORTH_A_STAGE + 20, settings,
        [&](std::size_t, std::vector<double>& q) { q = positions(); }, {}, take);
  }

  void expectMotions(Verdict verdict, const std::string& words) {
    const MotionReport report = MotionCheck(scene_).check({positions(), positions()}, {});
    EXPECT_EQ(report.verdict, verdict);
    EXPECT_EQ(report.unchecked, words);
    EXPECT_EQ(report.clearance > 0.0, verdict == Verdict::FREE);
    EXPECT_EQ(report.free_until, verdict == Verdict::FREE ? 1.0 : 0.0);
  }

  std::shared_ptr<const CollisionScene> scene_;
  std::mt19937& random_;
};

TEST(EmptyScenes, AreUnknownHoweverTheyAreAsked) {
  std::mt19937 random(givenSeed());
  for (const Case& a_case : emptyScenes()) {
    SCOPED_TRACE(a_case.words);
    EmptyScene(a_case.description, random).expect(Verdict::UNKNOWN, a_case.words);
  }
}

TEST(EmptyScenes, AreFreeAndSaySoWhereTheSettingsPermitIt) {
  std::mt19937 random(givenSeed());
  for (Case a_case : emptyScenes()) {
    a_case.description.settings.allow_empty_scene = true;
    EmptyScene(a_case.description, random).expect(Verdict::FREE, a_case.words);
  }
}

TEST(EmptyScenes, OfARobotWithoutGeometryAreUnknownWhateverIsAroundIt) {
  std::mt19937 random(givenSeed());
  Case around = emptyScenes()[0];
  around.description.objects.push_back(boxAround("box"));
  around.description.objects.push_back(floorAt(1.0, {}));
  around.description.clouds.push_back(cloudOf("camera", 0.1, {}));
  EmptyScene(around.description, random).expect(Verdict::UNKNOWN, around.words);
}

TEST(EmptyScenes, AnEnvironmentWithoutGeometryIsNotFree) {
  SceneDescription cell = sceneOf(slidingBoxes(2));
  cell.world = robotFrom(emptyLink("cell"));
  const auto scene = CollisionScene::build(cell);
  EXPECT_EQ(scene->unchecked(), "the environment has no collision geometry");
  CollisionDetector detector(scene);
  BodyPoses poses;
  poses.resize(scene->bodies().size());
  poses.X_WB[1].translation().x() = 5.0;
  EXPECT_EQ(detector.detect(poses, {}).verdict, Verdict::UNKNOWN);
}

TEST(EmptyScenes, ARobotWithoutGeometryBesideOneThatHasSomeIsNotFree) {
  SceneDescription two = sceneOf(slidingBoxes(2));
  two.robots[0].prefix = "left";
  two.robots.push_back({robotFrom(BARE), std::nullopt, "right"});
  const auto scene = CollisionScene::build(two);
  EXPECT_EQ(scene->unchecked(), "robot 'right/test' has no collision geometry");
  CollisionDetector detector(scene);
  BodyPoses poses;
  poses.resize(scene->bodies().size());
  EXPECT_EQ(detector.detect(poses, {}).verdict, Verdict::COLLISION) << "of the other one";
  poses.X_WB[0].translation().x() = 9.0;
  EXPECT_EQ(detector.detect(poses, {}).verdict, Verdict::UNKNOWN);
  const std::vector<double> apart = {9.0, 0.0, 0.0};
  EXPECT_EQ(MotionCheck(scene).check({apart, apart}, {}).verdict, Verdict::UNKNOWN);
  two.settings.allow_empty_scene = true;
  CollisionDetector allowed(CollisionScene::build(two));
  EXPECT_EQ(allowed.detect(poses, {}).verdict, Verdict::FREE);
  EXPECT_EQ(allowed.report().unchecked, scene->unchecked());
}

TEST(EmptyScenes, AreNotThoseWhoseOwnBroadPhaseFindsNothing) {
  const auto scene = CollisionScene::build(sceneOf(slidingBoxes(2)));
  CollisionDetector detector(scene);
  BodyPoses poses;
  poses.resize(scene->bodies().size());
  detector.beginNarrowPhase(poses, {});
  EXPECT_EQ(detector.endNarrowPhase().verdict, Verdict::FREE);
  EXPECT_EQ(detector.report().unchecked, "");
}

}  // namespace collision_pairs::test_empty_scenes
