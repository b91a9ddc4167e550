// Points of the robot are told from obstacles.
#include <cmath>

#include <gtest/gtest.h>

#include "benchmark/benchmark_robots.h"
#include "benchmark/demo_motion.h"
#include "collision_pairs/input_error.h"
#include "collision_pairs/self_filter.h"
#include "demo_scene.h"
#include "random_inputs.h"

namespace collision_pairs::test_self_filter {

using Eigen::Isometry3d;
using Eigen::Vector3d;

constexpr double NOISE = 0.005, PADDING = 0.02;  // metres

Vector3d unitVector(RandomInputs& random) { return random.rotation() * Vector3d::UnitX(); }

Vector3d closestOnTriangle(const Vector3d& a, const Vector3d& b, const Vector3d& c,
                           const Vector3d& p) {
  const Vector3d n = (b - a).cross(c - a);
  const Vector3d corners[] = {a, b, c};
  Vector3d best = a;
  const Vector3d in_plane = p - n * (n.dot(p - a) / std::max(n.squaredNorm(), 1e-300));
  bool is_inside = n.squaredNorm() > 0.0;
  for (int i = 0; i < 3; ++i) {
    const Vector3d &u = corners[i], &v = corners[(i + 1) % 3];
    is_inside = is_inside && n.dot((v - u).cross(in_plane - u)) >= 0.0;
    const double length = (v - u).squaredNorm();
    const double t = length > 0.0 ? std::clamp((p - u).dot(v - u) / length, 0.0, 1.0) : 0.0;
    const Vector3d on_edge = u + t * (v - u);
    if ((on_edge - p).norm() < (best - p).norm()) best = on_edge;
  }
  return is_inside ? in_plane : best;
}

/// The oracles: a point on the surface, and the distance of a point, 0 inside; in the frame of the
/// element. Of a mesh inside is not told from outside: the distance is that of the surface.
Vector3d onSurface(const Shape& shape, RandomInputs& random) {
  if (const auto* box = std::get_if<Box>(&shape)) {
    Vector3d p = random.vector(-0.5, 0.5).cwiseProduct(box->size);
    const int axis = random.integer(0, 2);
    p[axis] = (random.integer(0, 1) - 0.5) * box->size[axis];
    return p;
  }
  if (const auto* sphere = std::get_if<Sphere>(&shape)) return sphere->radius * unitVector(random);
  if (const auto* cylinder = std::get_if<Cylinder>(&shape)) {
    const double angle = random.uniform(-M_PI, M_PI);
    return {cylinder->radius * std::cos(angle), cylinder->radius * std::sin(angle),
            random.uniform(-0.5, 0.5) * cylinder->length};
  }
  const auto& mesh = *std::get<Mesh>(shape).mesh;
  const auto& t = mesh.triangles[static_cast<std::size_t>(
      random.integer(0, static_cast<int>(mesh.triangles.size()) - 1))];
  const double u = random.uniform(0.0, 1.0), v = random.uniform(0.0, 1.0 - u);
  return (1.0 - u - v) * mesh.vertices[t[0]] + u * mesh.vertices[t[1]] + v * mesh.vertices[t[2]];
}

double distanceTo(const Shape& shape, const Vector3d& p) {
  if (const auto* box = std::get_if<Box>(&shape)) {
    return (p.cwiseAbs() - 0.5 * box->size).cwiseMax(0.0).norm();
  }
  if (const auto* sphere = std::get_if<Sphere>(&shape)) {
    return std::max(p.norm() - sphere->radius, 0.0);
  }
  if (const auto* cylinder = std::get_if<Cylinder>(&shape)) {
    const double beside = std::max(std::hypot(p[0], p[1]) - cylinder->radius, 0.0);
    return std::hypot(beside, std::max(std::abs(p[2]) - 0.5 * cylinder->length, 0.0));
  }
  const auto& mesh = *std::get<Mesh>(shape).mesh;
  double best = 1e300;
  for (const auto& t : mesh.triangles) {
    const Vector3d &a = mesh.vertices[t[0]], &b = mesh.vertices[t[1]], &c = mesh.vertices[t[2]];
    best = std::min(best, (closestOnTriangle(a, b, c, p) - p).norm());
  }
  return best;
}

/// Solid angles, in full turns: 1 inside of a closed surface, 0 outside.
double turnsAbout(const TriangleMesh& mesh, const Vector3d& p) {
  double sum = 0.0;
  for (const auto& t : mesh.triangles) {
    const Vector3d a = mesh.vertices[t[0]] - p, b = mesh.vertices[t[1]] - p,
                   c = mesh.vertices[t[2]] - p;
    const double x = a.norm(), y = b.norm(), z = c.norm();
    sum += std::atan2(a.dot(b.cross(c)), x * y * z + a.dot(b) * z + a.dot(c) * y + b.dot(c) * x);
  }
  return sum / (2.0 * M_PI);
}

struct PlacedShape {
  Shape shape;
  Isometry3d X_WE;
};

class RobotPoints {
 public:
  explicit RobotPoints(std::shared_ptr<const RobotModel> robot) : robot_(std::move(robot)) {
    description_.robots.push_back({robot_, std::nullopt, ""});
    filter_ = std::make_unique<SelfFilter>(description_, PADDING);
  }

