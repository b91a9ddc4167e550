// Motions that end in the lightest contact, or just nearer than the clearance, are never FREE, at
// any fidelity: where a bound of the motion is too large, by however little, one of them is.
#include <cmath>
#include <cstdlib>
#include <iostream>
#include <optional>

#include <gtest/gtest.h>

#include "collision_pairs/collision_detector.h"
#include "every_shape.h"
#include "motion_fixtures.h"

namespace collision_pairs::test_motions_to_contact {

using Eigen::Isometry3d;

constexpr Fidelity EVERY_FIDELITY[] = {Fidelity::AABB, Fidelity::OBB, Fidelity::SPHERES,
                                       Fidelity::CONVEX, Fidelity::MESH};
constexpr double RESOLVED = 1e-9;  // m, by which "nearer than the clearance" is certain

/// A link that turns about any axis, slides and turns again.
std::shared_ptr<const RobotModel> arm(RandomInputs& random) {
  const auto axis = [&] {
    const Eigen::Vector3d n = random.rotation() * Eigen::Vector3d::UnitX();
    return "<axis xyz='" + std::to_string(n.x()) + ' ' + std::to_string(n.y()) + ' ' +
           std::to_string(n.z()) + "'/><limit lower='-9' upper='9'/>";
  };
  return robotFrom(emptyLink("root") + emptyLink("shoulder") + emptyLink("boom") +
                   linkWith("hand", "<sphere radius='0.01'/>") +
                   joint("turn", "revolute", "root", "shoulder", "0 0 0", axis()) +
                   joint("slide", "prismatic", "shoulder", "boom", "0.3 0 0", axis()) +
                   joint("twist", "revolute", "boom", "hand", "0.2 0.1 0", axis()));
}

Eigen::Isometry3d handAt(const RobotModel& robot, const std::vector<double>& q) {
  std::vector<Isometry3d> X_RB;
  robot.forwardKinematics(q, X_RB);
  return X_RB[robot.links()[robot.findLink("hand")].body];
}

/// What the hand holds, beside what stands there: two shapes of any kind, sheets too, in any pose.
SceneDescription heldBeside(std::shared_ptr<const RobotModel> robot, const Isometry3d& X_WThere,
                            RandomInputs& random) {
  const auto any = [&] {
    const auto kind =
        static_cast<std::size_t>(random.integer(0, static_cast<int>(EVERY_KIND.size())));
    return shapeOfKind(random, kind < EVERY_KIND.size() ? EVERY_KIND[kind] : "sheet", 0.4);
  };
  RigidObject held{"held", {{any(), random.pose(0.1)}}, "hand", random.pose(0.1), {}};
  RigidObject stands{"stands", {{any(), random.pose(0.1)}}, "", X_WThere * random.pose(0.3), {}};
  SceneDescription description = described(std::move(robot), {held, stands});
  description.settings.max_hull_vertices = 8;
  return description;
}

class Ends {
 public:
  Ends(std::shared_ptr<const CollisionScene> scene, double clearance)
      : scene_(std::move(scene)), detector_(scene_), clearance_(clearance) {
    settings_.alarm_distance = clearance;
  }

  /// The first state found on the way that is just too near; none where the way is free, or begins
  /// too near.
  std::optional<std::vector<double>> before(const JointMotion& motion) {
    constexpr int SAMPLES = 100;
    if (isTooNear(at(motion, 0.0))) return std::nullopt;
    for (int i = 1; i <= SAMPLES; ++i) {
      double free = (i - 1.0) / SAMPLES, near = 1.0 * i / SAMPLES;
      if (!isTooNear(at(motion, near))) continue;
      while (near - free > 1e-12) {
        const double middle = 0.5 * (free + near);
        (isTooNear(at(motion, middle)) ? near : free) = middle;
      }
      return at(motion, near);
    }
    return std::nullopt;
  }

 private:
  static std::vector<double> at(const JointMotion& motion, double fraction) {
    std::vector<double> q = motion.from;
    for (std::size_t i = 0; i < q.size(); ++i) q[i] += fraction * (motion.to[i] - q[i]);
    return q;
  }

  bool isTooNear(const std::vector<double>& q) {
    scene_->robot().forwardKinematics(q, X_RB_);
    scene_->gatherPoses(X_RB_, poses_);
    const CollisionReport& report = detector_.detect(poses_, settings_);
    return report.verdict == Verdict::COLLISION ||
           (!report.pairs.empty() && report.pairs[0].distance < clearance_ - RESOLVED);
  }

  std::shared_ptr<const CollisionScene> scene_;
  CollisionDetector detector_;
  CheckSettings settings_;
  const double clearance_;
  std::vector<Isometry3d> X_RB_;
  BodyPoses poses_;
};

TEST(MotionsToContact, AreNeverFreeAtAnyFidelity) {
  RandomInputs random;
  int nb_ends = 0, nb_free = 0;
  const int nb_rounds = std::getenv("COLLISION_PAIRS_LONG") ? 20000 : 400;
  for (int round = 0; round < nb_rounds; ++round) {
    JointMotion motion{{}, {}};
    for (int i = 0; i < 3; ++i) {
      motion.from.push_back(random.uniform(-1.0, 1.0));
      motion.to.push_back(motion.from.back() + random.uniform(-1.5, 1.5));
    }
    const auto robot = arm(random);
    const auto scene = CollisionScene::build(heldBeside(robot, handAt(*robot, motion.to), random));
    MotionSettings settings;
    settings.clearance = random.integer(0, 1) ? 0.0 : random.uniform(0.0, 0.05);
    settings.only_free = random.integer(0, 1) != 0;
    const auto end = Ends(scene, settings.clearance).before(motion);
    if (end) motion.to = *end;
    nb_ends += end ? 1 : 0;
    settings.fidelity = EVERY_FIDELITY[random.integer(0, 4)];
    const bool is_free = MotionCheck(scene).check(motion, settings).verdict == Verdict::FREE;
    nb_free += is_free ? 1 : 0;
    EXPECT_FALSE(is_free && end) << "round " << round << ", " << fidelityName(settings.fidelity)
                                 << ", clearance " << settings.clearance;
  }
  std::cout << nb_ends << " motions into contact, " << nb_free << " free\n";
  EXPECT_GT(nb_ends, nb_rounds / 4);
  EXPECT_GT(nb_free, nb_rounds / 20);
}

}  // namespace collision_pairs::test_motions_to_contact
