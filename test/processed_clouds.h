// Clouds of points about two boxes, for a CloudProcessor.
#pragma once

#include <gtest/gtest.h>

#include "cloud_processor.h"
#include "demo_scene.h"

namespace collision_pairs {

/// Box a at x = 0 and box b at x = 10; the sensor stands at x = 5 and looks along W.
class CloudProcessing : public testing::Test {
 protected:
  CloudProcessing() {
    config_.topic = "camera";
    config_.voxel_size = 0.1;
    config_.max_range = 20.0;
    config_.self_filter_padding = 0.05;
    description_.robots.push_back({robotFrom(slidingBoxes(2)), std::nullopt, ""});
    X_WS_.translation() = Eigen::Vector3d(5, 0, 0);
  }

  /// Points in W; the voxels after each cloud, a second later than the one before.
  std::shared_ptr<const OccupiedVoxels> add(CloudProcessor& processor,
                                            const std::vector<Eigen::Vector3d>& points) {
    description_.clouds = {obstacleOf(config_)};
    RobotFilter filter(description_, *CollisionScene::build(description_), config_);
    filter.keeps_more = keeps_more_;
    keeps_more_ = false;
    const std::vector<SceneBody>& bodies = filter.own.bodies();
    BodyPoses robot;
    robot.resize(bodies.size());
    for (std::size_t i = 0; i < bodies.size(); ++i) {
      const std::string& link = bodies[i].link;
      robot.X_WB[i].translation().x() = link == "b" ? 10.0 : x_of_a_;
      if (link == unknown_link_) robot.known[i] = 0;
    }
    std::vector<Eigen::Vector3d> in_sensor;
    for (const Eigen::Vector3d& p_WP : points) {
      in_sensor.push_back(X_WS_.inverse() * p_WP);
    }
    stamp_ += 1.0;
    return processor.add(in_sensor, X_WS_, robot, stamp_, filter);
  }

  std::size_t nbVoxels(const std::vector<Eigen::Vector3d>& points) {
    CloudProcessor processor(config_);
    return add(processor, points)->size();
  }

  CloudConfig config_;
  SceneDescription description_;
  Eigen::Isometry3d X_WS_ = Eigen::Isometry3d::Identity();
  double stamp_ = 100.0, x_of_a_ = 0.0;
  std::string unknown_link_;
  bool keeps_more_ = false;  ///< the next filter
};

}  // namespace collision_pairs
