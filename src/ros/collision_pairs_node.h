// The node: a cycle, again and again.
#pragma once

#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include <collision_pairs/CollisionPairs.h>
#include <collision_pairs/CollisionPairsConfig.h>
#include <diagnostic_updater/diagnostic_updater.h>
#include <dynamic_reconfigure/server.h>
#include <ros/callback_queue.h>
#include <ros/ros.h>
#include <std_srvs/Trigger.h>
#include <tf2_ros/buffer.h>
#include <tf2_ros/transform_listener.h>

#include "clock_watch.h"
#include "collision_pairs/collision_detector.h"
#include "parameters.h"
#include "query_service.h"
#include "scene_store.h"
#include "update_service.h"

namespace collision_pairs {

/// Publishes a report each cycle, beside a QueryService. While there is no scene (no
/// robot_description, or one that cannot be read) it says so, and looks for one every few seconds.
class CollisionPairsNode {
 public:
  CollisionPairsNode(ros::NodeHandle node, ros::NodeHandle private_node);

  /// Runs cycles, and the callbacks of the global queue between them, until ROS shuts down.
  void run();

 private:
  /// Health of the last cycles, for the diagnostics.
  struct Health {
    std::string problem = "no cycle yet";
    double transform_age = 0.0;
    double cycle_time = 0.0;
    std::vector<std::string> left_out;
    std::uint32_t nb_boxes = 0, nb_pairs = 0, nb_degraded = 0, nb_unresolved = 0;
    std::uint64_t cycles = 0, overruns = 0, out_of_time = 0;
  };

  bool loadScene(std::string& problem);
  CheckSettings settings() const;
  QueryService::Defaults queryDefaults() const;

  void cycle();
  void takeScene(const ActiveScenePtr& scene);
  /// The newest poses that are of this pass of the clock.
  StampedPoses freshPoses(const TfPoses& tf_poses);
  void publish(const ActiveScene& scene, const StampedPoses& stamped, const ros::Time& stamp,
               double transform_time);
  void publishMarkers();
  void publishSceneMarkers(std::size_t nb_known);
  void noteHealth(const CollisionPairs& message, const std::string& problem);
  void diagnose(diagnostic_updater::DiagnosticStatusWrapper& status) const;

  void reconfigure(CollisionPairsConfig& config);
  bool onReset(std_srvs::Trigger::Request& request, std_srvs::Trigger::Response& response);

  ros::NodeHandle node_;
  ros::NodeHandle private_node_;
  NodeParameters parameters_;  // written by reconfigure() under mutex_

  tf2_ros::Buffer tf_buffer_;
  tf2_ros::TransformListener tf_listener_;

  mutable std::mutex mutex_;  // guards parameters_
  SceneStore scenes_;

  // Of the cycle's thread alone.
  std::unique_ptr<CollisionDetector> detector_;
  ActiveScenePtr reported_scene_;
  ros::Time reported_stamp_;
  ros::SteadyTime next_cycle_;
  ros::WallTime next_load_;
  ClockWatch clock_watch_;
  Health health_;

  ros::Publisher pairs_publisher_;
  ros::Publisher in_collision_publisher_;
  ros::Publisher markers_publisher_;
  ros::Publisher scene_publisher_;
  ActiveScenePtr shown_scene_;  // by the markers of the scene
  std::size_t nb_shown_ = 0;    // bodies with a pose then
  ros::SteadyTime show_scene_from_;
  ros::ServiceServer reset_service_;
  std::unique_ptr<dynamic_reconfigure::Server<CollisionPairsConfig>> reconfigure_server_;
  diagnostic_updater::Updater diagnostics_;
  // Last: they end before what they ask goes.
  UpdateService updates_;
  QueryService queries_;
};

}  // namespace collision_pairs