  void takePosture(RandomInputs& random) {
    std::vector<double> q;
    for (const Joint& joint : robot_->joints()) {
      const bool is_bounded = joint.hasLimits() && joint.upper - joint.lower < 7.0;
      q.push_back(is_bounded ? random.uniform(joint.lower, joint.upper)
                             : random.uniform(-M_PI, M_PI));
    }
    std::vector<Isometry3d> X_RB;
    robot_->forwardKinematics(q, X_RB);
    BodyPoses poses;
    poses.resize(filter_->bodies().size());
    for (std::size_t i = 0; i < poses.X_WB.size(); ++i) {
      poses.X_WB[i] = X_RB[static_cast<std::size_t>(filter_->bodies()[i].body)];
    }
    filter_->begin(poses);
    EXPECT_TRUE(filter_->leftOut().empty());
    shapes_.clear();
    for (const Link& link : robot_->links()) {
      for (const Element& element : link.elements) {
        const Isometry3d X_WL = X_RB[static_cast<std::size_t>(link.body)] * link.X_BL;
        shapes_.push_back({element.shape, X_WL * element.X_LE});
      }
    }
  }

  int nbOwnLeft(RandomInputs& random, int points_a_shape) {
    int nb_left = 0;
    std::normal_distribution<double> normal(0.0, NOISE);
    for (const PlacedShape& placed : shapes_) {
      for (int i = 0; i < points_a_shape; ++i) {
        // Three standard deviations: what is further away than the padding is no own point.
        const double noise = std::clamp(normal(random.engine()), -3 * NOISE, 3 * NOISE);
        const Vector3d p_E = onSurface(placed.shape, random) + noise * unitVector(random);
        nb_left += filter_->isOwn(placed.X_WE * p_E) ? 0 : 1;
      }
    }
    return nb_left;
  }

  /// Is every point about the robot filtered as the oracle says?
  void expectExact(RandomInputs& random, int nb_points) {
    for (int i = 0; i < nb_points; ++i) {
      const auto& about = shapes_[static_cast<std::size_t>(
          random.integer(0, static_cast<int>(shapes_.size()) - 1))];
      const Vector3d p_W =
          about.X_WE * Vector3d(onSurface(about.shape, random) +
                                random.uniform(0.0, 2.5 * PADDING) * unitVector(random));
      double nearest = 1e300, turns = 0.0;
      for (const PlacedShape& placed : shapes_) {
        const Vector3d p_E = placed.X_WE.inverse() * p_W;
        nearest = std::min(nearest, distanceTo(placed.shape, p_E));
        if (const auto* mesh = std::get_if<Mesh>(&placed.shape)) {
          turns = std::max(turns, std::abs(turnsAbout(*mesh->mesh, p_E)));
        }
      }
      if (nearest <= PADDING - 1e-6) {
        EXPECT_TRUE(filter_->isOwn(p_W)) << nearest;
      } else if (nearest > PADDING + 1e-6 && turns < 0.01) {
        ++nb_kept;
        EXPECT_FALSE(filter_->isOwn(p_W)) << nearest;
      } else if (turns > 0.99) {
        EXPECT_TRUE(filter_->isOwn(p_W)) << "inside";
      }
    }
  }

