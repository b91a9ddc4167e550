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

/// Answers on a thread and with detectors of its own, so that a query never disturbs the cycle.
/// What is wrong with a request is said in its reply, whose verdict is then UNKNOWN.
class QueryService {
 public:
  /// `defaults` is called from the service's thread; the references must outlive this object.
  QueryService(const ros::NodeHandle& private_node, TransformInput& transforms, SceneStore& scenes,
               std::function<QueryDefaults()> defaults);

 private:
  /// Of the last few scenes: requests may take turns with restrictions.
  CollisionDetector& detectorFor(const std::shared_ptr<const CollisionScene>& scene);
  bool onCheck(CheckCollisions::Request& request, CheckCollisions::Response& response);
  void check(const CheckCollisions::Request& request, CheckCollisions::Response& response);

  TransformInput& transforms_;
  SceneStore& scenes_;
  std::function<QueryDefaults()> defaults_;
  std::vector<std::unique_ptr<CollisionDetector>> detectors_;  // the last used is the last
  ros::CallbackQueue queue_;
  ros::ServiceServer server_;
  ros::AsyncSpinner spinner_;  // last: stops before what it calls into goes
};

}  // namespace collision_pairs
