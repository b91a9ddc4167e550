// What the batch stage keeps: tables of pairs of elements, and the field of what is static.
#include <cmath>

#include <gtest/gtest.h>

#include "mixed_robot.h"
#include "pair_table.h"
#include "static_field.h"

namespace collision_pairs::test_batch_tables {

using Eigen::Isometry3d;
using Eigen::Vector3d;

/// Two joints between `a` and `c`, which meet in a good part of their states; `b` has no geometry.
/// `apart`: metres by which they are further apart.
std::shared_ptr<const RobotModel> armWith(const std::string& first, const std::string& second,
                                          const std::string& types, double apart = 0.0) {
  const std::string limits = "<limit lower='-1.2' upper='1.6'/>";
  const auto typeOf = [](char t) {
    return t == 's' ? "prismatic" : t == 'c' ? "continuous" : "revolute";
  };
  return RobotModel::fromUrdf(
      "<robot name='arm'>" + linkWith("a", first) + emptyLink("b") + linkWith("c", second) +
          joint("one", typeOf(types[0]), "a", "b", "0.03 " + std::to_string(0.13 + apart) + " 0.07",
                "<axis xyz='0.6 0 0.8'/>" + limits) +
          joint("two", typeOf(types[1]), "b", "c", "0.06 0 0.1", "<axis xyz='0 1 0'/>" + limits) +
          "</robot>",
      testMesh);
}

std::shared_ptr<const CollisionScene> everyPair(const std::shared_ptr<const RobotModel>& robot,
                                                double padding) {
  SceneSettings settings;
  settings.padding = padding;
  return CollisionScene::build(robot, Srdf(), nullptr, settings);
}

TEST(PairTable, TellsWhatTheExactCheckSaysWhereverItTellsAnything) {
  RandomInputs random;
  const std::string shapes[] = {"<mesh filename='l'/>", "<box size='0.3 0.1 0.2'/>",
                                "<cylinder radius='0.1' length='0.3'/>", "<mesh filename='ball'/>"};
  int nb[3] = {0, 0, 0};
  for (const std::string types : {"rr", "cr", "rc", "sr", "rs", "cc"}) {
    SCOPED_TRACE(types);
    const std::string& second = shapes[random.integer(0, 3)];
    const std::string& first = shapes[random.integer(0, 3)];  // in this order with every compiler
    const auto robot = armWith(first, second, types);
    const auto scene = everyPair(robot, random.integer(0, 1) * 0.02);
    const BatchModel model(*scene, true);
    ASSERT_EQ(scene->elements().size(), 2u);
    for (const BoxPair pair : {BoxPair{0, 1}, BoxPair{1, 0}}) {
      PairTable table(*scene, model, pair);
      ASSERT_EQ(table.nbJoints(), 2);
      NarrowPhase narrow_phase, exact;
      for (int i = 0; i < 40000; ++i) {
        std::vector<double> q(2);
        for (double& position : q) position = random.uniform(-1.5, 1.9);
        const auto cell = table.at(q[static_cast<std::size_t>(table.joint(0))],
                                   q[static_cast<std::size_t>(table.joint(1))], narrow_phase);
        ++nb[static_cast<int>(cell)];
        if (i < 20000 && i % 10 > 0) continue;  // it learns
        if (cell == PairTable::Cell::OPEN) continue;
        std::vector<Isometry3d> X_RB;
        robot->forwardKinematics(q, X_RB);
        const auto poseOf = [&](std::uint32_t e) -> Isometry3d {
          return X_RB[scene->bodies()[scene->elements()[e].body].body] * scene->elements()[e].X_BE;
        };
        const bool touches = exact.touches(*scene->elements()[0].rung(Fidelity::MESH).shape,
                                           *scene->elements()[1].rung(Fidelity::MESH).shape,
                                           poseOf(0).inverse() * poseOf(1), scene->padding(0, 1));
        ASSERT_EQ(cell == PairTable::Cell::CONTACT, touches) << q[0] << ' ' << q[1];
      }
    }
  }
  EXPECT_GT(nb[static_cast<int>(PairTable::Cell::FREE)], 10000);
  EXPECT_GT(nb[static_cast<int>(PairTable::Cell::CONTACT)], 10000);
}

TEST(PairTable, KnowsInTheFirstStatesWhatIsFarApart) {
  RandomInputs random;
  const auto robot = armWith("<mesh filename='l'/>", "<mesh filename='ball'/>", "rr", 1.0);
  const auto scene = everyPair(robot, 0.0);
  const BatchModel model(*scene, true);
  PairTable table(*scene, model, {0, 1});
  NarrowPhase narrow_phase;
  for (int i = 0; i < 100; ++i) {
    const double first = random.uniform(-1.2, 1.6), second = random.uniform(-1.2, 1.6);
    EXPECT_EQ(table.at(first, second, narrow_phase), PairTable::Cell::FREE);
  }
}

/// Just inside the corners of blocks of all sizes, where joints have moved most from the middle.
TEST(PairTable, IsRightAtTheCornersOfItsBlocks) {
  constexpr int BLOCKS = 64;
  RandomInputs random;
  const std::string shapes[] = {"<box size='0.3 0.1 0.2'/>", "<sphere radius='0.12'/>",
                                "<mesh filename='l'/>", "<cylinder radius='0.1' length='0.3'/>"};
  int nb[3] = {0, 0, 0};
  for (const std::string types : {"rr", "rs", "sr", "cc", "cc", "cc", "cc", "cc", "cc", "cc"}) {
    const std::string& second = shapes[random.integer(0, 3)];
    const std::string& first = shapes[random.integer(0, 3)];  // in this order with every compiler
    const auto arm = armWith(first, second, types, random.uniform(0.0, 0.2));
    const auto scene = everyPair(arm, random.integer(0, 1) * 0.02);
    const RobotModel& robot = scene->robot();
    const BatchModel model(*scene, true);
    PairTable table(*scene, model, {0, 1});
    NarrowPhase narrow_phase, exact;
    for (int i = 0; i < 4 * BLOCKS * BLOCKS; ++i) {
      std::vector<double> q(2);
      const int at[2] = {i / 4 % BLOCKS, i / 4 / BLOCKS};
      for (int k = 0; k < 2; ++k) {
        const Joint& joint = robot.joints()[static_cast<std::size_t>(table.joint(k))];
        const double lower = joint.hasLimits() ? joint.lower : -M_PI;
        const double width = (joint.hasLimits() ? joint.upper - joint.lower : 2.0 * M_PI) / BLOCKS;
        const double within = (i >> k & 1) != 0 ? 1.0 - 1e-9 : 1e-9;
        q[static_cast<std::size_t>(table.joint(k))] = lower + (at[k] + within) * width;
      }
      auto cell = PairTable::Cell::OPEN;
      for (int read = 0; read < 12; ++read) {  // it learns
        cell = table.at(q[static_cast<std::size_t>(table.joint(0))],
                        q[static_cast<std::size_t>(table.joint(1))], narrow_phase);
      }
      ++nb[static_cast<int>(cell)];
      if (cell == PairTable::Cell::OPEN) continue;
      std::vector<Isometry3d> X_RB;
      robot.forwardKinematics(q, X_RB);
      const auto poseOf = [&](std::uint32_t e) -> Isometry3d {
        return X_RB[scene->bodies()[scene->elements()[e].body].body] * scene->elements()[e].X_BE;
      };
      const bool touches = exact.touches(*scene->elements()[0].rung(Fidelity::MESH).shape,
                                         *scene->elements()[1].rung(Fidelity::MESH).shape,
                                         poseOf(0).inverse() * poseOf(1), scene->padding(0, 1));
      ASSERT_EQ(cell == PairTable::Cell::CONTACT, touches) << types << ' ' << q[0] << ' ' << q[1];
    }
  }
  EXPECT_GT(nb[static_cast<int>(PairTable::Cell::FREE)], 5000);
  EXPECT_GT(nb[static_cast<int>(PairTable::Cell::CONTACT)], 1000);
}

// Inner spheres show only contacts that are deep within both; corners in the other mesh show more.
TEST(PairTable, DecidesMostContactsOfMeshesAndAllRightly) {
  RandomInputs random;
  int nb_contacts = 0, nb_open_contacts = 0;
  for (int arm = 0; arm < 24; ++arm) {
    const double apart = 0.04 + 0.008 * arm;
    const std::string others[] = {"l", "ball", "fork"};
    const std::string& other = others[arm % 3];
    const auto robot =
        armWith("<mesh filename='l'/>", "<mesh filename='" + other + "'/>", "rr", apart);
    const auto scene = everyPair(robot, 0.0);
    const BatchModel model(*scene, true);
    PairTable table(*scene, model, {0, 1});
    NarrowPhase narrow_phase, exact;
    for (int i = 0; i < 220000; ++i) {
      const std::vector<double> q = {random.uniform(-1.2, 1.6), random.uniform(-1.2, 1.6)};
      const auto cell = table.at(q[static_cast<std::size_t>(table.joint(0))],
                                 q[static_cast<std::size_t>(table.joint(1))], narrow_phase);
      if (i < 200000) continue;  // it learns
      std::vector<Isometry3d> X_RB;
      robot->forwardKinematics(q, X_RB);
      const auto poseOf = [&](std::uint32_t e) -> Isometry3d {
        return X_RB[scene->bodies()[scene->elements()[e].body].body] * scene->elements()[e].X_BE;
      };
      const bool touches = exact.touches(*scene->elements()[0].rung(Fidelity::MESH).shape,
                                         *scene->elements()[1].rung(Fidelity::MESH).shape,
                                         poseOf(0).inverse() * poseOf(1));
      nb_contacts += touches && other != "fork";  // the rods are thinner than the motion in a cell
      nb_open_contacts += touches && other != "fork" && cell == PairTable::Cell::OPEN;
      if (cell == PairTable::Cell::OPEN) continue;
      ASSERT_EQ(cell == PairTable::Cell::CONTACT, touches) << apart << ": " << q[0] << ' ' << q[1];
    }
  }
  EXPECT_GT(nb_contacts, 1000);
  EXPECT_LT(nb_open_contacts, nb_contacts / 2) << nb_contacts;
}

TEST(PairTable, IsForPairsThatOneOrTwoJointsDecide) {
  std::string xml = linkWith("a", "<sphere radius='0.1'/>");
  for (char c = 'b'; c < 'f'; ++c) {
    xml += linkWith(std::string(1, c), "<sphere radius='0.1'/>") +
           joint(std::string("to_") + c, "revolute", std::string(1, static_cast<char>(c - 1)),
                 std::string(1, c));
  }
  const auto robot = robotFrom(xml);
  std::vector<int> joints;
  EXPECT_TRUE(PairTable::joints(*robot, 0, 1, joints));
  EXPECT_EQ(joints.size(), 1u);
  EXPECT_TRUE(PairTable::joints(*robot, 3, 1, joints));
  EXPECT_EQ(joints, (std::vector<int>{2, 1})) << "from the first body to the second";
  EXPECT_FALSE(PairTable::joints(*robot, 0, 3, joints));
  EXPECT_FALSE(PairTable::joints(*robot, 2, 2, joints)) << "nothing moves them";
}

/// A floor and 25 things, each `copies` times.
std::shared_ptr<const CollisionScene> cluttered(RandomInputs& random, int copies = 1) {
  SceneDescription description;
  description.robots.push_back(
      {armWith("<sphere radius='0.1'/>", "<sphere radius='0.1'/>", "rr"), std::nullopt, ""});
  const Shape shapes[] = {Box{{0.3, 0.2, 0.1}}, meshShape(LShape().mesh()), Capsule{0.05, 0.3},
                          Cylinder{0.1, 0.2}, meshShape(bumpyBall(12, 0.15))};
  for (int i = 0; i < 25; ++i) {
    RigidObject object;
    object.elements.push_back({shapes[i % 5], random.pose(0.1)});
    object.X_PO = random.pose(0.9);
    for (int copy = 0; copy < copies; ++copy) {
      object.name = "thing_" + std::to_string(i) + "_" + std::to_string(copy);
      description.objects.push_back(object);
    }
  }
  if (copies == 1) description.objects.push_back(floorAt(-0.7, {}));
  return CollisionScene::build(description);
}

std::vector<std::uint32_t> staticElements(const CollisionScene& scene) {
  std::vector<std::uint32_t> all(scene.nbStaticElements());
  for (std::uint32_t i = 0; i < all.size(); ++i) all[i] = i;
  return all;
}

TEST(StaticField, BoundsAreThoseOfTheExactDistance) {
  RandomInputs random;
  const auto scene = cluttered(random);
  const BatchModel model(*scene, true);
  const std::vector<std::uint32_t> all = staticElements(*scene);
  const StaticField field(*scene, model, all, {Vector3d::Constant(-1), Vector3d::Constant(1)});
  const auto point = prepareShape(Sphere{0.0});
  NarrowPhase exact;
  int nb_further = 0, nb_nearer = 0;
  for (int i = 0; i < 20000; ++i) {
    Isometry3d X_WP = Isometry3d::Identity();
    X_WP.translation() = random.vector(-1.1, 1.1);
    const auto distanceFrom = [&](std::uint32_t e) {
      const SceneElement& element = scene->elements()[e];
      return exact
          .distance(*element.rung(Fidelity::MESH).shape, *point, element.X_BE.inverse() * X_WP,
                    HUGE_VAL)
          .distance;
    };
    double distance = HUGE_VAL;
    for (const std::uint32_t e : all) distance = std::min(distance, distanceFrom(e));
    const double reach = random.uniform(0.0, 0.3);
    if (field.isFurther(X_WP.translation(), reach)) {
      ++nb_further;
      ASSERT_GT(distance, reach - 1e-6);
    }
    std::uint32_t element = 0;
    if (field.isNearer(X_WP.translation(), reach, element)) {
      ++nb_nearer;
      ASSERT_LT(distanceFrom(element), reach + 1e-6);
    }
    if (X_WP.translation().cwiseAbs().maxCoeff() <= 1.0) continue;
    EXPECT_FALSE(field.isFurther(X_WP.translation(), reach)) << "nothing is known out there";
  }
  EXPECT_GT(nb_further, 1000);
  EXPECT_GT(nb_nearer, 1000);
}

/// The lanes in which points of W, x of all lanes first, are further than `reach` by the kernel.
unsigned further(const BatchKernel& kernel, const BatchGrid& grid, float* points, float reach) {
  const BatchSphere sphere{};
  unsigned placed = 1;
  BatchTables tables{};
  tables.spheres = &sphere;
  BatchLanes group{};
  group.centers = points;
  group.placed = &placed;
  group.group = 1;
  return kernel.further(tables, group, 0, grid, reach);
}

TEST(StaticField, KernelsFindFurtherWhatItsCellsTellButForTheirRounding) {
  RandomInputs random;
  const auto scene = cluttered(random, 5);  // so many that the cells alone are asked
  const BatchModel model(*scene, true);
  for (const BatchKernel& kernel : batchKernels()) {
    // Far from W and not round, so that places in the region are rounded.
    const Vector3d from(-1.1, -7.03, 0.017), to(1.3, 0.61, 1.9);
    const StaticField field(*scene, model, staticElements(*scene), {from, to});
    int nb_told = 0, nb_settled = 0;
    for (int i = 0; i < 2000; ++i) {
      alignas(64) float points[3 * MOST_BATCH_LANES];
      std::vector<double> most(kernel.lanes, 0.0);
      std::vector<char> is_between(kernel.lanes, 0);  // two cells, of which either will do
      for (int lane = 0; lane < kernel.lanes; ++lane) {
        Vector3d p_W;
        for (int axis = 0; axis < 3; ++axis) {
          float& place = points[axis * kernel.lanes + lane];
          place = static_cast<float>(random.uniform(from[axis] - 0.1, to[axis] + 0.1));
          p_W[axis] = place;
          const double cell = (place - from[axis]) / (to[axis] - from[axis]) * StaticField::SIDE;
          is_between[lane] |= std::abs(cell - std::round(cell)) < 1e-4;
        }
        field.isFurther(p_W, 0.0);  // fills in its cell
        // The largest reach, by bisection.
        double too_far = 8.0;
        for (int step = 0; step < 40; ++step) {
          const double reach = 0.5 * (most[lane] + too_far);
          (field.isFurther(p_W, reach) ? most[lane] : too_far) = reach;
        }
      }
      const auto isFound = [&](int lane, double reach) {
        const auto rounded = static_cast<float>(reach);
        return (further(kernel, field.grid(), points, rounded) >> lane & 1u) != 0;
      };
      for (int lane = 0; lane < kernel.lanes; ++lane) {
        if (most[lane] < 1e-3 || is_between[lane]) continue;
        ASSERT_FALSE(isFound(lane, most[lane] + 2e-7)) << kernel.name << ": " << most[lane];
        ++nb_told;
        nb_settled += isFound(lane, most[lane] - 1e-4);
      }
    }
    EXPECT_GT(nb_told, 1000 * kernel.lanes);
    EXPECT_EQ(nb_settled, nb_told);
  }
}

TEST(StaticField, KernelsFindNothingFurtherOutsideTheRegionOrInCellsThatAreNotFilledIn) {
  RandomInputs random;
  const auto scene = cluttered(random);
  const BatchModel model(*scene, true);
  const StaticField field(*scene, model, {0}, {Vector3d::Constant(-1), Vector3d::Constant(1)});
  for (const BatchKernel& kernel : batchKernels()) {
    for (int axis = 0; axis < 3; ++axis) {
      alignas(64) float points[3 * MOST_BATCH_LANES] = {};
      Vector3d border = Vector3d::Zero();
      for (const double place : {-0.99, 0.99}) {
        border[axis] = place;
        field.isFurther(border, 0.0);  // fills in its cell
      }
      for (const float place : {-1.01f, 1.01f, -1e6f, 1e6f}) {
        for (int lane = 0; lane < kernel.lanes; ++lane) points[axis * kernel.lanes + lane] = place;
        EXPECT_EQ(further(kernel, field.grid(), points, 0.0f), 0u) << kernel.name;
      }
    }
    alignas(64) float points[3 * MOST_BATCH_LANES];
    for (float& place : points) place = static_cast<float>(random.uniform(0.1, 0.9));
    EXPECT_EQ(further(kernel, field.grid(), points, 0.0f), 0u) << kernel.name;
  }
}

}  // namespace collision_pairs::test_batch_tables
