// Simulated depth cameras before a robot and an obstacle, and the verdict by their clouds.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <string>
#include <vector>

#include "cloud_view.h"
#include "collision_pairs/collision_detector.h"
#include "collision_pairs/voxel_grid.h"
#include "depth_image.h"
#include "touched_robots.h"

namespace collision_pairs {

constexpr double PERIOD = 1.0 / 15.0;                      // s, between clouds
constexpr double NOISE = 0.005, MOST_NOISE = 3.0 * NOISE;  // m, of a depth
constexpr double INF = std::numeric_limits<double>::infinity();
constexpr int WIDTH = 320, HEIGHT = 240, FOCAL_LENGTH = 450;  // pixels

struct Seen {
  bool free, collides;
  bool free_without = false;  ///< by the voxels of the last half second alone
  std::vector<bool> by;       ///< by camera: any of the obstacle
  bool in_part = false;       ///< something hides some of it from a camera
  std::vector<bool> place;    ///< by camera: some of it within the padding of where it will touch
  std::string why;
};

class Cameras {
 public:
  /// `still`: in W; what the cameras see besides. `compares`: whether Seen::free_without is wanted.
  Cameras(Setting& setting, RandomInputs& random, const Eigen::Vector3d& looks_at,
          const Obstacle& still, bool compares)
      : setting_(setting),
        still_(still),
        detector_(setting.scene),
        bare_detector_(setting.bare_scene),
        is_ordered_(random.integer(0, 3) > 0),
        compares_(compares) {
    std::normal_distribution<double> normal(0.0, NOISE);
    for (double& noise : noise_) {
      noise = std::clamp(normal(random.engine()), -MOST_NOISE, MOST_NOISE);
    }
    for (const CloudConfig& config : setting.configs) {
      one_.emplace_back(lookingAt(looks_at, random), config);
    }
  }

  /// `place`: where the obstacle touches, in its frame.
  Seen see(const Poses& X_WB, const Obstacle* obstacle, const Eigen::Isometry3d& X_WO,
           const Eigen::Vector3d& place, RandomInputs& random) {
    ++number_;
    Seen seen;
    std::map<std::string, CloudView> views;
    for (std::size_t i = 0; i < one_.size(); ++i) {
      const double nearest = take(i, X_WB, obstacle, X_WO, X_WO * place, random, seen.in_part);
      seen.by.push_back(nearest < INF);
      seen.place.push_back(nearest < setting_.configs[i].padding());
      views[setting_.configs[i].name()] = viewOf(setting_.configs[i], one_[i].latest,
                                                 one_[i].latest.stamp, setting_.configs[i].topic);
    }
    BodyPoses poses = setting_.posesOf(setting_.scene->bodies(), X_WB);
    const auto reasons = addVoxels(views, *setting_.scene, poses);
    const Verdict verdict = detector_.detect(poses, CheckSettings()).verdict;
    seen.free = verdict == Verdict::FREE && reasons.empty();
    seen.collides = verdict == Verdict::COLLISION;
    for (const SuspectCloud& problem : reasons) seen.why += problem.why + "; ";
    if (!compares_) return seen;
    poses.voxels.clear();
    for (One& one : one_) poses.voxels.push_back(one.plain.end());
    seen.free_without = bare_detector_.detect(poses, CheckSettings()).verdict == Verdict::FREE;
    return seen;
  }

 private:
  struct One {
    One(const Eigen::Isometry3d& X, const CloudConfig& config) : X_CW(X), processor(config) {}
    Eigen::Isometry3d X_CW;
    CloudProcessor processor;
    VoxelGrid plain{plainSettings()};
    LatestCloud latest;
    Poses robot_drawn = {};
    DepthImage of_robot = DepthImage(WIDTH, HEIGHT, FOCAL_LENGTH);
  };

  static constexpr int NB_NOISES = 8191;

