#include "query_service.h"

#include <algorithm>
#include <cmath>

#include "collision_pairs/input_error.h"
#include "conversions.h"
#include "joint_query.h"
#include "trajectory_check.h"

namespace collision_pairs {
namespace {

constexpr std::size_t KEPT_DETECTORS = 2;

/// The node's settings with what a request says instead.
template <class Request>
CheckSettings settingsFor(const Request& request, CheckSettings settings) {
  if (!std::isfinite(request.alarm_distance)) throw InputError("alarm_distance is not finite");
  if (request.alarm_distance != 0.0) {
    settings.alarm_distance = std::max(0.0, request.alarm_distance);
  }
  if (!std::isfinite(request.time_budget)) throw InputError("time_budget is not finite");
  if (request.time_budget != 0.0) settings.time_budget = std::max(0.0, request.time_budget);
  if (!request.fidelity.empty()) settings.fidelity = parseFidelity(request.fidelity);
  return settings;
}

/// Throws InputError while there is no scene.
template <class Request>
ActiveScenePtr sceneFor(const Request& request, SceneStore& scenes) {
  ActiveScenePtr scene = scenes.restrictedTo({request.group, request.links});
  if (!scene) throw InputError("there is no robot yet; see the node's log and diagnostics");
  return scene;
}

StampedPoses posesAt(const ActiveScene& scene, const ros::Time& stamp, double max_transform_age) {
  return stamp.isZero() ? scene.tf_poses->latest(max_transform_age) : scene.tf_poses->at(stamp);
}

}  // namespace

QueryService::QueryService(const ros::NodeHandle& private_node, const tf2::BufferCore& tf_buffer,
                           SceneStore& scenes, std::function<Defaults()> defaults)
    : tf_buffer_(tf_buffer), scenes_(scenes), defaults_(std::move(defaults)), spinner_(1, &queue_) {
  ros::NodeHandle node(private_node);
  node.setCallbackQueue(&queue_);
  check_server_ = node.advertiseService("check_collisions", &QueryService::onCheck, this);
  trajectory_server_ =
      node.advertiseService("check_trajectory", &QueryService::onCheckTrajectory, this);
  spinner_.start();
}

CollisionDetector& QueryService::detectorFor(const std::shared_ptr<const CollisionScene>& scene) {
  const auto known = std::find_if(detectors_.begin(), detectors_.end(), [&](const auto& detector) {
    return &detector->scene() == scene.get();
  });
  if (known != detectors_.end()) {
    std::rotate(known, known + 1, detectors_.end());
  } else {
    if (detectors_.size() == KEPT_DETECTORS) detectors_.erase(detectors_.begin());
    detectors_.push_back(std::make_unique<CollisionDetector>(scene));
  }
  return *detectors_.back();
}

bool QueryService::onCheck(CheckCollisions::Request& request, CheckCollisions::Response& response) {
  try {
    check(request, response);
    response.success = true;
  } catch (const std::exception& error) {
    response.success = false;
    response.message = error.what();
  }
  return true;  // false would hide the message from the caller
}

void QueryService::check(const CheckCollisions::Request& request,
                         CheckCollisions::Response& response) {
  const Defaults defaults = defaults_();
  const ActiveScenePtr active_scene = sceneFor(request, scenes_);
  const ActiveScene& active = *active_scene;
  const auto& scene = active.scene;
  const CheckSettings settings = settingsFor(request, defaults.settings);
  const ros::WallTime start = ros::WallTime::now();
  StampedPoses stamped = posesAt(active, request.stamp, defaults.max_transform_age);
  if (!request.joint_state.name.empty() || !request.joint_state.position.empty()) {
    const JointQuery query(request.joint_state.name, *scene, tf_buffer_, active.frame,
                           stamped.stamp);
    query.posesAt(request.joint_state.position, stamped.poses);
    stamped.problem.clear();
    response.joints_from_tf = query.jointsFromTf();
    response.joints_at_zero = query.jointsAtZero();
  } else if (stamped.nb_asked > 0 && stamped.nb_found == 0) {
    throw InputError("no transform is known: " + stamped.problem);
  }
  const double transform_time = (ros::WallTime::now() - start).toSec();

  const CollisionReport& report = detectorFor(scene).detect(stamped.poses, settings);
  const ros::Time stamp = stamped.stamp.isZero() ? ros::Time::now() : stamped.stamp;
  response.result = toMessage(report, *scene, settings, active.frame, stamp, active.broken_links);
  response.result.time_transforms = transform_time;
  response.result.time_total += transform_time;
  if (scene->models().empty()) response.message = "there is no pair to check";
  if (!stamped.problem.empty()) response.message = "left out, no transform: " + stamped.problem;
}

bool QueryService::onCheckTrajectory(CheckTrajectory::Request& request,
                                     CheckTrajectory::Response& response) {
  try {
    const Defaults defaults = defaults_();
    const ActiveScenePtr active_scene = sceneFor(request, scenes_);
    const ActiveScene& active = *active_scene;
    const auto& scene = active.scene;
    if (!batch_ || &batch_->scene() != scene.get()) batch_ = std::make_unique<BatchCheck>(scene);
    const ros::Time stamp = posesAt(active, request.stamp, defaults.max_transform_age).stamp;
    const JointQuery query(request.trajectory.joint_names, *scene, tf_buffer_, active.frame, stamp);
    checkTrajectory(request, query, settingsFor(request, defaults.settings), active.broken_links,
                    active.frame, stamp, *batch_, response);
    response.success = true;
  } catch (const std::exception& error) {
    response = CheckTrajectory::Response();
    response.message = error.what();
  }
  return true;
}

}  // namespace collision_pairs