  int nb_kept = 0;

 private:
  std::shared_ptr<const RobotModel> robot_;
  SceneDescription description_;
  std::unique_ptr<SelfFilter> filter_;
  std::vector<PlacedShape> shapes_;
};

void expectTheRobotDoesNotSeeItself(const std::shared_ptr<const RobotModel>& robot) {
  RandomInputs random;
  RobotPoints points(robot);
  int nb_left = 0;
  for (int posture = 0; posture < 500; ++posture) {
    points.takePosture(random);
    nb_left += points.nbOwnLeft(random, 20);
    if (posture % 10 == 0) points.expectExact(random, 20);
  }
  EXPECT_EQ(nb_left, 0);
  EXPECT_GT(points.nb_kept, 100);
}

TEST(SelfFilter, TheDemoRobotDoesNotSeeItselfAndLosesNoObstacle) {
  expectTheRobotDoesNotSeeItself(demoRobot().robot);
}

TEST(SelfFilter, ARealRobotDoesNotSeeItselfAndLosesNoObstacle) {
  if (benchmarkRobots().empty()) GTEST_SKIP() << "skipped: no robots";
  expectTheRobotDoesNotSeeItself(benchmarkRobots()[0].robot);
}

TEST(SelfFilter, AsksForNoPoseOfALinkWithoutGeometry) {
  SceneDescription description;
  description.robots.push_back(
      {robotFrom(boxLink("base", 0.1) + emptyLink("eye") + boxLink("hand", 0.1) +
                 joint("look", "continuous", "base", "eye") +
                 joint("grip", "continuous", "eye", "hand")),
       std::nullopt, ""});
  const SelfFilter filter(description, 0.01);
  std::vector<std::string> links;
  for (const SceneBody& body : filter.bodies()) links.push_back(body.link);
  EXPECT_EQ(links, (std::vector<std::string>{"base", "hand"}));
}

class SmallRobot : public testing::Test {
 protected:
  SmallRobot() {
    description_.robots.push_back(
        {robotFrom(boxLink("base", 1.0) + boxLink("hand", 0.2) +
                   joint("slide", "prismatic", "base", "hand", "0 0 2",
                         "<axis xyz='1 0 0'/><limit lower='-100' upper='100'/>")),
         std::nullopt, ""});
  }

  BodyPoses posesOf(const SelfFilter& filter) const {
    std::vector<Isometry3d> X_RB;
    const RobotModel& robot = *description_.robots[0].model;
    robot.forwardKinematics(robot.zeroPositions(), X_RB);
    BodyPoses poses;
    poses.resize(filter.bodies().size());
    for (std::size_t i = 0; i < poses.X_WB.size(); ++i) {
      poses.X_WB[i] = X_RB[static_cast<std::size_t>(filter.bodies()[i].body)];
    }
    return poses;
  }

