// Straight motions by tables and spheres: what they say of a motion is true of its configurations.
#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "benchmark/demo_motion.h"
#include "benchmark/motion_scenes.h"
#include "edge_group.h"
#include "random_robot.h"

namespace collision_pairs::test_edges {

using Outcome = BatchStage::EdgeGroup::Outcome;
using Cell = PairTable::Cell;

constexpr double TO_ROUNDING = 1e-9;  // m

/// Two links, and a line in the table of the two joints between them.
class TabledPair {
 public:
  TabledPair(RandomInputs& random, const std::string& types) {
    const std::string shapes[] = {"<mesh filename='l'/>", "<box size='0.3 0.1 0.2'/>",
                                  "<cylinder radius='0.1' length='0.3'/>",
                                  "<mesh filename='ball'/>"};
    const std::string limits = "<limit lower='-1.2' upper='1.6'/>";
    const auto typeOf = [](char t) {
      return t == 's' ? "prismatic" : t == 'c' ? "continuous" : "revolute";
    };
    const std::string& first = shapes[random.integer(0, 3)];
    const std::string& second = shapes[random.integer(0, 3)];
    const double apart = random.uniform(0.0, 0.15);
    SceneSettings settings;
    settings.padding = random.integer(0, 1) * 0.02;
    scene = CollisionScene::build(
        RobotModel::fromUrdf("<robot name='arm'>" + linkWith("a", first) + emptyLink("b") +
                                 linkWith("c", second) +
                                 joint("one", typeOf(types[0]), "a", "b",
                                       "0.03 " + std::to_string(0.13 + apart) + " 0.07",
                                       "<axis xyz='0.6 0 0.8'/>" + limits) +
                                 joint("two", typeOf(types[1]), "b", "c", "0.06 0 0.1",
                                       "<axis xyz='0 1 0'/>" + limits) +
                                 "</robot>",
                             testMesh),
        Srdf(), nullptr, settings);
  }

  std::shared_ptr<const CollisionScene> scene;
};

/// The smallest distance up to 2 APART.
double distanceAt(StateLoop& loop, const JointMotion& motion, double fraction) {
  CheckSettings settings;
  settings.alarm_distance = 2.0 * PairTable::APART;
  double smallest = settings.alarm_distance;
  for (const PairReport& pair : loop.at(motion, fraction, settings).pairs) {
    smallest = std::min(smallest, pair.distance);
  }
  return smallest;
}

TEST(PairTable, WhatItSaysOfALineIsTrueOfItsConfigurations) {
  constexpr int SAMPLES = 200;
  RandomInputs random;
  int nb[3] = {0, 0, 0};
  for (const std::string types : {"rr", "cr", "rc", "sr", "rs", "cc", "cc"}) {
    SCOPED_TRACE(types);
    const TabledPair its(random, types);
    const BatchModel model(*its.scene, true);
    PairTable table(*its.scene, model, {0, 1});
    ASSERT_EQ(table.nbJoints(), 2);
    NarrowPhase narrow_phase;
    StateLoop loop(its.scene);
    for (int i = 0; i < 300; ++i) {
      double from[2], to[2];
      for (int k = 0; k < 2; ++k) {
        const Joint& joint = its.scene->robot().joints()[table.joint(k)];
        const double lower = joint.hasLimits() ? -1.2 : -M_PI,
                     width = joint.hasLimits() ? 2.8 : 2.0 * M_PI;
        const bool is_long = !joint.hasLimits() && random.integer(0, 19) == 0;
        from[k] = random.uniform(-1.2, 1.6);
        to[k] = is_long ? random.uniform(-20.0, 20.0)
                        : std::clamp(from[k] + random.uniform(-0.4, 0.4), -1.2, 1.6);
        if (random.integer(0, 2) > 0) continue;  // corners of cells, and lines along their sides
        for (double* q : {&from[k], &to[k]}) {
          *q = lower + std::round((*q - lower) / width * PairTable::SIDE) * width / PairTable::SIDE;
        }
      }
      if (random.integer(0, 9) == 0) to[1] = from[1];
      JointMotion motion{{0.0, 0.0}, {0.0, 0.0}};
      for (int k = 0; k < 2; ++k) {
        motion.from[table.joint(k)] = from[k];
        motion.to[table.joint(k)] = to[k];
      }
      const PairTable::Along along = table.along(from, to, narrow_phase);
      ++nb[static_cast<int>(along.cell)];
      if (along.cell == Cell::CONTACT) {
        ASSERT_LE(distanceAt(loop, motion, along.begin), 0.0) << along.begin;
        continue;
      }
      for (int s = 0; s <= SAMPLES; ++s) {
        const double fraction = static_cast<double>(s) / SAMPLES;
        if (along.cell == Cell::OPEN && fraction >= along.begin && fraction <= along.end) continue;
        ASSERT_GE(distanceAt(loop, motion, fraction), PairTable::APART - TO_ROUNDING)
            << fraction << ": " << from[0] << ' ' << from[1] << " to " << to[0] << ' ' << to[1];
      }
    }
  }
  EXPECT_GT(nb[static_cast<int>(Cell::FREE)], 100);
  EXPECT_GT(nb[static_cast<int>(Cell::CONTACT)], 50);
  EXPECT_GT(nb[static_cast<int>(Cell::OPEN)], 20);
}

TEST(PairTable, LeavesALineOpenThatLeavesTheTable) {
  RandomInputs random;
  const TabledPair its(random, "rc");
  const BatchModel model(*its.scene, true);
  PairTable table(*its.scene, model, {0, 1});
  NarrowPhase narrow_phase;
  const int limited = its.scene->robot().joints()[table.joint(0)].hasLimits() ? 0 : 1;
  double from[2] = {0.0, 0.0}, to[2] = {0.0, 0.0};
  for (const double beyond : {-1.2001, 1.6001, 1e300, HUGE_VAL, std::nan("")}) {
    to[limited] = beyond;
    for (const auto& along :
         {table.along(from, to, narrow_phase), table.along(to, from, narrow_phase)}) {
      EXPECT_EQ(along.cell, Cell::OPEN) << beyond;
      EXPECT_EQ(along.begin, 0.0);
      EXPECT_EQ(along.end, 1.0);
    }
  }
  to[limited] = 0.0;
  to[1 - limited] = 1e6;
  EXPECT_EQ(table.along(from, to, narrow_phase).cell, Cell::OPEN);
}

/// Settles motions of a scene, and samples them.
class SampledEdges {
 public:
  SampledEdges(const std::shared_ptr<const CollisionScene>& scene,
               const std::unique_ptr<const BatchStage>& stage, int (&nb)[3])
      : scene_(scene), loop_(scene), group_(*stage), nb_(nb) {}

