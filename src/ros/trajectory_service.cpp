#include "trajectory_service.h"

#include <mutex>
#include <set>

#include "conversions.h"
#include "joint_query.h"
#include "low_priority.h"

namespace collision_pairs {

TrajectoryService::TrajectoryService(const ros::NodeHandle& private_node,
                                     TransformInput& transforms, SceneStore& scenes,
                                     std::function<QueryDefaults()> defaults)
    : transforms_(transforms),
      scenes_(scenes),
      defaults_(std::move(defaults)),
      spinner_(1, &queue_) {
  ros::NodeHandle node(private_node);
  node.setCallbackQueue(&queue_);
  server_ = node.advertiseService("check_trajectory", &TrajectoryService::onCheck, this);
  spinner_.start();
}

bool TrajectoryService::onCheck(CheckTrajectory::Request& request,
                                CheckTrajectory::Response& response) {
  lowerThreadPriority();
  try {
    check(request, response);
    response.success = true;
  } catch (const std::exception& error) {
    response = CheckTrajectory::Response();
    response.message = error.what();
  }
  return true;  // false would hide the message from the caller
}

void TrajectoryService::check(const CheckTrajectory::Request& request,
                              CheckTrajectory::Response& response) {
  const QueryDefaults defaults = defaults_();
  const ActiveScenePtr active_scene = sceneFor(request, scenes_);
  const ActiveScene& active = *active_scene;
  const auto& scene = active.scene;
  const CheckSettings settings = settingsFor(request, defaults.settings);
  if (!batch_ || &batch_->scene() != scene.get()) batch_ = std::make_unique<BatchCheck>(scene);
  const ros::Time now = ros::Time::now();
  transforms_.followClock(now);
  const ros::Time stamp = posesAt(active, request.stamp, now, defaults.limits).stamp;
  const JointQuery query(request.trajectory.joint_names, *scene,
                         {transforms_, active.frame, stamp, now, defaults.limits.max_pose_age});
  response.joints_from_tf = query.jointsFromTf();
  response.joints_at_zero = query.jointsAtZero();

  std::vector<std::string> known_doubts = active.doubts;
  known_doubts.insert(known_doubts.end(), query.doubts().begin(), query.doubts().end());
  const auto& points = request.trajectory.points;
  if (points.empty()) throw InputError("the trajectory has no points");
  response.verdict.resize(points.size());
  response.in_collision.resize(points.size());
  response.min_distance.resize(points.size());
  if (request.want_reports) response.reports.resize(points.size());
  std::mutex mutex;  // guards `reasons`
  std::set<std::string> reasons;
  batch_->run(
      points.size(), settings,
      [&](std::size_t i, BodyPoses& poses) {
        try {
          query.posesAt(points[i].positions, poses);
        } catch (const InputError& error) {
          throw InputError("point " + std::to_string(i) + ": " + error.what());
        }
      },
      [&](std::size_t i, const CollisionReport& report) {
        std::vector<std::string> doubts = known_doubts;
        for (std::string& why : whyUnknown(report, *scene, active.broken_links)) {
          doubts.push_back(std::move(why));
        }
        const bool is_free = report.verdict == Verdict::FREE && doubts.empty();
        const bool is_contact = report.verdict == Verdict::COLLISION;
        response.verdict[i] = is_contact ? CollisionPairs::COLLISION
                              : is_free  ? CollisionPairs::FREE
                                         : CollisionPairs::UNKNOWN;
        response.in_collision[i] = !is_free;
        response.min_distance[i] = report.min_distance;
        if (request.want_reports) {
          response.reports[i] =
              toMessage(report, *scene, settings, active.frame, stamp, active.broken_links);
          notFree(response.reports[i], known_doubts);
        }
        if (is_free || is_contact) return;
        const std::lock_guard<std::mutex> lock(mutex);
        reasons.insert(doubts.begin(), doubts.end());
      });
  response.unknown_because.assign(reasons.begin(), reasons.end());
}

}  // namespace collision_pairs
