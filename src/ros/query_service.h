// The services check_collisions and check_trajectory.
#pragma once

#include <functional>
#include <memory>
#include <vector>

#include <collision_pairs/CheckCollisions.h>
#include <collision_pairs/CheckTrajectory.h>
#include <ros/callback_queue.h>
#include <ros/node_handle.h>
#include <ros/service_server.h>
#include <ros/spinner.h>
#include <tf2/buffer_core.h>

#include "collision_pairs/batch_check.h"
#include "scene_store.h"

namespace collision_pairs {

/// Answers on a thread and with detectors of its own, so that a query never disturbs the cycle.
/// What is wrong with a request is said in its reply.
class QueryService {
 public:
  /// What the node does, unless a request says something else.
  struct Defaults {
    CheckSettings settings;
    double max_transform_age;  ///< seconds
  };

  /// `defaults` is called from the service's thread; the references must outlive this object.
  QueryService(const ros::NodeHandle& private_node, const tf2::BufferCore& tf_buffer,
               SceneStore& scenes, std::function<Defaults()> defaults);

 private:
  /// Of the last few scenes: requests may take turns with restrictions.
  CollisionDetector& detectorFor(const std::shared_ptr<const CollisionScene>& scene);
  bool onCheck(CheckCollisions::Request& request, CheckCollisions::Response& response);
  void check(const CheckCollisions::Request& request, CheckCollisions::Response& response);
  bool onCheckTrajectory(CheckTrajectory::Request& request, CheckTrajectory::Response& response);

  const tf2::BufferCore& tf_buffer_;
  SceneStore& scenes_;
  std::function<Defaults()> defaults_;
  std::vector<std::unique_ptr<CollisionDetector>> detectors_;  // the last used is the last
  std::unique_ptr<BatchCheck> batch_;
  ros::CallbackQueue queue_;
  ros::ServiceServer check_server_;
  ros::ServiceServer trajectory_server_;
  ros::AsyncSpinner spinner_;  // last: stops before what it calls into goes
};

}  // namespace collision_pairs