  void expectTruth(JointMotion motion, int nb_samples) {
    scene_->robot().applyMimics(motion.from);
    scene_->robot().applyMimics(motion.to);
    const Outcome outcome = group_.settle(motion.from, motion.to);
    ++nb_[static_cast<int>(outcome)];
    CheckSettings settings;
    settings.alarm_distance = PairTable::APART;
    if (outcome == Outcome::CONTACT) {
      const auto [first, second] = group_.contact();
      ASSERT_TRUE(isIn(loop_.at(motion, group_.contactAt(), settings), modelOf(first),
                       modelOf(second), PairState::CONTACT))
          << group_.contactAt();
      return;
    }
    ASSERT_EQ(outcome == Outcome::FREE, group_.parts().empty());
    for (int i = 0; i <= nb_samples; ++i) {
      const double fraction = static_cast<double>(i) / nb_samples;
      for (const PairReport& pair : loop_.at(motion, fraction, settings).pairs) {
        if (pair.distance > PairTable::APART - TO_ROUNDING) continue;
        const auto& models = scene_->models();
        const bool never_moves = models[pair.first].body == models[pair.second].body;
        if (never_moves && pair.distance > TO_ROUNDING) continue;
        ASSERT_TRUE(isLeftOpen(pair, fraction))
            << fraction << ": " << scene_->models()[pair.first].name << ' '
            << scene_->models()[pair.second].name << ' ' << pair.distance;
      }
    }
  }

 private:
  std::uint32_t modelOf(std::uint32_t element) const { return scene_->elements()[element].model; }
  static bool isIn(const CollisionReport& report, std::uint32_t first, std::uint32_t second,
                   PairState state) {
    return std::any_of(report.pairs.begin(), report.pairs.end(), [&](const PairReport& pair) {
      return pair.state == state &&
             std::minmax(pair.first, pair.second) == std::minmax(first, second);
    });
  }
  bool isLeftOpen(const PairReport& pair, double fraction) const {
    return std::any_of(group_.parts().begin(), group_.parts().end(), [&](const auto& part) {
      if (fraction < part.begin || fraction > part.end) return false;
      const std::uint32_t first = modelOf(part.pair.first);
      if (part.is_static) return first == pair.first || first == pair.second;
      return std::minmax(first, modelOf(part.pair.second)) == std::minmax(pair.first, pair.second);
    });
  }

