// The services check_collisions and check_trajectory.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include <collision_pairs/CheckCollisions.h>
#include <collision_pairs/CheckTrajectory.h>
#include <ros/callback_queue.h>
#include <ros/node_handle.h>
#include <ros/service_server.h>
#include <ros/spinner.h>
#include <tf2/buffer_core.h>

#include "active_scene.h"
#include "collision_pairs/batch_check.h"

namespace collision_pairs {

/// Answers on a thread and with detectors of its own, so that a query never disturbs the cycle.
/// What is wrong with a request is said in its reply.
class QueryService {
 public:
  /// What is in force when a request comes.
  struct Situation {
    ActiveScenePtr scene;  ///< null while there is none
    CheckSettings settings;
    double max_transform_age;  ///< seconds
  };

  /// `situation` is called from the service's thread.
  QueryService(const ros::NodeHandle& private_node, const tf2::BufferCore& tf_buffer,
               std::function<Situation()> situation);

 private:
  /// Throws InputError while there is no scene.
  Situation now() const;
  bool onCheck(CheckCollisions::Request& request, CheckCollisions::Response& response);
  void check(const CheckCollisions::Request& request, CheckCollisions::Response& response);
  bool onCheckTrajectory(CheckTrajectory::Request& request, CheckTrajectory::Response& response);

  const tf2::BufferCore& tf_buffer_;
  std::function<Situation()> situation_;
  std::unique_ptr<CollisionDetector> detector_;
  std::unique_ptr<BatchCheck> batch_;
  ros::CallbackQueue queue_;
  ros::ServiceServer check_server_;
  ros::ServiceServer trajectory_server_;
  ros::AsyncSpinner spinner_;  // last: stops before what it calls into goes
};

}  // namespace collision_pairs
