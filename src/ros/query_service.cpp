#include "query_service.h"

#include <algorithm>
#include <optional>

#include "collision_pairs/distance_gradient.h"
#include "conversions.h"
#include "joint_limits.h"
#include "joint_query.h"
#include "tf_check.h"

namespace collision_pairs {
namespace {

constexpr std::size_t KEPT_DETECTORS = 2;

/// A reply without a result has the verdict UNKNOWN.
void refuse(const std::string& why, CheckCollisions::Response& response) {
  response.success = false;
  response.message = why;
  response.result = unknown(why, "", ros::Time::now());
}

void refuseGradientOfNothing(const CheckCollisions::Request& request) {
  if (!request.gradient) return;
  if (request.joint_state.name.empty()) {
    throw InputError("gradient needs a joint_state, whose joints it refers to");
  }
  if (request.verdict_only)
    throw InputError("gradient needs distances and cannot be combined with verdict_only");
}

/// `result`: the message of the report.
void addGradients(const CollisionReport& report, const CollisionScene& scene,
                  const JointColumns& joints, const std::vector<Eigen::Isometry3d>& X_WB,
                  CollisionPairs& result) {
  DistanceGradient gradient(scene, joints);
  for (std::size_t i = 0; i < report.pairs.size(); ++i) {
    auto& numbers = result.pairs[i].gradient;
    numbers.resize(joints.size());
    if (!gradient.compute(report.pairs[i], report, X_WB, numbers.data())) numbers.clear();
  }
}

}  // namespace

QueryService::QueryService(const ros::NodeHandle& private_node, TransformInput& transforms,
                           SceneStore& scenes, std::function<CheckSettings()> defaults)
    : transforms_(transforms),
      scenes_(scenes),
      defaults_(std::move(defaults)),
      spinner_(1, &queue_) {
  ros::NodeHandle node(private_node);
  node.setCallbackQueue(&queue_);
  server_ = node.advertiseService("check_collisions", &QueryService::onCheck, this);
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
    refuse(error.what(), response);
  }
  return true;  // false would hide the message from the caller
}

void QueryService::check(const CheckCollisions::Request& request,
                         CheckCollisions::Response& response) {
  const ActiveScenePtr active_scene = sceneFor(request, scenes_);
  const ActiveScene& active = *active_scene;
  const auto& scene = active.scene;
  CheckSettings settings = settingsFor(request, defaults_());
  refuseGradientOfNothing(request);
  if (request.gradient) settings.tolerance = 0.0;  // a gradient needs the exact distance
  const ros::WallTime start = ros::WallTime::now();
  const ros::Time now = transforms_.followClock();
  StampedPoses stamped = posesAt(active, request.stamp, now);
  std::vector<std::string> doubts, limits_left;
  std::optional<JointQuery> query;
  std::vector<Eigen::Isometry3d> X_WB;
  if (!request.joint_state.name.empty() || !request.joint_state.position.empty()) {
    query.emplace(request.joint_state.name, *scene,
                  JointQueryTf{transforms_, active.frame, stamped.stamp, now,
                               active.tf_poses->heldAt(stamped.stamp)});
    query->bodyPosesAt(request.joint_state.position, X_WB);
    scene->gatherPoses(X_WB, stamped.poses);
    doubts = query->doubts();
    limits_left = outsideLimits({query->jointPositionsAt(request.joint_state.position)},
                                scene->robot(), "state");
    response.joints_from_tf = query->jointsFromTf();
    response.joints_at_zero = query->jointsAtZero();
  } else {
    doubts = doubtsOf(stamped, transforms_, now);
    if (stamped.nb_asked > 0 && stamped.nb_found == 0) {
      throw InputError("no transform is known: " + doubts.front());
    }
  }
  for (std::string& doubt : addVoxels(active, request.stamp, now, stamped.poses)) {
    doubts.push_back(std::move(doubt));
  }
  const double transform_time = (ros::WallTime::now() - start).toSec();

  CollisionDetector& detector = detectorFor(scene);
  response.result = checkPoses(active, stamped, doubts, settings, now, transform_time, detector);
  if (!query) addClosingMotion(active, stamped, detector.report(), response.result);
  if (request.gradient) {
    addGradients(detector.report(), *scene, query->columns(), X_WB, response.result);
  }
  response.message = scene->unchecked();
  if (!doubts.empty() && response.message.empty()) response.message = doubts.front();
  for (const std::string& sentence : limits_left) {
    response.message += (response.message.empty() ? "" : "; ") + sentence;
  }
}

}  // namespace collision_pairs
