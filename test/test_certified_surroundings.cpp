// What the limiter's law is told of the scene. The law itself: test_limiter_law.cpp.
#include <chrono>
#include <cmath>
#include <condition_variable>
#include <memory>
#include <mutex>

#include <gtest/gtest.h>

#include "certified_surroundings.h"
#include "collision_pairs/input_error.h"
#include "collision_pairs/motion_check.h"
#include "collision_pairs/occupied_voxels.h"
#include "motion_fixtures.h"
#include "prepared_surroundings.h"
#include "random_inputs.h"
#include "refusal.h"

namespace collision_pairs::test_certified_surroundings {

constexpr KeptDistances ONE_CM = {0.01, 0.01, 0.0};

RigidObject ballAt(const std::string& name, const Eigen::Vector3d& center, double radius) {
  RigidObject object = boxAt(name, center, {1.0, 1.0, 1.0});
  object.elements[0].shape = Sphere{radius};
  return object;
}

TEST(CertifiedSurroundings, WhatIsLeftOutIsTheCallersButNotACloudThatIsUnknown) {
  SceneDescription description;
  description.robots.push_back({turningBar(), Srdf(), ""});
  description.clouds = {cloudOf("cloud", 0.1, {})};
  const auto scene = CollisionScene::build(description);
  CertifiedSurroundings surroundings(scene, {"turn"}, Fidelity::MESH);
  std::vector<NearPair> touching;
  for (const CollisionModel& model : scene->models()) {
    if (model.name != "cloud") touching.push_back({model.name, "cloud", -1.0, 1.0, false});
  }
  const StoppingTube tube{{0.0}, {0.01}, {0.0}, 0.0};
  for (const bool is_known : {true, false}) {
    RobotState state;
    state.positions = scene->robot().zeroPositions();
    if (is_known) {
      state.voxels = {std::make_shared<const OccupiedVoxels>(0.1, std::vector<VoxelCell>())};
    } else {
      state.voxels = {nullptr};
    }
    surroundings.setState(state);
    EXPECT_EQ(surroundings.certify(tube, ONE_CM, touching).is_free, is_known);
    std::vector<NearPair> near;
    std::string why;
    EXPECT_EQ(surroundings.nearPairs(0.01, {1.0}, near, why), is_known);
    EXPECT_EQ(why, is_known ? "" : "cloud is not known");
  }
}

TEST(CertifiedSurroundings, AnswerAtTheirFidelityAndNameTheNearestFirst) {
  // The corner of a box is 6.6 cm from one ball and 20.7 cm from another, whose boxes it overlaps.
  const auto scene = sceneOf(
      slidingBox(), {ballAt("far", {-1.0, 1.0, 0.0}, 0.5), ballAt("ball", {0.9, 0.9, 0.0}, 0.5)});
  const StoppingTube tube{{0.0}, {1e-4}, {0.0}, 0.0};
  for (const Fidelity fidelity : {Fidelity::MESH, Fidelity::AABB}) {
    const bool is_exact = fidelity == Fidelity::MESH;
    CertifiedSurroundings surroundings(scene, {"slide_a"}, fidelity);
    RobotState state;
    state.positions = {0.0};
    surroundings.setState(state);
    const auto certificate = surroundings.certify(tube, ONE_CM, {});
    EXPECT_EQ(certificate.is_free, is_exact);
    EXPECT_EQ(certificate.first + '|' + certificate.second, is_exact ? "|" : "a|ball");
    EXPECT_EQ(certificate.why, "");
    std::vector<NearPair> pairs;
    std::string why;
    ASSERT_TRUE(surroundings.nearPairs(0.3, {2.0}, pairs, why));
    ASSERT_EQ(pairs.size(), 2u);
    EXPECT_EQ(pairs[0].first + '|' + pairs[0].second, "a|ball");
    EXPECT_EQ(pairs[1].second, "far");
    EXPECT_FALSE(pairs[0].is_robot);
    if (!is_exact) {
      EXPECT_LT(pairs[0].distance, 0.0);
      continue;
    }
    EXPECT_NEAR(pairs[0].distance, 0.4 * std::sqrt(2.0) - 0.5, 1e-9);
    EXPECT_NEAR(pairs[0].derivative, -2.0 * std::sqrt(0.5), 1e-6);
    EXPECT_NEAR(pairs[1].derivative, 2.0 * std::sqrt(0.5), 1e-6);
    ASSERT_TRUE(surroundings.nearPairs(0.1, {2.0}, pairs, why));
    EXPECT_EQ(pairs.size(), 1u);
  }
}

TEST(CertifiedSurroundings, KnowAJointWhateverSlashItIsNamedWith) {
  const auto scene = sceneOf(slidingBox(), {boxAt("box", {2.0, 0.0, 0.0}, {1, 1, 1})});
  for (const char* name : {"slide_a", "/slide_a"}) {
    CertifiedSurroundings surroundings(scene, {name}, Fidelity::MESH);
    RobotState state;
    state.positions = {0.0};
    surroundings.setState(state);
    EXPECT_TRUE(surroundings.certify({{0.0}, {0.5}, {0.0}, 0.0}, ONE_CM, {}).is_free) << name;
    EXPECT_FALSE(surroundings.certify({{0.0}, {1.5}, {0.0}, 0.0}, ONE_CM, {}).is_free) << name;
  }
}

// What it is commanded, its leader's motion would overwrite.
TEST(CertifiedSurroundings, AreNotAskedOfAJointThatFollowsAnother) {
  SceneDescription description;
  const auto robot = robotFrom(
      boxLink("base", 0.1) + boxLink("a", 0.1) + boxLink("b", 0.1) +
      joint("f1", "continuous", "base", "a", "1 0 0", "<axis xyz='0 0 1'/>") +
      joint("f2", "continuous", "base", "b", "2 0 0", "<axis xyz='0 0 1'/><mimic joint='f1'/>"));
  description.robots.push_back({robot, Srdf(), ""});
  const auto scene = CollisionScene::build(description);
  EXPECT_NO_THROW(CertifiedSurroundings(scene, {"f1"}, Fidelity::MESH));
  for (const std::vector<std::string>& joints : {std::vector<std::string>{"f1", "f2"}, {"/f2"}}) {
    const std::string why = refusal([&] { CertifiedSurroundings(scene, joints, Fidelity::MESH); });
    EXPECT_NE(why.find("joint 'f2' mimics 'f1'"), why.npos) << why;
  }
}

TEST(CertifiedSurroundings, AreAskedOfARobotThatRespondsAsTheSettingsSay) {
  EXPECT_EQ(RobotResponse().reaction_time, LimiterSettings().reaction_time);
  EXPECT_EQ(RobotResponse().hold, LimiterSettings().command_timeout);
}

TEST(CertifiedSurroundings, OfASceneInWhichNothingIsCheckedNothingIsSaid) {
  SceneDescription description;
  description.robots.push_back({turningBar(), Srdf(), ""});
  const auto scene = CollisionScene::build(description);
  ASSERT_FALSE(scene->unchecked().empty());
  CertifiedSurroundings surroundings(scene, {"turn"}, Fidelity::MESH);
  RobotState state;
  state.positions = scene->robot().zeroPositions();
  surroundings.setState(state);
  std::vector<NearPair> near;
  std::string why;
  EXPECT_FALSE(surroundings.nearPairs(0.01, {1.0}, near, why));
  EXPECT_EQ(why, scene->unchecked());
  const auto certificate = surroundings.certify({{0.0}, {0.01}, {0.0}, 0.0}, ONE_CM, {});
  EXPECT_FALSE(certificate.is_free);
  EXPECT_EQ(certificate.why, scene->unchecked());
}

// Gaps of 0.2 m: between two links of one carrier, the second and a wall, the first and another
// robot.
TEST(CertifiedSurroundings, OfEachKindOfPairKeepWhatItHasTo) {
  const std::string along_x = "<axis xyz='1 0 0'/><limit lower='-9' upper='9'/>";
  const auto robot = robotFrom(emptyLink("root") + emptyLink("torso") + boxLink("a", 1.0) +
                               boxLink("b", 1.0) + boxLink("other", 1.0) +
                               joint("lift", "prismatic", "root", "torso", "0 0 0", along_x) +
                               joint("slide_a", "prismatic", "torso", "a", "0 0 0", along_x) +
                               joint("slide_b", "prismatic", "torso", "b", "0 0 0", along_x) +
                               joint("elsewhere", "prismatic", "root", "other", "0 0 0", along_x));
  const auto scene = sceneOf(robot, {boxAt("wall", {3.4, 0.0, 0.0}, {1.0, 1.0, 1.0})});
  CertifiedSurroundings surroundings(scene, {"lift", "slide_a", "slide_b"}, Fidelity::MESH);
  RobotState state;
  state.positions = robot->zeroPositions();
  state.positions[robot->findJoint("slide_a")] = 1.0;
  state.positions[robot->findJoint("slide_b")] = 2.2;
  state.positions[robot->findJoint("elsewhere")] = -0.2;
  surroundings.setState(state);
  const StoppingTube still{{0.0, 0.0, 0.0}, {1e-6, 1e-6, 1e-6}, {0.0, 0.0, 0.0}, 0.0};
  for (int combination = 0; combination < 16; ++combination) {
    const auto kept = [&](int bit) { return combination >> bit & 1 ? 0.25 : 0.15; };
    const KeptDistances all{kept(0), kept(1), combination & 4 ? 0.1 : 0.0};
    std::vector<NearPair> nearer;
    if (combination & 8) nearer = {{"wall", "b", 0.1, 1.0}, {"b", "a", -1.0, 1.0}};
    const bool links_keep = nearer.empty() && all.links > 0.2;
    const bool others_keep = all.others > 0.2;
    const bool wall_keeps = nearer.empty() && all.others + all.coming > 0.2;
    const auto found = surroundings.certify(still, all, nearer);
    EXPECT_EQ(found.is_free, !links_keep && !others_keep && !wall_keeps) << combination;
    EXPECT_TRUE(found.is_free || links_keep || !found.are_links) << combination;
  }
  const double exact = 1e-9;
  EXPECT_NEAR(surroundings.distance("a", "b", 0.3), 0.2, exact);
  EXPECT_NEAR(surroundings.distance("wall", "b", 0.3), 0.2, exact);
  EXPECT_EQ(surroundings.distance("wall", "a", 0.3), HUGE_VAL);
}

// Pairs of links are tried again by halves of the tube, each for itself.
TEST(CertifiedSurroundings, CertifyNoTubeInWhichTwoLinksComeNearer) {
  RandomInputs random;
  int nb_free = 0, nb_by_halves = 0;
  const auto robot = robotFrom(
      emptyLink("base") + bar("one", 0.5) + bar("two", 0.4) + bar("three", 0.3) +
      hinge("turn", "base", "one", "0 0 0") +
      joint("bend", "continuous", "one", "two", "0.5 0 0.1", "<axis xyz='0 1 0'/>") +
      joint("nod", "continuous", "two", "three", "0.4 0 -0.1", "<axis xyz='0 0.6 0.8'/>"));
  const std::vector<std::string> joints = {"turn", "bend", "nod"};
  const auto scene = sceneOf(robot, {});
  CertifiedSurroundings surroundings(scene, joints, Fidelity::MESH);
  MotionCheck at_once(scene);
  for (int round = 0; round < 3000; ++round) {
    JointMotion motion;
    RobotState state;
    StoppingTube tube{{}, {}, {}, 0.0};
    for (std::size_t i = 0; i < joints.size(); ++i) {
      state.positions.push_back(random.uniform(-3.0, 3.0));
      tube.from.push_back(random.uniform(-0.02, 0.0));
      tube.to.push_back(random.uniform(0.0, 0.1));
      tube.deviation.push_back(random.uniform(0.0, 0.1));
      motion.from.push_back(state.positions[i] + tube.from[i]);
      motion.to.push_back(state.positions[i] + tube.to[i]);
    }
    motion.deviation = tube.deviation;
    surroundings.setState(state);
    const KeptDistances kept{0.005, 0.01, 0.0};
    if (!surroundings.certify(tube, kept, {}).is_free) continue;
    ++nb_free;
    MotionSettings settings;
    settings.clearance = kept.links;
    settings.only_free = settings.only_moved = true;
    settings.resolution = 5e-4;
    nb_by_halves += at_once.check(motion, settings).verdict != Verdict::FREE;
    for (int sample = 0; sample < 20; ++sample) {
      const double share = random.uniform(0.0, 1.0);
      RobotState there = state;
      for (std::size_t i = 0; i < joints.size(); ++i) {
        const double side = random.integer(0, 1) ? 1.0 : random.uniform(-1.0, 1.0);
        there.positions[i] += tube.from[i] + share * (tube.to[i] - tube.from[i]) +
                              side * (random.integer(0, 1) ? 1.0 : -1.0) * tube.deviation[i];
      }
      surroundings.setState(there);
      for (const auto& [first, second] :
           {std::pair("one", "two"), {"one", "three"}, {"three", "two"}}) {
        ASSERT_GE(surroundings.distance(first, second, 0.1), kept.links - 1e-9) << round;
      }
    }
  }
  EXPECT_GT(nb_free, 300);
  EXPECT_GT(nb_by_halves, 10);
}

TEST(CertifiedSurroundings, SayNothingAfterTheirDeadline) {
  const auto scene = sceneOf(slidingBox(), {boxAt("box", {9.0, 0.0, 0.0}, {1, 1, 1})});
  CertifiedSurroundings surroundings(scene, {"slide_a"}, Fidelity::MESH);
  RobotState state;
  state.positions = {0.0};
  surroundings.setState(state);
  const StoppingTube tube{{0.0}, {1e-4}, {0.0}, 0.0};
  std::vector<NearPair> pairs;
  std::string why;
  const auto now = std::chrono::steady_clock::now();
  surroundings.setDeadline(now + std::chrono::hours(1));
  EXPECT_TRUE(surroundings.certify(tube, ONE_CM, {}).is_free);
  EXPECT_TRUE(surroundings.nearPairs(0.3, {2.0}, pairs, why));
  EXPECT_TRUE(surroundings.leadsApart(tube, {"a", "box", 0.0, 1.0, false}));
  surroundings.setDeadline(now);
  const auto certificate = surroundings.certify(tube, ONE_CM, {});
  EXPECT_FALSE(certificate.is_free);
  EXPECT_EQ(certificate.why, "the time for the decision is over");
  EXPECT_FALSE(surroundings.nearPairs(0.3, {2.0}, pairs, why));
  EXPECT_EQ(why, "the time for the decision is over");
  EXPECT_FALSE(surroundings.leadsApart(tube, {"a", "box", 0.0, 1.0, false}));
}

// The state that was set is the one that later questions are about.
TEST(CertifiedSurroundings, LeadApartIfNoPlaceOfThePathIsNearerThanTheState) {
  const auto scene = sceneOf(slidingBox(), {boxAt("box", {1.0, 0.0, 0.0}, {1, 1, 1})});
  CertifiedSurroundings surroundings(scene, {"slide_a"}, Fidelity::MESH);
  RobotState state;
  state.positions = {0.05};  // 5 cm deep
  surroundings.setState(state);
  const NearPair pair{"a", "box", -0.05, 1.0, false};
  EXPECT_TRUE(surroundings.leadsApart({{0.0}, {-0.01}, {0.0}, 0.0}, pair));
  EXPECT_TRUE(surroundings.leadsApart({{0.0}, {-0.2}, {0.0}, 0.0}, pair));
  EXPECT_FALSE(surroundings.leadsApart({{0.0}, {0.01}, {0.0}, 0.0}, pair));
  EXPECT_FALSE(surroundings.leadsApart({{0.01}, {-0.2}, {0.0}, 0.0}, pair));
  std::vector<NearPair> pairs;
  std::string why;
  ASSERT_TRUE(surroundings.nearPairs(0.3, {1.0}, pairs, why));
  ASSERT_EQ(pairs.size(), 1u);
  EXPECT_NEAR(pairs[0].distance, -0.05, 1e-9);
}

/// A checker that is being made for as long as the test wants.
struct SlowlyMade {
  std::mutex mutex;
  std::condition_variable changed;
  bool may_go_on = false;
  PreparedSurroundings::Wanted wanted;

