// Velocities and bounds along a motion, beside what forward kinematics says of single points.
#include <cmath>

#include <gtest/gtest.h>

#include "mixed_robot.h"
#include "motion_state.h"
#include "random_inputs.h"

namespace collision_pairs::test_motion_state {

using Eigen::Isometry3d;
using Eigen::Vector3d;

constexpr double ROUNDING = 1e-9;

std::string text(const Vector3d& v) {
  return std::to_string(v[0]) + " " + std::to_string(v[1]) + " " + std::to_string(v[2]);
}

/// A tree of six links of random boxes and joints of every kind; some follow the first joint.
std::shared_ptr<const RobotModel> randomRobot(RandomInputs& random) {
  const std::string types[] = {"revolute",  "continuous", "prismatic", "revolute",
                               "prismatic", "fixed",      "floating",  "planar"};
  std::string xml = linkWith("l0", "<box size='0.1 0.1 0.1'/>");
  for (int i = 1; i <= 6; ++i) {
    const std::string name = "l" + std::to_string(i);
    xml += linkWith(name, "<box size='" + text(random.vector(0.01, 0.5)) + "'/>",
                    "<origin xyz='" + text(random.vector(-0.5, 0.5)) + "'/>");
    const std::string type = i == 1 ? "revolute" : types[random.integer(0, 7)];
    const bool follows = i > 1 && random.integer(0, 3) == 0 && type != "floating" &&
                         type != "planar" && type != "fixed";
    xml += "<joint name='j" + std::to_string(i) + "' type='" + type + "'><parent link='l" +
           std::to_string(std::max(0, i - random.integer(1, 2))) + "'/><child link='" + name +
           "'/><origin xyz='" + text(random.vector(-0.5, 0.5)) + "' rpy='" +
           text(random.vector(-3.0, 3.0)) + "'/><axis xyz='" +
           text(random.rotation() * Vector3d::UnitX()) + "'/><limit lower='-9' upper='9'/>" +
           (follows ? "<mimic joint='j1' multiplier='-1.7' offset='0.2'/>" : "") + "</joint>";
  }
  return robotFrom(xml);
}

std::shared_ptr<const CollisionScene> sceneOf(const std::shared_ptr<const RobotModel>& robot) {
  return CollisionScene::build(robot, Srdf{}, nullptr);  // all pairs
}

/// The largest part of a bound that a point was seen to need.
struct Used {
  double speed = 0.0, acceleration = 0.0, deviation = 0.0;
};

class BoundsCheck {
 public:
  explicit BoundsCheck(std::shared_ptr<const CollisionScene> scene)
      : scene_(std::move(scene)), pairs_(*scene_), state_(*scene_, pairs_) {}

  void begin(const JointMotion& motion, double at, double half_width) {
    motion_ = motion;
    at_ = at;
    half_width_ = half_width;
    state_.begin(motion, {});
    state_.moveTo(at, half_width);
    X_WB_ = bodiesAt(at);
  }

  /// All elements, seen from each body that carries them, and from W.
  Used check(RandomInputs& random) { return ofAll(random, &BoundsCheck::checkElement); }
  Used checkDeviations(RandomInputs& random) { return ofAll(random, &BoundsCheck::checkDeviation); }

 private:
  using CheckOne = void (BoundsCheck::*)(std::uint32_t, int, RandomInputs&, Used&);
  Used ofAll(RandomInputs& random, CheckOne look) {
    Used used;
    for (std::uint32_t e = scene_->nbStaticElements(); e < scene_->elements().size(); ++e) {
      int frame = pairs_.body_of[e];
      for (;; frame = scene_->robot().bodies()[frame].parent) {
        (this->*look)(e, frame, random, used);
        if (frame < 0) break;
      }
    }
    return used;
  }

  std::vector<Isometry3d> bodiesAt(double fraction, const std::vector<double>& off = {}) const {
    std::vector<double> q(motion_.from.size());
    for (std::size_t i = 0; i < q.size(); ++i) {
      q[i] = motion_.from[i] + fraction * (motion_.to[i] - motion_.from[i]);
      if (!off.empty()) q[i] += off[i];
    }
    scene_->robot().applyMimics(q);
    std::vector<Isometry3d> X_WB;
    scene_->robot().forwardKinematics(q, X_WB);
    return X_WB;
  }

