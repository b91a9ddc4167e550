// The node, which runs a check each cycle.
#pragma once

#include <atomic>
#include <memory>
#include <mutex>
#include <optional>
#include <string>

#include <collision_pairs/CollisionPairsConfig.h>
#include <diagnostic_updater/diagnostic_updater.h>
#include <dynamic_reconfigure/server.h>
#include <ros/callback_queue.h>
#include <ros/ros.h>

#include "cloud_threads.h"
#include "collision_pairs/collision_detector.h"
#include "live_monitor.h"
#include "node_health.h"
#include "parameters.h"
#include "query_services.h"
#include "report_publisher.h"
#include "scene_builder.h"
#include "scene_service.h"
#include "velocity_limiter.h"

namespace collision_pairs {

/// Publishes a report each cycle in any case: if there is no scene or no usable transform, or
/// something fails, its verdict is UNKNOWN. Scenes are built, and queries answered, on other
/// threads.
class CollisionPairsNode {
 public:
  /// `queue` is that of both handles.
  CollisionPairsNode(ros::NodeHandle node, ros::NodeHandle private_node, ros::CallbackQueue& queue);

  /// Runs cycles, and the callbacks of the queue between them, until ROS shuts down or stop().
  void run();
  /// From another thread: it ends after the cycle, within a second.
  void stop() { stops_ = true; }

 private:
  CheckSettings settings() const;

  bool isTriggeredByTf() const { return parameters_.trigger == NodeParameters::TF; }
  ros::SteadyTime nextCycle() const;
  void cycle();
  void check(const Snapshot& snapshot, const ros::Time& now, const ros::WallTime& start);
  void reportUnknown(const std::string& why);
  void draw(const Snapshot& snapshot, const CollisionPairs& message, const CheckSettings& settings);
  void showMarkers(const CollisionPairs& message, const CollisionReport* report,
                   const std::optional<ShownLimit>& limit);
  void takeScene(const ActiveScenePtr& scene);
  void diagnoseClouds();

  void reconfigure(CollisionPairsConfig& config);

  ros::CallbackQueue& queue_;
  std::atomic<bool> stops_{false};
  ros::NodeHandle private_node_;
  NodeParameters parameters_;      // written by reconfigure() under mutex_
  const std::string first_frame_;  // of reports while there is no scene; may be empty
  LiveMonitor monitor_;
  mutable std::mutex mutex_;  // guards parameters_
  CloudThreads clouds_;
  SceneBuilder scenes_;
  SceneService scene_service_;

  // Used by the cycle's thread only.
  ReportPublisher publisher_;
  std::unique_ptr<CollisionDetector> detector_;
  ActiveScenePtr checked_scene_;
  ros::SteadyTime next_cycle_;  // the earliest
  ros::SteadyTime last_cycle_;
  std::uint64_t nb_taken_ = 0;  // messages of transforms before the last cycle
  NodeHealth health_;
  std::unique_ptr<dynamic_reconfigure::Server<CollisionPairsConfig>> reconfigure_server_;
  diagnostic_updater::Updater diagnostics_;
  bool diagnoses_clouds_ = false;
  // Last: they are destroyed before the members they use.
  QueryService queries_;
  TrajectoryService trajectories_;
  VelocityLimiter limiter_;
};

}  // namespace collision_pairs
