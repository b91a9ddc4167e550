// Obstacles of many sizes, and robots that they touch.
#pragma once

#include <cmath>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "benchmark/benchmark_robots.h"
#include "cloud_processor.h"
#include "collision_pairs/collision_scene.h"
#include "collision_pairs/narrow_phase.h"
#include "random_inputs.h"

namespace collision_pairs {

using Poses = std::vector<Eigen::Isometry3d>;

inline Eigen::Isometry3d moved(const Eigen::Vector3d& by) {
  return Eigen::Isometry3d(Eigen::Translation3d(by));
}

struct Part {
  std::shared_ptr<const PreparedShape> shape;
  Eigen::Isometry3d X;
  double radius;  ///< about X's origin
};

inline Part partOf(const Shape& shape, const Eigen::Isometry3d& X) {
  const Aabb box = computeAabb(shape, Eigen::Isometry3d::Identity());
  return {prepareShape(shape), X, box.min.cwiseAbs().cwiseMax(box.max.cwiseAbs()).norm()};
}

struct Obstacle {
  std::string name;
  std::vector<Part> parts;  ///< in its own frame
};

enum Kind { BALL, FINGERTIP, SHEET, BAR, HAND, NB_KINDS };

/// `size` in metres: the diameter of a ball.
inline Obstacle obstacleOf(Kind kind, double size, RandomInputs& random) {
  Obstacle made;
  const auto add = [&](const Shape& shape, const Eigen::Vector3d& at = Eigen::Vector3d::Zero()) {
    made.parts.push_back(partOf(shape, moved(at)));
  };
  switch (kind) {
    case BALL:
      made.name = "ball of " + std::to_string(std::lround(1000.0 * size)) + " mm";
      add(Sphere{0.5 * size});
      break;
    case FINGERTIP:
      made.name = "fingertip";
      add(Capsule{0.004, 0.004});
      break;
    case SHEET:
      made.name = "sheet";
      add(Box{
          {random.uniform(0.03, 0.3), random.uniform(0.03, 0.3), random.uniform(0.001, 0.005)}});
      break;
    case BAR:
      made.name = "bar";
      add(Capsule{random.uniform(0.004, 0.02), random.uniform(0.1, 0.6)});
      break;
    default:
      made.name = "hand";
      add(Box{{0.085, 0.03, 0.09}});
      add(Capsule{0.03, 0.2}, {0.0, 0.0, -0.15});
      for (int finger = 0; finger < 4; ++finger) {
        add(Capsule{0.008, 0.06}, {-0.032 + 0.021 * finger, 0.0, 0.075});
      }
  }
  return made;
}

inline Obstacle randomObstacle(RandomInputs& random) {
  const auto kind = static_cast<Kind>(random.integer(0, NB_KINDS - 1));
  return obstacleOf(kind, 0.004 * std::pow(15.0, random.uniform(0.0, 1.0)), random);
}

/// Between the first, at X_WO, and the other, in W; no more than `most`.
inline double distance(const Obstacle& first, const Eigen::Isometry3d& X_WO, const Obstacle& other,
                       double most) {
  NarrowPhase narrow_phase;
  for (const Part& a : first.parts) {
    for (const Part& b : other.parts) {
      const Eigen::Isometry3d X_AB = (X_WO * a.X).inverse() * b.X;
      most = std::min(most, narrow_phase.distance(*a.shape, *b.shape, X_AB, most).distance);
    }
  }
  return most;
}

/// A robot and the obstacles that each camera's cloud is for it, with and without padding.
class Setting {
 public:
  Setting(const BenchmarkRobot& robot, int nb_cameras) : robot_(robot.robot) {
    description_.robots.push_back({robot_, std::nullopt, ""});
    description_.check_self = false;
    for (int i = 0; i < nb_cameras; ++i) {
      CloudConfig config;
      config.topic = "camera_" + std::to_string(i);
      config.min_valid_points = 0;
      configs.push_back(config);
      description_.clouds.push_back(obstacleOf(config));
    }
    scene = CollisionScene::build(description_);
    SceneDescription bare = description_;
    for (RigidObject& cloud : bare.clouds) cloud.padding = 0.0;
    bare_scene = CollisionScene::build(bare);
    for (const CloudConfig& config : configs) filters.emplace_back(description_, *scene, config);
    for (const Link& link : robot_->links()) {
      for (const Element& element : link.elements) {
        parts_.push_back({link.body, partOf(element.shape, link.X_BL * element.X_LE)});
      }
    }
  }

  BodyPoses posesOf(const std::vector<SceneBody>& bodies, const Poses& X_WB) const {
    BodyPoses poses;
    poses.resize(bodies.size());
    for (std::size_t i = 0; i < bodies.size(); ++i) {
      poses.X_WB[i] = X_WB[static_cast<std::size_t>(bodies[i].body)];
    }
    return poses;
  }

  /// Of the obstacle from the nearest link, no more than `most`; and its nearest point, in W.
  double distance(const Poses& X_WB, const Obstacle& obstacle, const Eigen::Isometry3d& X_WO,
                  double most, Eigen::Vector3d* nearest = nullptr) {
    for (const auto& [body, part] : parts_) {
      const Eigen::Isometry3d X_WE = X_WB[static_cast<std::size_t>(body)] * part.X;
      for (const Part& other : obstacle.parts) {
        const Eigen::Isometry3d X_EP = X_WE.inverse() * X_WO * other.X;
        if (X_EP.translation().norm() - part.radius - other.radius > most) continue;
        const PairDistance found = narrow_phase_.distance(*part.shape, *other.shape, X_EP, most);
        if (found.distance >= most) continue;
        most = found.distance;
        if (nearest) *nearest = X_WE * found.p_ACb;
      }
    }
    return most;
  }

  void draw(const Poses& X_WB, const Eigen::Isometry3d& X_CW, DepthImage& image) const {
    for (const auto& [body, part] : parts_) {
      image.draw(part.shape->shape(), X_CW * X_WB[static_cast<std::size_t>(body)] * part.X);
    }
  }

  /// A random place in the box of a link that moves; of this one, unless it is empty.
  Eigen::Vector3d placeInLink(RandomInputs& random, const Poses& X_WB, const std::string& link,
                              int& body) const {
    do {
      const auto& [of, part] = parts_[random.integer(0, static_cast<int>(parts_.size()) - 1)];
      body = of;
      const Aabb box = computeAabb(part.shape->shape(), Eigen::Isometry3d::Identity());
      const Eigen::Vector3d at = box.min + random.vector(0, 1).cwiseProduct(box.max - box.min);
      const Body& found = robot_->bodies()[static_cast<std::size_t>(body)];
      if (!link.empty() && robot_->links()[found.link].name != link) continue;
      if (body != 0) return X_WB[static_cast<std::size_t>(body)] * part.X * at;
    } while (true);
  }

  const RobotModel& robot() const { return *robot_; }

  std::vector<CloudConfig> configs;
  std::shared_ptr<const CollisionScene> scene, bare_scene;  ///< bare: without padding
  std::vector<RobotFilter> filters;                         ///< by camera

 private:
  std::shared_ptr<const RobotModel> robot_;
  SceneDescription description_;
  std::vector<std::pair<int, Part>> parts_;  ///< by body
  NarrowPhase narrow_phase_;
};

}  // namespace collision_pairs