  void checkElement(std::uint32_t e, int frame, RandomInputs& random, Used& used) {
    const SceneElement& element = scene_->elements()[e];
    const MotionBound bound = state_.bound(e, frame);
    const Twist twist = state_.twist(e, frame);
    const int body = pairs_.body_of[e];
    const Isometry3d X_WE = X_WB_[body] * element.X_BE;
    ASSERT_TRUE(state_.pose(e).isApprox(X_WE, 1e-9));
    ASSERT_TRUE(state_.sphere(e).center.isApprox(X_WE * element.box_center, 1e-9));
    const Isometry3d X_WF = frame < 0 ? Isometry3d::Identity() : X_WB_[frame];
    for (int k = 0; k < 12; ++k) {
      const double s = random.uniform(-half_width_, half_width_);
      const std::vector<Isometry3d> then = bodiesAt(at_ + s);
      const Isometry3d X_WF_then = frame < 0 ? Isometry3d::Identity() : then[frame];
      const Vector3d corner(k & 1 ? 1 : -1, k & 2 ? 1 : -1, k & 4 ? 1 : -1);
      const Vector3d p_E = element.box_center + corner.cwiseProduct(element.box_half);
      const Vector3d p_W = X_WE * p_E;
      // Where the frame stands still, expressed in W.
      const Vector3d p_W_then = X_WF * X_WF_then.inverse() * (then[body] * element.X_BE) * p_E;
      const Vector3d velocity = twist.v + twist.omega.cross(p_W - state_.sphere(e).center);
      const double moved = (p_W_then - p_W).norm();
      const double departed = (p_W_then - p_W - s * velocity).norm();
      const double may_move = std::abs(s) * bound.speed;
      const double may_depart = 0.5 * s * s * bound.acceleration;
      ASSERT_LE(moved, may_move + ROUNDING) << "element " << e << " from " << frame;
      ASSERT_LE(departed, may_depart + ROUNDING) << "element " << e << " from " << frame;
      if (may_move > 1e-6) used.speed = std::max(used.speed, moved / may_move);
      if (may_depart > 1e-6) used.acceleration = std::max(used.acceleration, departed / may_depart);
    }
  }

  /// From a place on the line to the furthest deviations, along a direction of the frame.
  void checkDeviation(std::uint32_t e, int frame, RandomInputs& random, Used& used) {
    const SceneElement& element = scene_->elements()[e];
    const int body = pairs_.body_of[e];
    const double in_all_directions = state_.bound(e, frame).deviation;
    const Eigen::Matrix3d R_WF =
        frame < 0 ? Eigen::Matrix3d::Identity() : Eigen::Matrix3d(X_WB_[frame].linear());
    for (int k = 0; k < 24; ++k) {
      const Vector3d n_W = random.rotation() * Vector3d::UnitX();
      const double may_deviate = state_.deviationAlong(e, frame, n_W, half_width_);
      ASSERT_LE(may_deviate, in_all_directions + ROUNDING);
      const double at = at_ + random.uniform(-half_width_, half_width_);
      std::vector<double> off = motion_.deviation;
      for (double& x : off) x *= random.integer(0, 1) ? 1.0 : -1.0;
      const Vector3d corner(k & 1 ? 1 : -1, k & 2 ? 1 : -1, k & 4 ? 1 : -1);
      const Vector3d p_E = element.box_center + corner.cwiseProduct(element.box_half);
      const auto pointIn = [&](const std::vector<Isometry3d>& X_WB) -> Vector3d {
        const Vector3d p_W = X_WB[body] * element.X_BE * p_E;
        return frame < 0 ? p_W : Vector3d(X_WB[frame].inverse() * p_W);
      };
      const Vector3d deviated_F = pointIn(bodiesAt(at, off)) - pointIn(bodiesAt(at));
      const double deviated = std::abs((R_WF.transpose() * n_W).dot(deviated_F));
      ASSERT_LE(deviated, may_deviate + ROUNDING) << "element " << e << " from " << frame;
      if (may_deviate > 1e-6) used.deviation = std::max(used.deviation, deviated / may_deviate);
    }
  }

