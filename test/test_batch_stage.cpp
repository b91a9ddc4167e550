#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include <gtest/gtest.h>

#include "batch_stage.h"
#include "batch_verdicts.h"
#include "collision_pairs/collision_detector.h"
#include "collision_pairs/input_error.h"
#include "random_robot.h"

namespace collision_pairs::test_batch_stage {

using Eigen::Vector3d;
using Outcome = BatchStage::Group::Outcome;

constexpr std::size_t STATES = BatchCheck::STATES_WORTH_A_STAGE;

std::shared_ptr<const CollisionScene> sceneOf(const std::shared_ptr<const RobotModel>& robot) {
  return CollisionScene::build(robot, std::nullopt, nullptr);
}

/// Within what the kernels are given.
std::vector<double> positionsFor(const BatchModel& model, RandomInputs& random,
                                 const RobotModel& robot) {
  while (true) {
    const std::vector<double> q = randomPositions(random, robot);
    const auto& columns = model.columns;
    if (std::all_of(columns.begin(), columns.end(), [&](const BatchModel::Column& column) {
          return std::abs(q[column.joint]) <= column.most;
        })) {
      return q;
    }
  }
}

TEST(BatchKinematics, AreOffByNoMoreThanDerived) {
  RandomInputs random;
  double worst = 0.0;  // of the bound
  for (int round = 0; round < 30; ++round) {
    SceneDescription description;
    description.robots.push_back({randomRobot(random, 12), std::nullopt, "a"});
    description.robots.push_back({randomRobot(random, 3), std::nullopt, "b"});
    description.robots.back().X_WR = random.pose(20.0);
    const auto scene = CollisionScene::build(description);
    const BatchModel model(*scene, true);
    for (const BatchKernel& kernel : batchKernels()) {
      const auto nb_lanes = static_cast<std::size_t>(kernel.lanes);
      std::vector<double> columns((model.columns.size() + 1) * nb_lanes);
      std::vector<std::vector<double>> states;
      for (std::size_t lane = 0; lane < nb_lanes; ++lane) {
        states.push_back(positionsFor(model, random, scene->robot()));
        for (std::size_t i = 0; i < model.columns.size(); ++i) {
          columns[i * nb_lanes + lane] = states[lane][model.columns[i].joint];
        }
      }
      std::vector<Eigen::Matrix<float, 16, 1>> memory(12 * model.bodies.size() + 4);
      const auto address = reinterpret_cast<std::uintptr_t>(memory.data());
      auto* const poses = reinterpret_cast<float*>((address + 63) / 64 * 64);
      kernel.place(model.tables(), {columns.data(), poses, nullptr, nullptr, 1, nullptr, nullptr});
      for (std::size_t lane = 0; lane < nb_lanes; ++lane) {
        std::vector<Eigen::Isometry3d> X_WB;
        scene->robot().forwardKinematics(states[lane], X_WB);
        for (std::size_t i = 0; i < model.bodies.size(); ++i) {
          const auto entry = [&](int row) {
            return static_cast<double>(
                poses[(12 * i + static_cast<std::size_t>(row)) * nb_lanes + lane]);
          };
          const Vector3d z(entry(6), entry(7), entry(8)), p(entry(9), entry(10), entry(11));
          const int id = model.robot_body[i];
          const Body& body = scene->robot().bodies()[id];
          const bool moves = body.joint >= 0 && scene->robot().joints()[body.joint].hasPosition();
          const Vector3d axis =
              moves ? scene->robot().joints()[body.joint].axis : Vector3d(Vector3d::UnitZ());
          const PoseError& bound = model.errors[i];
          const double of_axis = (z - X_WB[id].linear() * axis).norm();
          const double of_place = (p - X_WB[id].translation()).norm();
          ASSERT_LE(of_axis, bound.rotation);
          ASSERT_LE(of_place, bound.position);
          ASSERT_LE(X_WB[id].translation().norm(), bound.reach + 1e-9);
          worst = std::max({worst, of_axis / bound.rotation, of_place / bound.position});
          const Vector3d x(entry(0), entry(1), entry(2)), y(entry(3), entry(4), entry(5));
          ASSERT_LE((x.cross(y) - z).norm(), 4.0 * bound.rotation);
          if (moves) continue;
          ASSERT_LE((x - X_WB[id].linear().col(0)).norm(), bound.rotation);
          ASSERT_LE((y - X_WB[id].linear().col(1)).norm(), bound.rotation);
        }
      }
    }
  }
  EXPECT_GT(worst, 0.02) << "the bounds say nothing";
}

// Every float of the range that angles are brought to would take minutes: every 1009th.
TEST(BatchKinematics, SinesAreOffByNoMoreThanDerived) {
  const auto robot =
      robotFrom(emptyLink("root") + boxLink("arm", 0.1) +
                joint("turn", "continuous", "root", "arm", "0 0 0", "<axis xyz='0 0 1'/>") +
                boxLink("end", 0.1) +
                joint("slide", "prismatic", "arm", "end", "1 0 0",
                      "<axis xyz='0 0 1'/><limit lower='-1' upper='1'/>"));
  const auto scene = sceneOf(robot);
  SceneDescription description;
  description.robots.push_back({robot, Srdf(), ""});
  const auto unfiltered = CollisionScene::build(description);
  const BatchModel model(*unfiltered, true);
  ASSERT_EQ(model.bodies.size(), 3u);
  const BatchKernel& kernel = batchKernels().front();
  const auto nb_lanes = static_cast<std::size_t>(kernel.lanes);
  std::vector<double> columns(2 * nb_lanes, 0.0);
  std::vector<float> memory(12 * 3 * nb_lanes + 16);
  const auto address = reinterpret_cast<std::uintptr_t>(memory.data());
  auto* const poses = reinterpret_cast<float*>((address + 63) / 64 * 64);
  double worst = 0.0;
  int lane = 0;
  const auto try_angle = [&](double angle) {
    columns[static_cast<std::size_t>(lane++)] = angle;
    if (lane < kernel.lanes) return;
    lane = 0;
    kernel.place(model.tables(), {columns.data(), poses, nullptr, nullptr, 1, nullptr, nullptr});
    for (std::size_t l = 0; l < nb_lanes; ++l) {  // the arm's x axis in W
      const double cosine = poses[12 * nb_lanes + l], sine = poses[13 * nb_lanes + l];
      worst = std::max(
          {worst, std::abs(cosine - std::cos(columns[l])), std::abs(sine - std::sin(columns[l]))});
    }
  };
  for (std::uint32_t bits = 0; bits < 0x3f490fdb; bits += 1009) {
    float angle;
    std::memcpy(&angle, &bits, sizeof angle);
    try_angle(angle);
    try_angle(-angle);
  }
  for (int i = 0; i < 1000000; ++i) try_angle(1e4 * std::sin(1.0 + i));
  EXPECT_LE(worst, 4.0 / (1 << 24));
}

TEST(BatchStage, KernelsTellEachStateTheSame) {
  RandomInputs random;
  int nb_settled = 0, nb_open = 0;
  for (int round = 0; round < 20; ++round) {
    const auto scene = CollisionScene::build(randomScene(random));
    std::vector<std::vector<double>> states;
    for (int i = 0; i < 64; ++i) states.push_back(randomPositions(random, scene->robot()));
    std::vector<std::vector<Outcome>> outcomes;
    for (const BatchKernel& kernel : batchKernels()) {
      const auto stage = BatchStage::make(*scene, Fidelity::MESH, kernel);
      ASSERT_NE(stage, nullptr);
      BatchStage::Group group(*stage);
      outcomes.emplace_back();
      for (int i = 0; i < 64; i += group.lanes()) {
        group.clear();
        for (int lane = 0; lane < group.lanes(); ++lane) group.set(lane, states[i + lane]);
        group.settle();
        for (int lane = 0; lane < group.lanes(); ++lane) {
          outcomes.back().push_back(group.outcome(lane));
          (group.outcome(lane) == Outcome::OPEN ? nb_open : nb_settled)++;
        }
      }
      EXPECT_EQ(outcomes.back(), outcomes.front()) << kernel.name;
    }
  }
  EXPECT_GT(nb_settled, nb_open);
}

// OPEN goes to the exact check: where nothing is open, that would be time for nothing.
TEST(BatchStage, LeavesOpenOnlyWhatItNamesAndNamesWhatIsNearContact) {
  RandomInputs random;
  int nb_open = 0, nb_states = 0;
  double furthest = 0.0, sum = 0.0;  // metres between the nearest two of an open state
  std::set<double> distances;        // a pair that no joint moves is open in all states or none
  for (int round = 0; round < 12; ++round) {
    const auto scene = CollisionScene::build(randomScene(random));
    const auto stage = BatchStage::make(*scene);
    ASSERT_NE(stage, nullptr);
    BatchStage::Group group(*stage);
    CollisionDetector detector(scene);
    CheckSettings settings;
    settings.min_distance = true;
    std::vector<std::vector<double>> states;
    std::vector<BoxPair> pairs;
    std::vector<std::uint32_t> beside_static;
    std::vector<Eigen::Isometry3d> X_RB;
    BodyPoses poses;
    for (int i = 0; i < 32; i += group.lanes()) {
      group.clear();
      for (int lane = 0; lane < group.lanes(); ++lane) {
        states.push_back(positionsFor(stage->model(), random, scene->robot()));
        ASSERT_TRUE(group.set(lane, states.back()));
      }
      group.settle();
      for (int lane = 0; lane < group.lanes(); ++lane) {
        ++nb_states;
        if (group.outcome(lane) == Outcome::CONTACT) continue;
        group.openPairs(lane, pairs);
        group.openBesideStatic(lane, beside_static);
        EXPECT_EQ(group.outcome(lane) == Outcome::OPEN, !pairs.empty() || !beside_static.empty());
        if (group.outcome(lane) == Outcome::FREE) continue;
        ++nb_open;
        scene->robot().forwardKinematics(states[static_cast<std::size_t>(i + lane)], X_RB);
        scene->gatherPoses(X_RB, poses);
        const double distance = detector.detect(poses, settings).min_distance;
        furthest = std::max(furthest, distance);
        if (distances.insert(distance).second) sum += std::max(0.0, distance);
      }
    }
  }
  EXPECT_GT(nb_open, 5);
  EXPECT_LT(nb_open, 0.3 * nb_states);
  EXPECT_LT(sum, 0.01 * static_cast<double>(distances.size()));
  EXPECT_LT(furthest, 0.06);
}

TEST(BatchStage, MemoryIsThatOfItsFieldsTooOneForEachSetOfStaticThings) {
  const auto memoryWith = [](int nb_things) {
    SceneDescription description;
    description.robots.push_back({robotFrom(slidingBoxes(3)), std::nullopt, ""});
    for (int i = 0; i < nb_things; ++i) {
      RigidObject thing;
      thing.name = "thing" + std::to_string(i);
      thing.elements.push_back({Box{{0.1, 0.1, 0.1}}, Eigen::Isometry3d::Identity()});
      thing.X_PO.translation() = Vector3d(0, 3, i);
      if (i > 0) thing.touch_links = {"a"};  // which has another set then
      description.objects.push_back(thing);
    }
    return static_cast<double>(BatchStage::make(*CollisionScene::build(description))->memory());
  };
  const double of_field = 24.0 * StaticField::SIDE * StaticField::SIDE * StaticField::SIDE;
  EXPECT_NEAR(memoryWith(1) - memoryWith(0), of_field, 0.01 * of_field);
  EXPECT_NEAR(memoryWith(2) - memoryWith(0), 2.0 * of_field, 0.01 * of_field);
}

TEST(BatchModel, MemoryIsThatOfSpheresAboutStaticThingsToo) {
  SceneDescription description;
  description.robots.push_back({robotFrom(slidingBoxes(3)), std::nullopt, ""});
  const BatchModel without(*CollisionScene::build(description), true);
  RigidObject drum;
  drum.name = "drum";
  drum.elements.push_back({Cylinder{0.3, 1.0}, Eigen::Isometry3d::Identity()});
  drum.X_PO.translation() = Vector3d(0, 3, 0);
  description.objects.push_back(drum);
  const auto scene = CollisionScene::build(description);
  const BatchModel with(*scene, true);
  const SphereCover& cover = with.covers[scene->models()[scene->findModel("drum")].first_element];
  EXPECT_GT(cover.outer.size(), 50u);
  EXPECT_EQ(with.memory() - without.memory(),
            cover.outer.size() * sizeof(OuterSphere) + cover.inner.size() * sizeof(PlacedSphere));
}

TEST(BatchStage, VerdictsAreThoseOfTheExactCheckInScenesOfAllKinds) {
  RandomInputs random;
  int nb[3] = {0, 0, 0}, nb_staged = 0;
  for (int round = 0; round < 25; ++round) {
    SCOPED_TRACE("scene " + std::to_string(round));
    const auto scene = CollisionScene::build(randomScene(random));
    Verdicts verdicts(scene);
    std::vector<std::vector<double>> states;
    for (std::size_t i = 0; i < STATES; ++i) {
      states.push_back(randomPositions(random, scene->robot()));
    }
    const auto found = verdicts.batch(states);
    nb_staged += verdicts.check().stageMemory() > 0;
    for (std::size_t i = 0; i < STATES; i += 15) {
      const Verdict exact = verdicts.exact(states[i]);
      ++nb[static_cast<int>(exact)];
      ASSERT_EQ(found[i], exact) << "state " << i;
    }
  }
  EXPECT_GT(nb_staged, 20);  // some random scene may hold what the stage does not handle
  EXPECT_GT(nb[static_cast<int>(Verdict::FREE)], 1000);
  EXPECT_GT(nb[static_cast<int>(Verdict::COLLISION)], 1000);
}

TEST(BatchStage, StatesThatAreNoNumbersOrFarOffComeToTheExactCheck) {
  RandomInputs random;
  // The hand is in contact with the post in some fifth of a turn: a wrong angle is noticed.
  const auto robot =
      robotFrom(slidingBoxes(3) + boxLink("arm", 0.1) +
                joint("turn", "continuous", "root", "arm", "0 5 0", "<axis xyz='0 0 1'/>") +
                boxLink("hand", 0.4) + joint("wrist", "fixed", "arm", "hand", "1 0 0") +
                boxLink("post", 0.4) + joint("base", "fixed", "root", "post", "0 6 0"));
  const auto jointNamed = [&](const std::string& name) {
    const auto& joints = robot->joints();
    return static_cast<std::size_t>(
        std::find_if(joints.begin(), joints.end(), [&](auto& one) { return one.name == name; }) -
        joints.begin());
  };
  const std::size_t moving[] = {jointNamed("slide_a"), jointNamed("slide_b"), jointNamed("slide_c"),
                                jointNamed("turn")};
  Verdicts verdicts(sceneOf(robot));
  std::vector<std::vector<double>> states;
  for (std::size_t i = 0; i < STATES; ++i) {
    states.push_back(robot->zeroPositions());
    for (int slide = 0; slide < 3; ++slide) states[i][moving[slide]] = random.uniform(-4, 4);
    const double far_off = std::pow(10.0, random.uniform(4.0, 18.0));
    const double odd[] = {std::nan(""), HUGE_VAL, 1e5, -1e300, 50.0, far_off};
    if (i % 7 == 0) states[i][moving[i % 4]] = odd[random.integer(0, 5)];
  }
  const auto found = verdicts.batch(states);
  EXPECT_GT(verdicts.check().stageMemory(), 0u);
  int nb_unknown = 0;
  for (std::size_t i = 0; i < STATES; ++i) {
    ASSERT_EQ(found[i], verdicts.exact(states[i])) << testing::PrintToString(states[i]);
    nb_unknown += found[i] == Verdict::UNKNOWN;
  }
  EXPECT_GT(nb_unknown, 100);
}

TEST(BatchStage, StatesThatLackAJointAreRefusedByTheStageAsByTheExactCheck) {
  const auto scene = sceneOf(robotFrom(slidingBoxes(3)));
  std::vector<std::vector<double>> states(STATES, scene->robot().zeroPositions());
  for (const std::size_t size : {std::size_t{0}, std::size_t{2}, std::size_t{4}}) {
    states[STATES / 2].resize(size);
    const std::vector<std::vector<double>> few(states.begin() + STATES / 2,
                                               states.begin() + STATES / 2 + 1);
    EXPECT_THROW(Verdicts(scene).batch(few), InputError);
    EXPECT_THROW(Verdicts(scene).batch(states), InputError);
  }
}

TEST(BatchStage, IsMadeOnlyForBatchesThatRepayItAndForNothingButVerdicts) {
  const auto scene = sceneOf(robotFrom(slidingBoxes(3)));
  const std::vector<std::vector<double>> states(STATES, scene->robot().zeroPositions());
  Verdicts few(scene);
  few.batch({states.begin(), states.begin() + 100});
  EXPECT_EQ(few.check().stageMemory(), 0u);
  few.batch(states);
  EXPECT_GT(few.check().stageMemory(), 0u);
  for (int setting = 0; setting < 4; ++setting) {
    Verdicts verdicts(scene);
    if (setting == 0) verdicts.settings().verdict_only = false;
    if (setting == 1) verdicts.settings().fidelity = Fidelity::CONVEX;
    if (setting == 2) verdicts.settings().time_budget = 1.0;
    if (setting == 3) verdicts.settings().min_distance = true;
    EXPECT_EQ(verdicts.batch(states).front(), Verdict::COLLISION);
    EXPECT_EQ(verdicts.check().stageMemory(), 0u);
  }
}

TEST(BatchStage, LinksOfOneBodyThatAlwaysTouchAreInContactInEveryState) {
  for (const bool they_touch : {true, false}) {
    const auto robot =
        robotFrom(boxLink("base", 0.1) + boxLink("arm", 0.1) + boxLink("tool", 0.1) +
                  joint("turn", "continuous", "base", "arm", "0 0 1", "<axis xyz='0 0 1'/>") +
                  joint("weld", "fixed", "arm", "tool", they_touch ? "0.05 0 0" : "0.2 0 0"));
    Verdicts verdicts(CollisionScene::build(robot, Srdf{}, nullptr));
    const std::vector<std::vector<double>> states(STATES, {0.5, 0.0});
    const Verdict expected = they_touch ? Verdict::COLLISION : Verdict::FREE;
    EXPECT_EQ(verdicts.exact(states.front()), expected);
    EXPECT_EQ(verdicts.batch(states), std::vector<Verdict>(STATES, expected));
    EXPECT_GT(verdicts.check().stageMemory(), 0u);
  }
}

TEST(BatchStage, SettingsThatTheExactCheckRefusesAreRefused) {
  const auto scene = sceneOf(robotFrom(slidingBoxes(3)));
  const std::vector<std::vector<double>> states(STATES, scene->robot().zeroPositions());
  for (int setting = 0; setting < 3; ++setting) {
    Verdicts verdicts(scene);
    if (setting == 0) verdicts.settings().alarm_distance = std::nan("");
    if (setting == 1) verdicts.settings().tolerance = -1.0;
    if (setting == 2) verdicts.settings().time_budget = -1.0;
    EXPECT_THROW(verdicts.exact(states.front()), InputError) << setting;
    EXPECT_THROW(verdicts.batch(states), InputError) << setting;
  }
}

TEST(BatchStage, WhatItDoesNotHandleComesToTheExactCheckAsAWhole) {
  RandomInputs random;
  const auto robot = robotFrom(slidingBoxes(3));
  const std::vector<std::vector<double>> states(STATES, {0.0, 2.0, 4.0});
  for (int kind = 0; kind < 5; ++kind) {
    SCOPED_TRACE(kind);
    SceneDescription description;
    description.robots.push_back({robot, std::nullopt, ""});
    if (kind == 0) description.clouds.push_back(cloudOf("cloud", 0.1, {}));
    if (kind == 1) description.settings.narrow_phase = NarrowPhaseMethod::FCL;
    if (kind == 2) description.settings.link_fidelity["a"] = Fidelity::OBB;
    if (kind == 3) description.robots[0].X_WR.translation() = Vector3d(1e5, 0, 0);
    if (kind == 4) {
      description.objects.push_back(floorAt(-9.0, {"a"}));
      description.objects.back().attached_link = "a";
    }
    const auto scene = CollisionScene::build(description);
    Verdicts verdicts(scene);
    EXPECT_EQ(verdicts.batch(states).front(), verdicts.exact(states.front()));
    EXPECT_EQ(verdicts.check().stageMemory(), 0u);
  }
}

}  // namespace collision_pairs::test_batch_stage