  static VoxelSettings plainSettings() {
    VoxelSettings settings;
    settings.decay = 0.5;
    return settings;
  }

  static Eigen::Isometry3d lookingAt(const Eigen::Vector3d& place, RandomInputs& random) {
    const Eigen::Matrix3d R = random.rotation().toRotationMatrix();
    Eigen::Isometry3d X_WC = Eigen::Isometry3d::Identity();
    X_WC.linear() = R;
    X_WC.translation() = place - random.uniform(0.7, 1.2) * R.col(2);
    return X_WC.inverse();
  }

  /// How near to the place the camera sees the obstacle; infinite: nowhere. Sets `in_part` if some
  /// of it is behind something.
  double take(std::size_t i, const Poses& X_WB, const Obstacle* obstacle,
              const Eigen::Isometry3d& X_WO, const Eigen::Vector3d& place_W, RandomInputs& random,
              bool& in_part) {
    One& one = one_[i];
    const auto isSame = [](const Eigen::Isometry3d& a, const Eigen::Isometry3d& b) {
      return a.matrix() == b.matrix();
    };
    if (!std::equal(X_WB.begin(), X_WB.end(), one.robot_drawn.begin(), one.robot_drawn.end(),
                    isSame)) {
      one.of_robot.clear();
      setting_.draw(X_WB, one.X_CW, one.of_robot);
      for (const Part& part : still_.parts) {
        one.of_robot.draw(part.shape->shape(), one.X_CW * part.X);
      }
      one.robot_drawn = X_WB;
    }
    DepthImage image = one.of_robot, of_obstacle(WIDTH, HEIGHT, FOCAL_LENGTH);
    if (obstacle) {
      for (const Part& part : obstacle->parts) {
        image.draw(part.shape->shape(), one.X_CW * X_WO * part.X);
        of_obstacle.draw(part.shape->shape(), one.X_CW * X_WO * part.X);
      }
    }
    double nearest = INF;
    std::vector<Eigen::Vector3d> points;
    auto next_noise = static_cast<std::size_t>(random.integer(0, NB_NOISES - 1));
    for (int v = 0; v < HEIGHT; ++v) {
      for (int u = 0; u < WIDTH; ++u) {
        const double depth = image.depth(u, v);
        if (!std::isfinite(depth)) continue;
        in_part = in_part || (std::isfinite(of_obstacle.depth(u, v)) &&
                              of_obstacle.depth(u, v) > image.depth(u, v));
        if (image.depth(u, v) < one.of_robot.depth(u, v)) {
          nearest = std::min(nearest, (depth * image.ray(u, v) - one.X_CW * place_W).norm());
        }
        const double noise = noise_[next_noise++ % NB_NOISES];
        points.push_back((depth + noise / image.ray(u, v).norm()) * image.ray(u, v));
      }
    }
    if (!is_ordered_) std::shuffle(points.begin(), points.end(), random.engine());
    RobotFilter& filter = setting_.filters[i];
    const double stamp = PERIOD * number_;
    const BodyPoses robot = setting_.posesOf(filter.own.bodies(), X_WB);
    const auto voxels = one.processor.add(points, one.X_CW.inverse(), robot, stamp, filter);
    one.latest = {voxels, stamp, "", "", one.processor.mayTouch()};
    if (compares_) {
      one.plain.begin(stamp, one.X_CW.inverse().translation());
      for (const Eigen::Vector3d& p_C : points) {
        const Eigen::Vector3d p_W = one.X_CW.inverse() * p_C;
        if (!filter.own.isOwn(p_W)) one.plain.add(p_W);
      }
    }
    return nearest;
  }

  Setting& setting_;
  const Obstacle still_;
  CollisionDetector detector_, bare_detector_;
  std::vector<One> one_;
  bool is_ordered_, compares_;
  std::array<double, NB_NOISES> noise_;
  int number_ = 0;
};

}  // namespace collision_pairs
