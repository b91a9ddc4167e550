// A Monitor of a robot, fed by hand.
#pragma once

#include <memory>
#include <string>
#include <utility>

#include <gtest/gtest.h>

#include "collision_pairs/collision_detector.h"
#include "demo_scene.h"
#include "monitor.h"

namespace collision_pairs {

/// Loads it at once.
inline void load(Monitor& monitor, SceneParameters parameters) {
  SceneJob job = monitor.scenes().load(std::move(parameters));
  job.run();
  ASSERT_TRUE(monitor.scenes().take(job));
}

inline SceneParameters parametersOf(const std::string& links_and_joints) {
  SceneParameters parameters;
  parameters.sources.robots.push_back(
      {std::make_unique<RobotSource>("<robot name='test'>" + links_and_joints + "</robot>",
                                     noMeshes),
       std::nullopt, ""});
  return parameters;
}

/// `child` in `parent`, at x.
inline tf2_msgs::TFMessage transformOf(const std::string& parent, const std::string& child,
                                       const ros::Time& stamp, double x) {
  tf2_msgs::TFMessage message;
  message.transforms.resize(1);
  auto& transform = message.transforms[0];
  transform.header.stamp = stamp;
  transform.header.frame_id = parent;
  transform.child_frame_id = child;
  transform.transform.translation.x = x;
  transform.transform.rotation.w = 1.0;
  return message;
}

/// As the node checks a snapshot.
struct Checked {
  CollisionReport report;
  ClosingReport closing;
};
inline Checked check(const Monitor& monitor, const Snapshot& snapshot,
                     const CheckSettings& settings) {
  CollisionDetector detector(snapshot.scene->scene);
  Checked checked{detector.detect(snapshot.poses, settings), {}};
  checked.closing =
      closingReport(*snapshot.scene->scene, checked.report, settings.alarm_distance > 0.0,
                    snapshot.poses, monitor.before(snapshot, checked.report));
  return checked;
}

}  // namespace collision_pairs