  std::shared_ptr<const CollisionScene> scene_;
  StateLoop loop_;
  BatchStage::EdgeGroup group_;
  int (&nb_)[3];
};

JointMotion randomEdge(RandomInputs& random, const RobotModel& robot) {
  JointMotion motion{randomPositions(random, robot), {}};
  motion.to = motion.from;
  const double length = random.uniform(0.05, 2.0);
  for (std::size_t i = 0; i < motion.to.size(); ++i) {
    if (robot.joints()[i].hasPosition()) motion.to[i] += random.uniform(-length, length);
  }
  return motion;
}

TEST(EdgeGroup, WhatItSaysOfAMotionIsTrueOfItsConfigurations) {
  RandomInputs random;
  int nb[3] = {0, 0, 0};
  for (int round = 0; round < 60; ++round) {
    const auto scene = CollisionScene::build(randomScene(random));
    const auto& kernels = batchKernels();
    const auto& kernel = kernels[static_cast<std::size_t>(round) % kernels.size()];
    const auto stage = BatchStage::make(*scene, Fidelity::MESH, kernel);
    if (!stage) continue;
    SCOPED_TRACE("round " + std::to_string(round));
    SampledEdges edges(scene, stage, nb);
    for (int i = 0; i < 60; ++i) edges.expectTruth(randomEdge(random, scene->robot()), 60);
  }
  const auto demo = clutteredScene(demoRobot(), 0);
  const auto stage = BatchStage::make(*demo);
  ASSERT_TRUE(stage);
  SampledEdges edges(demo, stage, nb);
  const std::shared_ptr<const RobotModel> robot(demo, &demo->robot());
  const auto first = static_cast<std::uint64_t>(random.integer(0, 1'000'000));
  for (std::uint64_t i = 0; i < 1000; ++i) {
    edges.expectTruth(randomMotion(robot, first + i, lengthNumber(i)), 100);
  }
  EXPECT_GT(nb[static_cast<int>(Outcome::FREE)], 300);
  EXPECT_GT(nb[static_cast<int>(Outcome::CONTACT)], 300);
  EXPECT_GT(nb[static_cast<int>(Outcome::OPEN)], 100);
}

/// A ball on a long slide passes a bead: the further out it is, the further it moves between lanes.
TEST(EdgeGroup, AllowsForWhatSlidesOut) {
  RandomInputs random;
  const auto robot =
      robotFrom(emptyLink("root") + emptyLink("arm") + linkWith("ball", "<sphere radius='0.01'/>") +
                joint("turn", "continuous", "root", "arm", "0 0 0", "<axis xyz='0 0 1'/>") +
                joint("slide", "prismatic", "arm", "ball", "0 0 0",
                      "<axis xyz='1 0 0'/><limit lower='0' upper='1.5'/>"));
  for (int i = 0; i < 200; ++i) {
    const double angle = random.uniform(-0.9, 0.9);
    RigidObject bead;
    bead.name = "bead";
    bead.elements.push_back({Sphere{0.01}, Eigen::Isometry3d::Identity()});
    bead.X_PO = Eigen::Translation3d(1.4 * std::cos(angle), 1.4 * std::sin(angle), 0.0) *
                Eigen::Isometry3d::Identity();
    SceneDescription description;
    description.robots.push_back({robot, std::nullopt, ""});
    description.objects.push_back(bead);
    const auto scene = CollisionScene::build(description);
    const auto stage = BatchStage::make(*scene);
    ASSERT_TRUE(stage);
    std::vector<double> from = scene->robot().zeroPositions(), to = from;
    const auto turn = static_cast<std::size_t>(scene->robot().findJoint("turn"));
    const auto slide = static_cast<std::size_t>(scene->robot().findJoint("slide"));
    from[slide] = to[slide] = 1.4;
    from[turn] = -1.0;
    to[turn] = 1.0;
    ASSERT_NE(BatchStage::EdgeGroup(*stage).settle(from, to), Outcome::FREE) << angle;
  }
}

/// Two checks of the same motions: one has been asked for nothing else, the other for so much that
/// it has its stage.
TEST(MotionCheck, OnlyFreeIsWhatTheSearchSaysHoweverMuchWasAskedBefore) {
  RandomInputs random;
  int nb_free = 0, nb_other = 0, nb_by_stage = 0;
  std::vector<std::shared_ptr<const CollisionScene>> scenes;
  for (int i = 0; i < 3; ++i) {
    SceneDescription description;
    description.robots.push_back({randomRobot(random, 6), std::nullopt, ""});
    scenes.push_back(CollisionScene::build(description));
  }
  scenes.push_back(clutteredScene(demoRobot(), 0));
  MotionSettings only_free;
  only_free.only_free = true;
  for (const auto& scene : scenes) {
    const std::shared_ptr<const RobotModel> robot(scene, &scene->robot());
    MotionCheck search(scene), lean(scene);
    for (std::uint64_t i = 0; i < 4000; ++i) {
      const JointMotion motion = scene == scenes.back() ? randomMotion(robot, i, lengthNumber(i))
                                                        : randomEdge(random, *robot);
      const MotionReport found = lean.check(motion, only_free);
      if (i < 2500) continue;
      const bool is_free = search.check(motion, {}).verdict == Verdict::FREE;
      ASSERT_EQ(found.verdict == Verdict::FREE, is_free) << i;
      ++(is_free ? nb_free : nb_other);
      if (found.nb_checks % 4 == 0 && found.nb_queries == 0) ++nb_by_stage;
      if (found.verdict == Verdict::COLLISION) {
        CheckSettings settings;
        settings.verdict_only = true;
        ASSERT_EQ(StateLoop(scene).at(motion, found.contact_at, settings).verdict,
                  Verdict::COLLISION);
        ASSERT_FALSE(found.pairs.empty());
      }
      if (is_free) {
        ASSERT_EQ(found.clearance, 0.0);
      }
    }
  }
  EXPECT_GT(nb_free, 500);
  EXPECT_GT(nb_other, 500);
  EXPECT_GT(nb_by_stage, 200);
}

}  // namespace collision_pairs::test_edges
