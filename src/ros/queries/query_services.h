// The services check_collisions and check_trajectory, and the reading of their requests.
#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <vector>

#include <collision_pairs/CheckCollisions.h>
#include <collision_pairs/CheckTrajectory.h>
#include <ros/callback_queue.h>
#include <ros/node_handle.h>
#include <ros/service_server.h>
#include <ros/spinner.h>

#include "collision_pairs/batch_check.h"
#include "collision_pairs/input_error.h"
#include "live_monitor.h"
#include "scene_builder.h"

namespace collision_pairs {

/// The node's settings, overridden by those of a request. verdict_only and min_distance come only
/// from the request. Throws InputError.
template <class Request>
CheckSettings settingsFor(const Request& request, CheckSettings settings) {
  if (!std::isfinite(request.alarm_distance)) throw InputError("alarm_distance is not finite");
  if (request.alarm_distance != 0.0) {
    settings.alarm_distance = std::max(0.0, request.alarm_distance);
  }
  if (!std::isfinite(request.tolerance)) throw InputError("tolerance is not finite");
  if (request.tolerance != 0.0) settings.tolerance = std::max(0.0, request.tolerance);
  if (!std::isfinite(request.time_budget)) throw InputError("time_budget is not finite");
  if (request.time_budget != 0.0) settings.time_budget = std::max(0.0, request.time_budget);
  if (!request.fidelity.empty()) settings.fidelity = parseFidelity(request.fidelity);
  settings.verdict_only = request.verdict_only;
  settings.min_distance = request.min_distance;
  return settings;
}

/// What the services answer from. `defaults` is called from their threads; the rest must outlive
/// them.
struct QueryContext {
  LiveMonitor& monitor;
  SceneBuilder& scenes;
  std::function<CheckSettings()> defaults;
};

/// Runs on a separate thread with its own detectors, so that queries do not block the cycle. Errors
/// in a request are returned in its reply, whose verdict is then UNKNOWN.
class QueryService {
 public:
  QueryService(const ros::NodeHandle& private_node, const QueryContext& context);

 private:
  /// For the last few scenes, since requests may alternate between restrictions.
  CollisionDetector& detectorFor(const std::shared_ptr<const CollisionScene>& scene);
  bool onCheck(CheckCollisions::Request& request, CheckCollisions::Response& response);
  void check(const CheckCollisions::Request& request, CheckCollisions::Response& response);

  const QueryContext context_;
  std::vector<std::unique_ptr<CollisionDetector>> detectors_;  // the last used is the last
  ros::CallbackQueue queue_;
  ros::ServiceServer server_;
  ros::AsyncSpinner spinner_;  // last: stops before the others
};

/// Checks many joint states of one request on all cores, on threads of low priority, so that a
/// client that calls it continuously does not slow down the cycle and check_collisions.
class TrajectoryService {
 public:
  TrajectoryService(const ros::NodeHandle& private_node, const QueryContext& context);

 private:
  bool onCheck(CheckTrajectory::Request& request, CheckTrajectory::Response& response);
  /// Throws InputError that names the point and the joint.
  void check(const CheckTrajectory::Request& request, CheckTrajectory::Response& response);

  const QueryContext context_;
  std::unique_ptr<BatchCheck> batch_;
  ros::CallbackQueue queue_;
  ros::ServiceServer server_;
  ros::AsyncSpinner spinner_;  // last: stops before the others
};

}  // namespace collision_pairs
