#include "motion_scenes.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "joint_sampler.h"
#include "test_shapes.h"

namespace collision_pairs {
namespace {

constexpr std::uint64_t SEED = 20240611;
constexpr int NB_THINGS = 30;

class Clutter {
 public:
  Clutter(std::uint64_t index, double reach) : random_(SEED, index), reach_(reach) {}

  RigidObject thing(int number) {
    RigidObject object;
    object.name = "thing_" + std::to_string(number);
    object.elements.push_back({shape(number % 3), Eigen::Isometry3d::Identity()});
    object.X_PO.setIdentity();
    object.X_PO.linear() =
        Eigen::Quaterniond(between(-1, 1), between(-1, 1), between(-1, 1), between(-1, 1))
            .normalized()
            .toRotationMatrix();
    object.X_PO.translation() =
        Eigen::Vector3d(between(-1.0, 1.0), between(-1.0, 1.0), between(-0.3, 1.2)) * reach_;
    return object;
  }

 private:
  Shape shape(int kind) {
    if (kind == 0) return Box{{between(0.1, 0.5), between(0.1, 0.5), 0.002}};
    if (kind == 1) return Box{{between(0.02, 0.2), between(0.02, 0.2), between(0.02, 0.2)}};
    if (between(0, 1) < 0.5) return meshShape(LShape().mesh());
    return meshShape(bumpyBall(12, between(0.05, 0.12)));
  }
  double between(double low, double high) { return low + (high - low) * random_.uniform(); }

  RandomStream random_;
  double reach_;
};

std::shared_ptr<const CollisionScene> sceneOf(const BenchmarkRobot& robot,
                                              std::vector<RigidObject> objects,
                                              const SceneSettings& settings) {
  SceneDescription description;
  description.robots.push_back({robot.robot, robot.srdf, ""});
  description.objects = std::move(objects);
  description.settings = settings;
  return CollisionScene::build(description, &sceneCache());
}

bool isTouched(const std::shared_ptr<const CollisionScene>& scene) {
  JointMotion none;
  none.from = none.to = scene->robot().zeroPositions();
  StateLoop zero(scene);
  for (const PairReport& pair : zero.at(none, 0.0, {}).pairs) {
    const auto& models = scene->models();
    if (models[pair.first].is_object || models[pair.second].is_object) return true;
  }
  return false;
}

}  // namespace

SceneCache& sceneCache() {
  static SceneCache cache;
  return cache;
}

std::vector<RigidObject> clutter(const BenchmarkRobot& robot, std::uint64_t index, int nb_things,
                                 const SceneSettings& settings) {
  Clutter things(index, robot.name == "pr2" ? 1.2 : 0.9);
  std::vector<RigidObject> objects;
  for (int i = 0; i < nb_things; ++i) {
    do {
      if (i < static_cast<int>(objects.size())) objects.pop_back();
      objects.push_back(things.thing(i));
    } while (isTouched(sceneOf(robot, {objects.back()}, settings)));
  }
  return objects;
}

std::shared_ptr<const CollisionScene> clutteredScene(const BenchmarkRobot& robot,
                                                     std::uint64_t index,
                                                     const SceneSettings& settings) {
  return sceneOf(robot, clutter(robot, index, NB_THINGS, settings), settings);
}

double lengthNumber(std::uint64_t index) {
  const double golden = 0.618033988749895 * static_cast<double>(index);
  return 0.1 + 2.9 * (golden - std::floor(golden));
}

double lengthOf(const JointMotion& motion) {
  double most = 0.0;
  for (std::size_t i = 0; i < motion.from.size(); ++i) {
    most = std::max(most, std::abs(motion.to[i] - motion.from[i]));
  }
  return most;
}

JointMotion randomMotion(const std::shared_ptr<const RobotModel>& robot, std::uint64_t index,
                         double length) {
  const JointSampler sampler(robot, SEED);
  JointMotion motion;
  sampler.draw(2 * index, motion.from);
  sampler.draw(2 * index + 1, motion.to);
  const double share = std::min(1.0, length / lengthOf(motion));
  for (std::size_t i = 0; i < motion.to.size(); ++i) {
    motion.to[i] = motion.from[i] + share * (motion.to[i] - motion.from[i]);
  }
  return motion;
}

StateLoop::StateLoop(std::shared_ptr<const CollisionScene> scene)
    : scene_(std::move(scene)), detector_(scene_) {}

const CollisionReport& StateLoop::at(const JointMotion& motion, double fraction,
                                     const CheckSettings& settings) {
  positions_.resize(motion.from.size());
  for (std::size_t i = 0; i < positions_.size(); ++i) {
    positions_[i] = motion.from[i] + fraction * (motion.to[i] - motion.from[i]);
  }
  scene_->robot().applyMimics(positions_);
  scene_->robot().forwardKinematics(positions_, X_RB_);
  scene_->gatherPoses(X_RB_, poses_);
  return detector_.detect(poses_, settings);
}

bool StateLoop::findsContact(const JointMotion& motion, double step) {
  CheckSettings settings;
  settings.verdict_only = true;
  const int nb_steps = std::max(1, static_cast<int>(std::ceil(lengthOf(motion) / step)));
  for (int i = 0; i <= nb_steps; ++i) {
    if (at(motion, static_cast<double>(i) / nb_steps, settings).in_collision) return true;
  }
  return false;
}

}  // namespace collision_pairs
