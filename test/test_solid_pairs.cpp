// What is kept of each element to settle pairs that the batch stage leaves open.
#include <cmath>

#include <gtest/gtest.h>

#include "every_shape.h"
#include "mixed_robot.h"
#include "solid_pairs.h"

namespace collision_pairs::test_solid_pairs {

using Eigen::Isometry3d;
using Eigen::Vector3d;

const Prepared& preparedOf(const std::shared_ptr<const PreparedShape>& shape) {
  return static_cast<const Prepared&>(*shape);
}

TEST(SolidField, SaysNothingThatTheExactDistanceOfAPointDenies) {
  RandomInputs random;
  const auto point = prepareShape(Sphere{0.0});
  NarrowPhase exact;
  for (const std::string kind : {"convex", "hull", "l", "ball"}) {
    SCOPED_TRACE(kind);
    const auto shape = prepareShape(shapeOfKind(random, kind, 0.3));
    const auto field = SolidField::make(preparedOf(shape));
    ASSERT_TRUE(field);
    int nb_further = 0, nb_apart = 0, nb_held = 0, nb_inside = 0;
    for (int i = 0; i < 20000; ++i) {
      Isometry3d X_FP = random.pose(0.4), X = Isometry3d::Identity();
      const Vector3d p_P = random.vector(-0.1, 0.1);
      X.translation() = X_FP * p_P;
      const double distance = exact.distance(*shape, *point, X, HUGE_VAL).distance;
      const bool is_inside = exact.touches(*shape, *point, X);
      float node = 0.0f;
      ASSERT_TRUE(field->nearestNodes(SolidField::Points({p_P}), X_FP, &node));
      ASSERT_LE(node - field->off(), is_inside ? 0.0 : distance);
      ASSERT_TRUE(is_inside || node >= -field->off());
      const double reach = random.uniform(0.0, 0.1);
      if (field->isFurther(X.translation(), reach)) {
        ++nb_further;
        ASSERT_GT(distance, reach);
      }
      nb_apart += distance > reach + 0.02;
      if (field->isInside(X.translation())) {
        ++nb_held;
        ASSERT_TRUE(is_inside);
      }
      nb_inside += is_inside;
    }
    EXPECT_GT(nb_further, 0.8 * nb_apart) << nb_apart;
    EXPECT_GT(nb_held, 0.4 * nb_inside) << nb_inside;
    EXPECT_GT(nb_inside, 100);
  }
}

/// The same, moved: a shape need not be about the origin of its frame.
Shape moved(const Shape& shape, const Vector3d& by) {
  const auto* convex = std::get_if<Convex>(&shape);
  auto mesh = std::make_shared<TriangleMesh>(convex ? *convex->mesh : *std::get<Mesh>(shape).mesh);
  for (Vector3d& v : mesh->vertices) v += by;
  return convex ? Shape(Convex{mesh}) : Shape(meshShape(*mesh));
}

// Of a hull the distance from outside is bounded by its planes only, and of a mesh a depth is not
// the distance from the nearest triangle.
TEST(SolidField, TellsOfEachPointWhatItIsOffByAtMost) {
  RandomInputs random;
  const auto point = prepareShape(Sphere{0.0});
  NarrowPhase exact;
  for (const std::string kind : {"convex", "hull", "l", "ball"}) {
    SCOPED_TRACE(kind);
    const bool is_mesh = kind == "l" || kind == "ball";
    const auto shape = prepareShape(moved(shapeOfKind(random, kind, 0.3), {0.7, -0.5, 1.1}));
    const auto field = SolidField::make(preparedOf(shape));
    Aabb box = noBox();
    for (const Vector3d& p : preparedOf(shape).hull.points.vertices) box = enclosing(box, {p, p});
    const double width = field->off() / 0.9;
    const Vector3d size = box.max - box.min + Vector3d::Constant(2.0 * width);
    int nb_told = 0;
    for (int round = 0; round < 60; ++round) {
      const Isometry3d X_FP = random.pose(0.4);
      std::vector<Vector3d> p_F, p_P;
      for (std::size_t i = 0; i < SolidField::Points::MOST; ++i) {
        p_F.push_back(box.min - Vector3d::Constant(width) +
                      size.cwiseProduct(random.vector(0.0, 1.0)));
        p_P.push_back(X_FP.inverse() * p_F.back());
      }
      std::vector<float> nodes(p_P.size(), 1e6f);
      ASSERT_TRUE(field->nearestNodes(SolidField::Points(p_P), X_FP, nodes.data()));
      for (std::size_t i = 0; i < p_F.size(); ++i) {
        Isometry3d X = Isometry3d::Identity();
        X.translation() = p_F[i];
        const double distance = exact.distance(*shape, *point, X, HUGE_VAL).distance;
        const double off = field->off() + 2e-6 * std::abs(distance);
        ASSERT_LE(nodes[i], std::max(distance, 0.0) + off) << i;
        if (is_mesh == (distance <= field->off())) continue;
        ASSERT_NEAR(nodes[i], distance, off) << i;
        ++nb_told;
      }
    }
    EXPECT_GT(nb_told, 1000);
    EXPECT_LT(field->off(), 0.05 * size.norm());  // of 10,000 nodes
  }
}

TEST(SolidField, SaysNothingFromSoFarThatFloatWouldMislead) {
  RandomInputs random;
  const auto shape = prepareShape(shapeOfKind(random, "l", 0.3));
  const auto field = SolidField::make(preparedOf(shape));
  Isometry3d X = Isometry3d::Identity();
  X.translation() = Vector3d(1e4, 0.0, 0.0);
  float node = 0.0f;
  EXPECT_FALSE(field->nearestNodes(SolidField::Points({-X.translation()}), X, &node));
}

TEST(SolidPairs, SettleMostPairsOfLargeMeshesAndAllRightly) {
  RandomInputs random;
  const auto robot = RobotModel::fromUrdf(
      "<robot name='things'>" + linkWith("a", "<mesh filename='fine ball'/>") +
          linkWith("b", "<mesh filename='l'/>") + linkWith("c", "<box size='0.3 0.2 0.1'/>") +
          linkWith("d", "<mesh filename='small ball'/>") +
          linkWith("e", "<cylinder radius='0.1' length='0.3'/>") +
          joint("ab", "floating", "a", "b") + joint("bc", "floating", "b", "c") +
          joint("cd", "floating", "c", "d") + joint("de", "floating", "d", "e") + "</robot>",
      [](const std::string& uri, const Vector3d& scale) {
        if (uri == "l") return testMesh(uri, scale);
        return std::make_shared<const TriangleMesh>(uri == "fine ball" ? bumpyBall(24, 0.2)
                                                                       : bumpyBall(30, 0.1));
      });
  for (const double padding : {0.0, 0.02}) {
    SceneSettings settings;
    settings.padding = padding;
    const auto scene = CollisionScene::build(robot, Srdf(), nullptr, settings);
    ASSERT_EQ(scene->elements().size(), 5u);
    const BatchModel model(*scene, true);
    const SolidPairs solids(*scene, model);
    NarrowPhase exact;
    int nb[3] = {0, 0, 0};
    for (int i = 0; i < 9 * SolidPairs::ASKED; ++i) {
      const auto drawn = [&] { return static_cast<std::uint32_t>(random.integer(0, 4)); };
      const auto [first, second] = std::minmax({drawn(), drawn()});
      if (first == second) continue;
      const BoxPair pair{first, second};
      const Isometry3d X_AB = random.pose(0.3);
      const auto outcome = solids.settle(pair, X_AB);
      if (i < 6 * SolidPairs::ASKED) continue;  // until the fields are made
      ++nb[static_cast<int>(outcome)];
      if (outcome == SolidPairs::Outcome::OPEN) continue;
      const auto& elements = scene->elements();
      const bool touches = exact.touches(*elements[pair.first].rung(Fidelity::MESH).shape,
                                         *elements[pair.second].rung(Fidelity::MESH).shape, X_AB,
                                         scene->padding(pair.first, pair.second));
      ASSERT_EQ(outcome == SolidPairs::Outcome::CONTACT, touches) << pair.first << pair.second;
    }
    EXPECT_GT(solids.memory(), 0u);
    EXPECT_GT(nb[static_cast<int>(SolidPairs::Outcome::FREE)], 500);
    EXPECT_GT(nb[static_cast<int>(SolidPairs::Outcome::CONTACT)], 500);
  }
}

// A byte for each two elements: of a scene of many nothing is kept.
TEST(SolidPairs, TakeLittleMemoryHoweverManyObjectsThereAre) {
  std::string many = "<robot name='world'><link name='things'>";
  for (int i = 0; i < 20000; ++i) {
    many += "<collision><geometry><box size='1 1 1'/></geometry></collision>";
  }
  const auto world = RobotModel::fromUrdf(many + "</link></robot>", noMeshes);
  const auto robot = RobotModel::fromUrdf("<robot name='r'>" + emptyLink("base") +
                                              linkWith("a", "<box size='0.3 0.2 0.1'/>") +
                                              joint("x", "floating", "base", "a") + "</robot>",
                                          noMeshes);
  const auto scene = CollisionScene::build(robot, Srdf(), world);
  ASSERT_EQ(scene->elements().size(), 20001u);
  const BatchModel model(*scene, true);
  EXPECT_LT(SolidPairs(*scene, model).memory(), 20e6);
}

}  // namespace collision_pairs::test_solid_pairs
