// Loose boxes come first and tight ones where they are needed: what is found is what tight boxes of
// everything find.
#include <limits>

#include <gtest/gtest.h>

#include "collision_pairs/collision_detector.h"
#include "element_boxes.h"
#include "mixed_robot.h"
#include "pose_repair.h"
#include "random_inputs.h"

namespace collision_pairs::test_element_boxes {

std::shared_ptr<const CollisionScene> mixedScene(double padding = 0.0, int max_hull_vertices = 0) {
  SceneDescription description;
  description.robots.push_back({mixedRobot(2), std::nullopt, ""});
  description.settings.padding = padding;
  description.settings.max_hull_vertices = max_hull_vertices;
  description.objects = {floorAt(-0.5, {})};
  return CollisionScene::build(description);
}

/// Rotations as a sensor may give them, not quite orthonormal; of some bodies along the axes.
void throwAboutRoughly(RandomInputs& random, BodyPoses& poses) {
  throwAbout(random, 0.7, poses);
  for (std::size_t i = 0; i < poses.X_WB.size(); i += 3) poses.X_WB[i].linear().setIdentity();
  for (Eigen::Isometry3d& X_WB : poses.X_WB) X_WB.linear() *= random.uniform(0.9996, 1.0004);
}

Aabb tightBox(const CollisionScene& scene, const BodyPoses& poses, std::uint32_t i) {
  const SceneElement& element = scene.elements()[i];
  if (element.body < 0) return element.boxAt(element.X_BE);
  Eigen::Isometry3d X_WB = poses.X_WB[static_cast<std::size_t>(element.body)];
  EXPECT_TRUE(repairPose(X_WB));
  return element.boxAt(X_WB * element.X_BE);
}

std::vector<BoxPair> pairsOfTightBoxes(const CollisionScene& scene, const BodyPoses& poses,
                                       double alarm_distance) {
  std::vector<BoxPair> pairs;
  const auto& elements = scene.elements();
  for (std::uint32_t i = 0; i < elements.size(); ++i) {
    for (std::uint32_t j = std::max(i + 1, scene.nbStaticElements()); j < elements.size(); ++j) {
      if (elements[i].model == elements[j].model) continue;
      if (!scene.filter().allowed(elements[i].model, elements[j].model)) continue;
      const double gap = squaredGap(tightBox(scene, poses, i), tightBox(scene, poses, j));
      if (gap <= squaredReach(alarm_distance)) pairs.push_back({i, j});
    }
  }
  return pairs;
}

TEST(ElementBoxes, CandidatesAreThePairsWhoseTightBoxesAreInReach) {
  RandomInputs random;
  for (const double padding : {0.0, 0.03}) {
    const auto scene = mixedScene(padding);
    CollisionDetector detector(scene);
    BodyPoses poses;
    poses.resize(scene->bodies().size());
    for (int round = 0; round < 200; ++round) {
      throwAboutRoughly(random, poses);
      CheckSettings settings;
      settings.alarm_distance = round % 2 == 0 ? 0.0 : 0.05;
      const auto expected = pairsOfTightBoxes(*scene, poses, settings.alarm_distance);
      EXPECT_EQ(detector.detect(poses, settings).candidates, expected);
      settings.time_budget = 1e9;
      EXPECT_EQ(detector.detect(poses, settings).candidates, expected);
      settings.min_distance = true;
      EXPECT_EQ(detector.detect(poses, settings).candidates, expected);
      settings.list_boxes = true;
      EXPECT_EQ(detector.detect(poses, settings).candidates, expected);
      settings.alarm_distance = settings.time_budget = 0.0;
      settings.verdict_only = true;
      EXPECT_EQ(detector.detect(poses, settings).candidates, pairsOfTightBoxes(*scene, poses, 0.0));
    }
  }
}

TEST(ElementBoxes, AreListedTightAndOnlyWhereAskedFor) {
  RandomInputs random;
  const auto scene = mixedScene(0.01);
  CollisionDetector detector(scene);
  BodyPoses poses;
  poses.resize(scene->bodies().size());
  throwAbout(random, 0.7, poses);
  poses.known[3] = false;
  CheckSettings settings;
  EXPECT_TRUE(detector.detect(poses, settings).boxes.empty());
  settings.verdict_only = true;
  EXPECT_TRUE(detector.detect(poses, settings).boxes.empty());
  EXPECT_TRUE(detector.detect(poses, settings).candidates.empty());
  settings.list_boxes = true;
  const CollisionReport& report = detector.detect(poses, settings);
  ASSERT_EQ(report.boxes.size(), scene->elements().size());
  for (std::uint32_t i = 0; i < report.boxes.size(); ++i) {
    if (scene->elements()[i].body == 3) {
      EXPECT_FALSE(report.boxes[i].valid());
      continue;
    }
    EXPECT_EQ(report.boxes[i].min, tightBox(*scene, poses, i).min);
    EXPECT_EQ(report.boxes[i].max, tightBox(*scene, poses, i).max);
  }
}

// Of each kind of rung: those that stick out of the tight boxes are the ones that need them.
TEST(ElementBoxes, VerdictsAreThoseOfAllContacts) {
  RandomInputs random;
  int nb_free = 0, nb_collisions = 0;
  for (const int max_hull_vertices : {0, 6}) {
    const auto scene = mixedScene(0.0, max_hull_vertices);
    CollisionDetector detector(scene);
    BodyPoses poses;
    poses.resize(scene->bodies().size());
    for (int round = 0; round < 400; ++round) {
      throwAbout(random, 1.5, poses);
      for (auto& X_WB : poses.X_WB) X_WB.translation().z() += 1.5;  // off the floor, mostly
      for (const Fidelity fidelity :
           {Fidelity::AABB, Fidelity::OBB, Fidelity::CONVEX, Fidelity::MESH}) {
        CheckSettings settings;
        settings.fidelity = fidelity;
        settings.alarm_distance = 0.0;
        settings.list_boxes = true;
        const Verdict expected = detector.detect(poses, settings).verdict;
        settings.list_boxes = false;
        EXPECT_EQ(detector.detect(poses, settings).verdict, expected);
        settings.verdict_only = true;
        EXPECT_EQ(detector.detect(poses, settings).verdict, expected);
        settings.list_boxes = true;
        EXPECT_EQ(detector.detect(poses, settings).verdict, expected);
        (expected == Verdict::FREE ? nb_free : nb_collisions) += 1;
      }
    }
  }
  EXPECT_GT(nb_free, 300);
  EXPECT_GT(nb_collisions, 300);
}

TEST(ElementBoxes, LooseOnesEncloseTheTightOnes) {
  RandomInputs random;
  const auto scene = mixedScene(0.02);
  ElementBoxes boxes;
  boxes.prepare(*scene);
  BodyPoses poses;
  poses.resize(scene->bodies().size());
  int nb_looser = 0;
  for (const double offset : {0.0, 1.0, 1e6, 1e12}) {
    for (int round = 0; round < 50; ++round) {
      throwAboutRoughly(random, poses);
      for (auto& X_WB : poses.X_WB) X_WB.translation() += offset * random.vector(-1, 1);
      boxes.rebuild(poses, false);
      for (std::uint32_t i = scene->nbStaticElements(); i < scene->elements().size(); ++i) {
        const Aabb tight = tightBox(*scene, poses, i);
        EXPECT_TRUE((boxes.boxes()[i].min.array() <= tight.min.array()).all());
        EXPECT_TRUE((boxes.boxes()[i].max.array() >= tight.max.array()).all());
        nb_looser += boxes.boxes()[i].min.x() < tight.min.x() - 0.01;
        boxes.tighten(i);
        EXPECT_EQ(boxes.boxes()[i].min, tight.min);
        EXPECT_EQ(boxes.boxes()[i].max, tight.max);
      }
    }
  }
  EXPECT_GT(nb_looser, 100);
}

// As the narrow phase has it: one that is nearly a rotation is repaired, anything else is no pose.
TEST(ElementBoxes, OfAPoseWithAScaleAreThoseOfItsRotationOrNone) {
  RandomInputs random;
  const auto scene = mixedScene();
  ElementBoxes boxes, sound_boxes;
  boxes.prepare(*scene);
  sound_boxes.prepare(*scene);
  BodyPoses sound, poses;
  sound.resize(scene->bodies().size());
  for (int round = 0; round < 200; ++round) {
    throwAbout(random, 2.0, sound);
    poses = sound;
    const double off = std::pow(10.0, random.uniform(-13.0, -1.0));
    for (auto& X_WB : poses.X_WB) X_WB.linear() *= round % 2 ? 1.0 - off : 1.0 + off;
    const bool all_tight = random.integer(0, 1);
    boxes.rebuild(poses, all_tight);
    sound_boxes.rebuild(sound, all_tight);
    const bool is_no_pose = off > 6e-4;  // 1e-3 of the square
    if (!is_no_pose && off > 4e-4) continue;
    EXPECT_EQ(boxes.withoutBox().empty(), !is_no_pose) << off;
    for (std::size_t i = 0; !is_no_pose && i < boxes.boxes().size(); ++i) {
      const Aabb &box = boxes.boxes()[i], &wanted = sound_boxes.boxes()[i];
      if (!wanted.valid()) continue;
      EXPECT_TRUE(box.min.isApprox(wanted.min, 1e-12) && box.max.isApprox(wanted.max, 1e-12));
    }
  }
}

// A loose box overflows sooner than the tight one, which decides whether the link is left out.
TEST(ElementBoxes, WhatHasAFiniteTightBoxIsNotLeftOut) {
  const auto scene = mixedScene();
  CollisionDetector detector(scene);
  BodyPoses poses;
  poses.resize(scene->bodies().size());
  const double largest = std::numeric_limits<double>::max();
  for (const double far :
       {1e300, 0.25 * largest, 0.5 * largest, 0.9 * largest, (1.0 - 1e-13) * largest, largest}) {
    for (auto& X_WB : poses.X_WB) X_WB.translation().setConstant(far);
    CheckSettings settings;
    const auto left_out = detector.detect(poses, settings).left_out;
    settings.list_boxes = true;
    EXPECT_EQ(detector.detect(poses, settings).left_out, left_out) << far;
    EXPECT_EQ(left_out.empty(), far < largest) << far;
  }
}

}  // namespace collision_pairs::test_element_boxes
