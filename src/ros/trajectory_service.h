// The service check_trajectory.
#pragma once

#include <functional>
#include <memory>

#include <collision_pairs/CheckTrajectory.h>
#include <ros/callback_queue.h>
#include <ros/node_handle.h>
#include <ros/service_server.h>
#include <ros/spinner.h>

#include "collision_pairs/batch_check.h"
#include "query_defaults.h"
#include "transform_input.h"

namespace collision_pairs {

/// Checks many joint states of one request on all cores, on threads of low priority, so that a
/// client that calls it continuously does not slow down the cycle and check_collisions.
class TrajectoryService {
 public:
  /// `defaults` is called from the service's thread; the references must outlive this object.
  TrajectoryService(const ros::NodeHandle& private_node, TransformInput& transforms,
                    SceneStore& scenes, std::function<CheckSettings()> defaults);

 private:
  bool onCheck(CheckTrajectory::Request& request, CheckTrajectory::Response& response);
  /// Throws InputError that names the point and the joint.
  void check(const CheckTrajectory::Request& request, CheckTrajectory::Response& response);

  TransformInput& transforms_;
  SceneStore& scenes_;
  std::function<CheckSettings()> defaults_;
  std::unique_ptr<BatchCheck> batch_;
  ros::CallbackQueue queue_;
  ros::ServiceServer server_;
  ros::AsyncSpinner spinner_;  // last: stops before the others
};

}  // namespace collision_pairs