  std::shared_ptr<const CollisionScene> scene_;
  MotionPairs pairs_;
  MotionState state_;
  JointMotion motion_;
  double at_ = 0.0, half_width_ = 0.0;
  std::vector<Isometry3d> X_WB_;
};

TEST(MotionState, NoPointOfAnyElementLeavesItsBounds) {
  RandomInputs random;
  for (int i = 0; i < 150; ++i) {
    const auto robot = randomRobot(random);
    BoundsCheck check(sceneOf(robot));
    for (int k = 0; k < 4; ++k) {
      JointMotion motion;
      for (std::size_t j = 0; j < robot->joints().size(); ++j) {
        motion.from.push_back(random.uniform(-3.0, 3.0));
        const bool moves = random.integer(0, 3) > 0;
        motion.to.push_back(motion.from.back() + (moves ? random.uniform(-6.0, 6.0) : 0.0));
      }
      check.begin(motion, random.uniform(0.0, 1.0), std::pow(10.0, random.uniform(-3.0, 0.0)));
      check.check(random);
      if (HasFatalFailure()) return;
    }
  }
}

TEST(MotionState, NoPointOfAnyElementDeviatesFurtherAlongADirectionThanItsBound) {
  RandomInputs random;
  double used = 0.0;
  for (int i = 0; i < 150; ++i) {
    const auto robot = randomRobot(random);
    BoundsCheck check(sceneOf(robot));
    for (int k = 0; k < 8; ++k) {
      const double most = std::pow(10.0, random.uniform(-3.0, 0.0));
      JointMotion motion;
      for (std::size_t j = 0; j < robot->joints().size(); ++j) {
        motion.from.push_back(random.uniform(-3.0, 3.0));
        const bool moves = random.integer(0, 2) > 0, deviates = random.integer(0, 2) > 0;
        motion.to.push_back(motion.from.back() + (moves ? random.uniform(-6.0, 6.0) : 0.0));
        motion.deviation.push_back(deviates ? random.uniform(0.0, most) : 0.0);
      }
      const double half_width =
          random.integer(0, 2) ? std::pow(10.0, random.uniform(-4.0, 0.0)) : 0;
      check.begin(motion, random.uniform(0.0, 1.0), half_width);
      used = std::max(used, check.checkDeviations(random).deviation);
      if (HasFatalFailure()) return;
    }
  }
  EXPECT_GT(used, 0.9) << "of the bound, at most";
}

// A bound that is no larger than it must be: a smaller one would be wrong.
TEST(MotionState, AStraightArmThatTurnsOneWayUsesItsBoundsUp) {
  std::string xml = emptyLink("root");
  for (int i = 1; i <= 3; ++i) {
    const std::string name = "l" + std::to_string(i);
    const std::string parent = i == 1 ? "root" : "l" + std::to_string(i - 1);
    xml +=
        linkWith(name, "<box size='1e-4 1e-4 1e-4'/>", "<origin xyz='1 0 0'/>") +
        joint("j" + std::to_string(i), "continuous", parent, name, "1 0 0", "<axis xyz='0 0 1'/>");
  }
  BoundsCheck check(sceneOf(robotFrom(xml)));
  RandomInputs random;
  check.begin({{0.0, 0.0, 0.0}, {1.0, 2.0, 3.0}}, 0.0, 1e-2);
  const Used used = check.check(random);
  EXPECT_GT(used.speed, 0.99);
  EXPECT_GT(used.acceleration, 0.99);
}

// The ends of a way: an arm that is folded in its middle reaches far at its ends.
TEST(MotionState, AFoldedArmKeepsToTheBoundsOfItsFoldedPose) {
  const auto robot =
      robotFrom(emptyLink("root") + emptyLink("upper") +
                linkWith("lower", "<box size='0.01 0.01 0.01'/>", "<origin xyz='1 0 0'/>") +
                joint("shoulder", "continuous", "root", "upper", "0 0 0", "<axis xyz='0 0 1'/>") +
                joint("elbow", "continuous", "upper", "lower", "1 0 0", "<axis xyz='0 0 1'/>"));
  BoundsCheck check(CollisionScene::build([&] {
    SceneDescription description;
    description.robots.push_back({robot, std::nullopt, ""});
    description.objects.push_back(floorAt(-1.0, {}));
    return description;
  }()));
  RandomInputs random;
  for (int i = 0; i < 200; ++i) {
    const double turn = random.uniform(-4.0, 4.0), unfold = random.uniform(-3.0, 3.0);
    JointMotion motion{{-turn, -turn}, {turn, turn}};
    motion.from[robot->findJoint("elbow")] = M_PI - unfold;
    motion.to[robot->findJoint("elbow")] = M_PI + unfold;
    check.begin(motion, 0.5, 0.5);
    check.check(random);
    if (HasFatalFailure()) return;
  }
}

TEST(MotionState, WhatStandsStillDoesNotMove) {
  RandomInputs random;
  const auto robot = randomRobot(random);
  const auto scene = sceneOf(robot);
  const MotionPairs pairs(*scene);
  MotionState state(*scene, pairs);
  const std::vector<double> q(robot->joints().size(), 0.7);
  state.begin({q, q}, {});
  state.moveTo(0.5, 0.5);
  for (std::uint32_t e = 0; e < scene->elements().size(); ++e) {
    EXPECT_FALSE(state.moves(e));
    EXPECT_EQ(state.bound(e, -1).speed, 0.0);
    EXPECT_EQ(state.bound(e, -1).acceleration, 0.0);
    EXPECT_EQ(state.twist(e, -1).v.norm() + state.twist(e, -1).omega.norm(), 0.0);
  }
}

TEST(MotionState, PosesAreThoseOfForwardKinematicsToTheLastBit) {
  RandomInputs random;
  for (int i = 0; i < 20; ++i) {
    const auto robot = randomRobot(random);
    const auto scene = sceneOf(robot);
    const MotionPairs pairs(*scene);
    MotionState state(*scene, pairs);
    JointMotion motion;
    for (std::size_t j = 0; j < robot->joints().size(); ++j) {
      motion.from.push_back(random.uniform(-3.0, 3.0));
      motion.to.push_back(random.uniform(-3.0, 3.0));
    }
    const double at = random.uniform(0.0, 1.0);
    state.begin(motion, {});
    state.moveTo(at, 0.1);
    std::vector<double> q(motion.from.size());
    for (std::size_t j = 0; j < q.size(); ++j) {
      q[j] = motion.from[j] + at * (motion.to[j] - motion.from[j]);
    }
    BodyPoses expected, poses;
    std::vector<Isometry3d> X_WB;
    state.gatherPoses(poses);
    // Joints that mimic follow the leader's position, not the straight line between their own.
    robot->applyMimics(q);
    robot->forwardKinematics(q, X_WB);
    scene->gatherPoses(X_WB, expected);
    for (std::size_t b = 0; b < expected.X_WB.size(); ++b) {
      EXPECT_EQ(poses.X_WB[b].matrix(), expected.X_WB[b].matrix());
    }
  }
}

// So coarser shapes are no faster than PairCertifier takes them to be. The margins do not move.
TEST(MotionState, SpheresHoldTheElementsAndNearlyTheirCoarserShapes) {
  SceneSettings settings;
  settings.max_hull_vertices = 5;  // so few that the hull sticks out far
  const auto scene = CollisionScene::build(mixedRobot(), Srdf{}, nullptr, settings);
  const MotionPairs pairs(*scene);
  MotionState state(*scene, pairs);
  const std::vector<double> still(scene->robot().joints().size(), 0.0);
  state.begin({still, still}, {});
  state.moveTo(0.5, 0.5);
  for (std::uint32_t e = 0; e < scene->elements().size(); ++e) {
    const SceneElement& element = scene->elements()[e];
    for (const Fidelity fidelity : {Fidelity::OBB, Fidelity::CONVEX}) {
      const Rung& rung = element.rung(fidelity);
      std::vector<Vector3d> corners;
      const Shape& shape = rung.shape->shape();
      if (const auto* convex = std::get_if<Convex>(&shape)) corners = convex->mesh->vertices;
      if (const auto* box = std::get_if<Box>(&shape)) corners = boxMesh(0.5 * box->size).vertices;
      for (const Vector3d& p : corners) {
        const double reach = fidelity == Fidelity::OBB ? std::sqrt(3.0) : 1.0;
        EXPECT_LE((rung.X_ER * p - element.box_center).norm(),
                  reach * state.sphere(e).radius * (1.0 + 1e-12))
            << e << " at " << fidelityName(fidelity);
      }
    }
  }
}

// Pairs of a moving model and a static one, whatever classes the filter has: with some objects that
// are attached, and so many that stand about that their pairs cannot be looked at one by one.
TEST(MotionPairs, BesideStaticModelsAreAllThatTheSceneAllows) {
  RandomInputs random;
  for (const int nb_objects : {20, 100'000}) {
    SceneDescription description;
    description.robots.push_back({randomRobot(random), std::nullopt, ""});
    for (int i = 0; i < nb_objects; ++i) {
      RigidObject object;
      object.name = "object" + std::to_string(i);
      object.elements.push_back({Box{{0.1, 0.1, 0.1}}, Isometry3d::Identity()});
      if (i % (nb_objects / 5) == 0) object.attached_link = "l" + std::to_string(i % 7);
      description.objects.push_back(std::move(object));
    }
    const auto scene = CollisionScene::build(description);
    const MotionPairs pairs(*scene);
    const auto nb_models = static_cast<int>(scene->models().size());
    for (int i = 0; i < 100'000; ++i) {
      const auto a = static_cast<std::uint32_t>(random.integer(0, nb_models - 1));
      const auto b = static_cast<std::uint32_t>(random.integer(0, i % 2 ? 20 : nb_models - 1));
      const auto isStatic = [&](std::uint32_t model) { return scene->models()[model].body < 0; };
      ASSERT_EQ(pairs.static_pairs.allowed(a, b),
                scene->filter().allowed(a, b) && (isStatic(a) || isStatic(b)))
          << scene->models()[a].name << ' ' << scene->models()[b].name;
    }
  }
}

}  // namespace collision_pairs::test_motion_state
