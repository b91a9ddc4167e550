// The service check_collisions.
#pragma once

#include <functional>
#include <memory>
#include <vector>

#include <collision_pairs/CheckCollisions.h>
#include <ros/callback_queue.h>
#include <ros/node_handle.h>
#include <ros/service_server.h>
#include <ros/spinner.h>

#include "query_defaults.h"
#include "transform_input.h"

namespace collision_pairs {

/// Runs on a separate thread with its own detectors, so that queries do not block the cycle. Errors
/// in a request are returned in its reply, whose verdict is then UNKNOWN.
class QueryService {
 public:
  /// `defaults` is called from the service's thread; the references must outlive this object.
  QueryService(const ros::NodeHandle& private_node, TransformInput& transforms, SceneStore& scenes,
               std::function<CheckSettings()> defaults);

 private:
  /// For the last few scenes, since requests may alternate between restrictions.
  CollisionDetector& detectorFor(const std::shared_ptr<const CollisionScene>& scene);
  bool onCheck(CheckCollisions::Request& request, CheckCollisions::Response& response);
  void check(const CheckCollisions::Request& request, CheckCollisions::Response& response);

  TransformInput& transforms_;
  SceneStore& scenes_;
  std::function<CheckSettings()> defaults_;
  std::vector<std::unique_ptr<CollisionDetector>> detectors_;  // the last used is the last
  ros::CallbackQueue queue_;
  ros::ServiceServer server_;
  ros::AsyncSpinner spinner_;  // last: stops before the others
};

}  // namespace collision_pairs