  PreparedSurroundings::Wanted ask() {
    const std::lock_guard<std::mutex> lock(mutex);
    return wanted;
  }
  std::shared_ptr<CertifiedSurroundings> make(const PreparedSurroundings::Wanted& of) {
    std::unique_lock<std::mutex> lock(mutex);
    changed.wait(lock, [this] { return may_go_on; });
    return std::make_shared<CertifiedSurroundings>(of.scene, std::vector<std::string>{"slide_a"},
                                                   of.fidelity);
  }
  void set(const PreparedSurroundings::Wanted& next, bool goes_on) {
    const std::lock_guard<std::mutex> lock(mutex);
    wanted = next;
    may_go_on = goes_on;
    changed.notify_all();
  }
};

TEST(PreparedSurroundings, AreThoseOfTheSceneThatIsWantedOrNone) {
  using std::chrono::steady_clock;
  const auto scene = [](double x) {
    return sceneOf(slidingBox(), {boxAt("box", {x, 0.0, 0.0}, {1, 1, 1})});
  };
  const PreparedSurroundings::Wanted first{scene(5.0), Fidelity::MESH},
      second{scene(6.0), Fidelity::MESH}, coarser{second.scene, Fidelity::OBB};
  SlowlyMade slowly;
  slowly.set(first, true);
  PreparedSurroundings prepared([&] { return slowly.ask(); },
                                [&](const auto& of) { return slowly.make(of); });
  const auto patience = [] { return steady_clock::now() + std::chrono::minutes(1); };
  EXPECT_EQ(prepared.get(first, patience())->scene(), first.scene);
  slowly.set(second, false);
  for (int i = 0; i < 3; ++i) {
    EXPECT_THROW(prepared.get(second, steady_clock::now()), InputError)
        << "not the old one, and no waiting";
  }
  slowly.set(second, true);
  EXPECT_EQ(prepared.get(second, patience())->scene(), second.scene);
  slowly.set(coarser, true);
  EXPECT_EQ(prepared.get(coarser, patience())->scene(), second.scene);
  const PreparedSurroundings::Wanted refused{sceneOf(turningBar(), {}), Fidelity::MESH};
  slowly.set(refused, true);  // it has no joint slide_a
  EXPECT_THROW(prepared.get(refused, patience()), InputError);
  slowly.set(first, true);
  EXPECT_EQ(prepared.get(first, patience())->scene(), first.scene);
}

}  // namespace collision_pairs::test_certified_surroundings
