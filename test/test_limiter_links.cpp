// What the limiter is told of a robot's own links: which pairs they are, and how near they come.
#include <cmath>
#include <map>

#include <gtest/gtest.h>

#include "certified_surroundings.h"
#include "motion_fixtures.h"
#include "random_robot.h"

namespace collision_pairs::test_limiter_links {

constexpr KeptDistances ONE_CM = {0.01, 0.01, 0.0};

/// Of all pairs, also of links that a joint connects.
SceneDescription ofAllPairs(std::shared_ptr<const RobotModel> robot,
                            std::vector<RigidObject> objects) {
  SceneDescription description = described(std::move(robot), std::move(objects));
  description.robots[0].srdf = Srdf();
  return description;
}

/// Boxes a and c, both on a torso, or on the base that it stands on.
std::shared_ptr<const RobotModel> boxOnASlide(const std::string& type = "prismatic",
                                              const std::string& on = "torso") {
  const std::string along_x = "<axis xyz='1 0 0'/><limit lower='-9' upper='9'/>";
  return robotFrom(boxLink("base", 1.0) + emptyLink("torso") + boxLink("a", 1.0) +
                   boxLink("c", 1.0) +
                   joint("lift", "prismatic", "base", "torso", "0 0 0", along_x) +
                   joint("slide_a", "prismatic", on, "a", "0 0 0", along_x) +
                   joint("joint_c", type, on, "c", "0 0 0", along_x));
}

/// Of the pair of `a`, which slides, and the named model, 5 mm apart, if all others are far away.
struct OfFiveMillimetres {
  NearPair near;
  bool keeps_two_millimetres = false;  ///< is certified if links keep 2 mm and all else 1 cm
};
OfFiveMillimetres ofFiveMillimetres(const SceneDescription& description, const std::string& other,
                                    const std::map<std::string, double>& positions,
                                    const PlacedBodies& placed = {}) {
  const auto scene = CollisionScene::build(description);
  CertifiedSurroundings surroundings(scene, {"slide_a"}, Fidelity::MESH);
  RobotState state;
  state.positions = scene->robot().zeroPositions();
  for (const auto& [joint, position] : positions) {
    state.positions[scene->robot().findJoint(joint)] = position;
  }
  state.placed = placed;
  surroundings.setState(state);
  std::vector<NearPair> pairs;
  std::string why;
  EXPECT_TRUE(surroundings.nearPairs(0.1, {1.0}, pairs, why)) << why;
  EXPECT_EQ(pairs.size(), 1u) << other;
  OfFiveMillimetres found;
  found.near = pairs.at(0);
  EXPECT_TRUE(found.near.first == other || found.near.second == other) << other;
  EXPECT_NEAR(found.near.distance, 0.005, 1e-9) << other;
  const StoppingTube tube{{0.0}, {1e-6}, {0.0}, 0.0};
  const auto certified = surroundings.certify(tube, {0.002, 0.01, 0.0}, {});
  found.keeps_two_millimetres = certified.is_free;
  if (!certified.is_free) {
    EXPECT_EQ(certified.are_links, found.near.are_links);
  }
  EXPECT_FALSE(surroundings.certify(tube, ONE_CM, {}).is_free) << other;
  EXPECT_TRUE(surroundings.certify(tube, {0.002, 0.002, 0.0}, {}).is_free) << other;
  return found;
}

TEST(LimiterLinks, AreTwoOfOneRobotThatJointsMove) {
  constexpr double NEXT = 1.005, FAR = 8.0;
  const auto expect = [](const OfFiveMillimetres& found, bool is_robot, bool are_links) {
    EXPECT_EQ(found.near.is_robot, is_robot);
    EXPECT_EQ(found.near.are_links, are_links);
    EXPECT_EQ(found.keeps_two_millimetres, are_links);
  };
  const auto alone = ofAllPairs(boxOnASlide(), {});
  expect(ofFiveMillimetres(alone, "c", {{"slide_a", -4.0}, {"joint_c", -4.0 - NEXT}}), true, true);
  // Two arms on one base stand where somebody has measured it.
  expect(ofFiveMillimetres(ofAllPairs(boxOnASlide("prismatic", "base"), {}), "c",
                           {{"slide_a", -4.0}, {"joint_c", -4.0 - NEXT}}),
         true, false);
  // A link that no joint moves may be a table.
  expect(ofFiveMillimetres(alone, "base", {{"slide_a", NEXT}, {"joint_c", FAR}}), true, false);
  const Eigen::Vector3d size(1, 1, 1);
  expect(ofFiveMillimetres(ofAllPairs(boxOnASlide(), {boxAt("box", {3.0 + NEXT, 0, 0}, size)}),
                           "box", {{"slide_a", 3.0}, {"joint_c", FAR}}),
         false, false);
  RigidObject held = boxAt("held", {0, 2, 0}, size);
  held.attached_link = "c";  // in a pose that a camera may have told
  held.X_PO.translation() = Eigen::Vector3d(-4.0, 0.0, 0.0);
  expect(ofFiveMillimetres(ofAllPairs(boxOnASlide(), {held}), "held",
                           {{"slide_a", FAR - 4.0 + NEXT}, {"joint_c", FAR}}),
         true, false);
  auto two = alone;
  two.robots.push_back({slidingBox(), std::nullopt, "other"});
  expect(ofFiveMillimetres(two, "other/a",
                           {{"slide_a", 3.0}, {"joint_c", FAR}, {"other/slide_a", 3.0 + NEXT}}),
         true, false);
  // TF says where a link is, up to max_pose_age ago: on a floating joint, or on one that no joint
  // state names.
  for (const char* const type : {"floating", "prismatic"}) {
    const auto robot = boxOnASlide(type);
    PlacedBodies placed(robot->bodies().size());
    placed[robot->links()[robot->findLink("c")].body] =
        Eigen::Translation3d(3.0 + NEXT, 0, 0) * Eigen::Isometry3d::Identity();
    expect(ofFiveMillimetres(ofAllPairs(robot, {}), "c", {{"slide_a", 3.0}}, placed), true, false);
  }
}

// Nothing but positions and the exact check is used to judge.
TEST(LimiterLinks, WhatIsCertifiedKeepsItsDistanceWhereverTheJointsDeviateTo) {
  RandomInputs random;
  int nb_free = 0, nb_free_links = 0;
  for (int round = 0; round < 500; ++round) {
    const auto robot = randomRobot(random, random.integer(2, 5));
    const auto scene = sceneOf(robot, {boxAt("box", random.vector(-0.8, 0.8), {0.2, 0.1, 0.3})});
    std::vector<std::string> joints;
    bool has_floating = false;  // or planar: those do not move
    for (const Joint& joint : robot->joints()) {
      has_floating |= !joint.hasPosition() && joint.type != JointType::FIXED;
      if (joint.hasPosition() && !joint.mimic) joints.push_back(joint.name);
    }
    if (joints.empty() || has_floating) continue;
    CertifiedSurroundings surroundings(scene, joints, Fidelity::MESH);
    RobotState state;
    state.positions = randomPositions(random, *robot);
    surroundings.setState(state);
    const double most = random.uniform(0.0, 0.3);
    StoppingTube tube;
    for (std::size_t i = 0; i < joints.size(); ++i) {
      tube.from.push_back(random.uniform(-0.1, 0.1));
      tube.to.push_back(tube.from.back() + random.uniform(-0.2, 0.2));
      tube.deviation.push_back(random.uniform(0.0, most));
    }
    const KeptDistances kept{random.uniform(0.0, 0.02), random.uniform(0.0, 0.02), 0.0};
    if (!surroundings.certify(tube, kept, {}).is_free) continue;
    ++nb_free;
    CollisionDetector detector(scene);
    CheckSettings settings;
    settings.alarm_distance = 0.2;
    for (int k = 0; k < 40; ++k) {
      std::vector<double> q = state.positions;
      const double f = random.uniform(0.0, 1.0);
      for (std::size_t i = 0; i < joints.size(); ++i) {
        const double off = random.integer(0, 1) ? -1.0 : 1.0;
        q[robot->findJoint(joints[i])] +=
            tube.from[i] + f * (tube.to[i] - tube.from[i]) + off * tube.deviation[i];
      }
      robot->applyMimics(q);
      std::vector<Eigen::Isometry3d> X_RB;
      robot->forwardKinematics(q, X_RB);
      BodyPoses poses;
      scene->gatherPoses(X_RB, poses);
      for (const PairReport& pair : detector.detect(poses, settings).pairs) {
        const auto bodyOf = [&](std::uint32_t model) {
          const int body = scene->models()[model].body;
          return body < 0 ? 0 : scene->bodies()[body].body;  // 0: the root
        };
        const auto isMoved = [&](std::uint32_t model) { return bodyOf(model) > 0; };
        if (bodyOf(pair.first) == bodyOf(pair.second)) continue;
        const bool are_links = isMoved(pair.first) && isMoved(pair.second);
        nb_free_links += are_links ? 1 : 0;
        ASSERT_GE(pair.distance, (are_links ? kept.links : kept.others) - 1e-7) << round;
      }
    }
  }
  EXPECT_GT(nb_free, 30);
  EXPECT_GT(nb_free_links, 100);
}

// A plate that turns 3 cm above another; at OBB its deviation counts in all directions.
TEST(LimiterLinks, ADeviationBetweenTwoLinksIsCertifiedInHalves) {
  const auto plate = [](const std::string& name) {
    return linkWith(name, "<box size='0.2 0.2 0.01'/>");
  };
  const auto robot = robotFrom(emptyLink("root") + plate("lower") + plate("upper") +
                               hinge("first", "root", "lower", "0 0 0") +
                               hinge("second", "lower", "upper", "0 0 0.04"));
  const auto scene = CollisionScene::build(ofAllPairs(robot, {}));
  CertifiedSurroundings surroundings(scene, {"first", "second"}, Fidelity::OBB);
  RobotState state;
  state.positions = {0.0, 0.0};
  surroundings.setState(state);
  const auto isFree = [&](double deviation) {
    return surroundings
        .certify({{0.0, 0.0}, {0.0, 0.0}, {0.0, deviation}, 0.0}, {0.004, 0.01, 0.0}, {})
        .is_free;
  };
  const double counted = 1.7320508 * 0.1415, left = 0.03 - 0.004;  // m per rad; m
  EXPECT_TRUE(isFree(0.9 * left / counted));
  EXPECT_TRUE(isFree(1.9 * left / counted)) << "either half";
  EXPECT_FALSE(isFree(2.1 * left / counted));
}

// The second hinge turns a plate in its own plane, 3 mm above the first one's.
TEST(LimiterLinks, AreNamedIfTheyAreTooNearInEveryState) {
  const auto plate = [](const std::string& name) {
    return linkWith(name, "<box size='0.2 0.2 0.01'/>");
  };
  for (const double gap : {0.003, 0.006}) {
    const auto robot =
        robotFrom(emptyLink("root") + plate("lower") + plate("upper") + bar("arm", 0.4) +
                  hinge("first", "root", "lower", "0 0 0") +
                  hinge("second", "lower", "upper", "0 0 " + std::to_string(0.01 + gap)) +
                  hinge("third", "upper", "arm", "0.4 0 -0.1"));
    const auto sceneWith = [&](std::vector<RigidObject> objects) {
      return CollisionScene::build(ofAllPairs(robot, std::move(objects)));
    };
    CertifiedSurroundings surroundings(sceneWith({boxAt("box", {0.1, 0, 0}, {1, 1, 1})}),
                                       {"first", "second"}, Fidelity::MESH);
    EXPECT_EQ(surroundings.alwaysNear({0.001, 0.01, 0.0}), std::vector<std::string>());
    const auto sentences = surroundings.alwaysNear({0.004, 0.01, 0.0});
    ASSERT_EQ(sentences.size(), gap < 0.004 ? 1u : 0u);
    if (sentences.empty()) continue;
    EXPECT_EQ(sentences[0],
              "lower and upper stop every command: in 200 random states they were never more than "
              "3.000000 mm apart; let the SRDF disable this pair if it cannot collide, or set a "
              "smaller velocity_limiter/self_stop_distance or stop_distance");
    CertifiedSurroundings third(sceneWith({}), {"first", "third"}, Fidelity::MESH);
    EXPECT_TRUE(third.alwaysNear({0.004, 0.01, 0.0}).empty()) << "no joint of it moves them";
  }
}

}  // namespace collision_pairs::test_limiter_links