  SceneDescription description_;
};

TEST_F(SmallRobot, TheBorderIsThePadding) {
  for (const double padding : {0.0, 0.001, 0.05, 0.5}) {
    SelfFilter filter(description_, padding);
    filter.begin(posesOf(filter));
    for (const double inside : {1e-7, 1e-4, 0.1}) {
      EXPECT_TRUE(filter.isOwn({0.5 + padding - inside, 0.1, 0.2})) << padding;
    }
    for (const double beyond : {1e-6, 1e-4, 0.1, 10.0, 1e6}) {
      EXPECT_FALSE(filter.isOwn({0.5 + padding + beyond, 0.1, 0.2})) << padding;
    }
    EXPECT_TRUE(filter.isOwn({0.0, 0.0, 0.0})) << "in the middle of the solid";
  }
}

TEST_F(SmallRobot, LinksOnNoAllowedPairIgnoredLinksAndAttachedObjectsFilterWorldsDoNot) {
  description_.settings.pair_rules = {{PairRule::Verdict::DENY, "*", "*"}};
  description_.settings.ignored_links = {"hand"};
  RigidObject tool;
  tool.name = "tool";
  tool.attached_link = "hand";
  tool.X_PO.translation().z() = 1.0;
  tool.elements.push_back({Sphere{0.1}, Isometry3d::Identity()});
  RigidObject crate = tool;
  crate.name = "crate";
  crate.attached_link.clear();
  crate.X_PO.translation().z() = -3.0;
  description_.objects = {tool, crate};
  SelfFilter filter(description_, 0.01);
  filter.begin(posesOf(filter));
  EXPECT_TRUE(filter.isOwn({0, 0, 0}));
  EXPECT_TRUE(filter.isOwn({0, 0, 2}));
  EXPECT_TRUE(filter.isOwn({0, 0, 3.105}));
  EXPECT_FALSE(filter.isOwn({0, 0, 3.115}));
  EXPECT_FALSE(filter.isOwn({0, 0, -3}));
}

TEST_F(SmallRobot, ALinkWithoutAPoseFiltersNothingAndIsNamed) {
  SelfFilter filter(description_, 0.01);
  BodyPoses poses = posesOf(filter);
  poses.known[1] = 0;
  filter.begin(poses);
  const std::string& link = filter.bodies()[1].link;
  EXPECT_EQ(filter.leftOut(), std::vector<std::string>{link});
  EXPECT_EQ(filter.isOwn({0, 0, 0}), link != "base");
  EXPECT_EQ(filter.isOwn({0, 0, 2}), link != "hand");
  poses.known[1] = 1;
  poses.X_WB[1].translation().x() = NAN;
  filter.begin(poses);
  EXPECT_EQ(filter.leftOut().size(), 1u);
  for (const double scale : {-1.0, 0.0, 0.5, 0.998, 1.002, 3.0}) {
    poses = posesOf(filter);
    poses.X_WB[1].linear() *= scale;
    filter.begin(poses);
    EXPECT_EQ(filter.leftOut(), std::vector<std::string>{link}) << scale;
  }
  filter.begin(posesOf(filter));
  EXPECT_TRUE(filter.leftOut().empty());
  EXPECT_TRUE(filter.isOwn({0, 0, 0}));
  EXPECT_TRUE(filter.isOwn({0, 0, 2}));
}

TEST_F(SmallRobot, WhatItRemembersChangesNoAnswer) {
  RandomInputs random;
  SelfFilter used(description_, 0.05);
  for (int round = 0; round < 20; ++round) {
    SelfFilter fresh(description_, 0.05);
    BodyPoses poses = posesOf(used);
    for (Isometry3d& X_WB : poses.X_WB) X_WB = random.pose(1.0);
    poses.known[round % 2] = round % 3 > 0;
    used.begin(poses);
    fresh.begin(poses);
    for (int i = 0; i < 500; ++i) {
      const Vector3d p_W = random.vector(-2.0, 2.0);
      EXPECT_EQ(used.isOwn(p_W), fresh.isOwn(p_W)) << "round " << round;
    }
  }
}

TEST_F(SmallRobot, PaddingsAndPosesThatMeanNothingAreRefused) {
  EXPECT_THROW(SelfFilter(description_, -0.01), InputError);
  EXPECT_THROW(SelfFilter(description_, NAN), InputError);
  SelfFilter filter(description_, 0.01);
  EXPECT_THROW(filter.begin(BodyPoses()), InputError);
  filter.begin(posesOf(filter));
  EXPECT_FALSE(filter.isOwn({NAN, 0, 0}));
}

}  // namespace collision_pairs::test_self_filter
