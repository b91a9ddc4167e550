// The node: a cycle on a timer, a service beside it.
#pragma once

#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include <collision_pairs/CheckCollisions.h>
#include <collision_pairs/CheckTrajectory.h>
#include <collision_pairs/CollisionPairs.h>
#include <collision_pairs/CollisionPairsConfig.h>
#include <diagnostic_updater/diagnostic_updater.h>
#include <dynamic_reconfigure/server.h>
#include <ros/callback_queue.h>
#include <ros/ros.h>
#include <ros/spinner.h>
#include <std_srvs/Trigger.h>
#include <tf2_ros/buffer.h>
#include <tf2_ros/transform_listener.h>

#include "clock_watch.h"
#include "collision_pairs/batch_check.h"
#include "parameters.h"
#include "scene_loader.h"
#include "tf_poses.h"

namespace collision_pairs {

/// Publishes a report each cycle, and answers queries on a thread and with a detector of their
/// own, so that a query never disturbs the cycle. While there is no scene (no robot_description,
/// or one that cannot be read) it says so, and looks for one every few seconds.
class CollisionPairsNode {
 public:
  CollisionPairsNode(ros::NodeHandle node, ros::NodeHandle private_node);

 private:
  /// A scene with what the node knows of it. Replaced as a whole; whoever holds one may go on.
  struct ActiveScene {
    LoadedScene loaded;
    std::string frame;
    std::unique_ptr<TfPoses> tf_poses;
  };
  using ActiveScenePtr = std::shared_ptr<const ActiveScene>;

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
  ActiveScenePtr activeScene() const;
  CheckSettings settings() const;

  void cycle();
  /// The newest poses that are of this pass of the clock.
  StampedPoses freshPoses(const TfPoses& tf_poses);
  void publish(const ActiveScene& scene, const StampedPoses& stamped, const ros::Time& stamp,
               double transform_time);
  void publishMarkers();
  void noteHealth(const CollisionPairs& message, const std::string& problem);
  void diagnose(diagnostic_updater::DiagnosticStatusWrapper& status) const;

  void reconfigure(CollisionPairsConfig& config);
  bool onCheck(CheckCollisions::Request& request, CheckCollisions::Response& response);
  void check(const CheckCollisions::Request& request, CheckCollisions::Response& response);
  bool onCheckTrajectory(CheckTrajectory::Request& request, CheckTrajectory::Response& response);
  /// The node's settings with what a request says instead. Throws InputError.
  CheckSettings settingsFor(double alarm_distance, const std::string& fidelity,
                            double time_budget) const;
  StampedPoses posesAt(const ActiveScene& scene, const ros::Time& stamp) const;
  bool onReset(std_srvs::Trigger::Request& request, std_srvs::Trigger::Response& response);

  ros::NodeHandle node_;
  ros::NodeHandle private_node_;
  NodeParameters parameters_;  // written by reconfigure() under mutex_

  tf2_ros::Buffer tf_buffer_;
  tf2_ros::TransformListener tf_listener_;

  mutable std::mutex mutex_;  // guards scene_ and parameters_
  ActiveScenePtr scene_;

  // Of the cycle's thread alone.
  std::unique_ptr<CollisionDetector> detector_;
  ActiveScenePtr reported_scene_;
  ros::Time reported_stamp_;
  ros::WallTime next_load_;
  ClockWatch clock_watch_;
  Health health_;

  // Of the service's thread alone.
  std::unique_ptr<CollisionDetector> query_detector_;
  std::unique_ptr<BatchCheck> batch_;

  ros::Publisher pairs_publisher_;
  ros::Publisher in_collision_publisher_;
  ros::Publisher markers_publisher_;
  ros::ServiceServer reset_service_;
  ros::CallbackQueue query_queue_;
  ros::ServiceServer check_service_;
  ros::ServiceServer trajectory_service_;
  ros::WallTimer timer_;
  std::unique_ptr<dynamic_reconfigure::Server<CollisionPairsConfig>> reconfigure_server_;
  diagnostic_updater::Updater diagnostics_;
  ros::WallTimer diagnostics_timer_;
  ros::AsyncSpinner query_spinner_;  // last: stops before what it calls into goes
};

}  // namespace collision_pairs
