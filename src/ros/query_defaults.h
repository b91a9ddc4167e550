// Reading of requests, shared by the services check_collisions and check_trajectory.
#pragma once

#include <algorithm>
#include <cmath>

#include "collision_pairs/input_error.h"
#include "scene_store.h"

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

/// Throws InputError while there is no scene.
template <class Request>
ActiveScenePtr sceneFor(const Request& request, SceneStore& scenes) {
  ActiveScenePtr scene = scenes.restrictedTo({request.group, request.links});
  if (!scene) throw InputError("there is no robot yet; see the node's log and diagnostics");
  return scene;
}

/// At `stamp`, or at 0 the latest.
inline StampedPoses posesAt(const ActiveScene& scene, const ros::Time& stamp,
                            const ros::Time& now) {
  return stamp.isZero() ? scene.tf_poses->latest(now) : scene.tf_poses->at(stamp);
}

}  // namespace collision_pairs
