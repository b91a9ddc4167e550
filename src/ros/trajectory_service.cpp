#include "trajectory_service.h"

#include <mutex>
#include <set>

#include "collision_pairs/motion_check.h"
#include "conversions.h"
#include "joint_limits.h"
#include "joint_query.h"
#include "low_priority.h"

namespace collision_pairs {
namespace {

/// A parsed request.
struct Asked {
  const CheckTrajectory::Request& request;
  const ActiveScene& active;
  const JointQuery& query;
  const CheckSettings& settings;
  ros::Time stamp;
  std::vector<std::string> doubts;  ///< why no point can be FREE
  /// The voxels of the scene's clouds, the same for all points.
  CloudVoxels voxels;
};

using Reasons = std::set<std::string>;

/// posesAt() or jointPositionsAt() of a point; adds the point to errors.
template <class Ask>
auto ofPoint(std::size_t i, const Asked& asked, const Ask& ask) {
  try {
    return ask(asked.request.trajectory.points[i].positions);
  } catch (const InputError& error) {
    throw InputError("point " + std::to_string(i) + ": " + error.what());
  }
}

/// All reasons why a report cannot be FREE.
std::vector<std::string> allDoubts(const Asked& asked, const CollisionReport& report) {
  std::vector<std::string> doubts = asked.doubts;
  for (std::string& why : whyUnknown(report, *asked.active.scene, asked.active.broken_links)) {
    doubts.push_back(std::move(why));
  }
  return doubts;
}

/// COLLISION is certain in spite of doubts; records them if they make the verdict UNKNOWN.
std::uint8_t verdictWith(const std::vector<std::string>& doubts, Verdict verdict,
                         Reasons& reasons) {
  if (verdict == Verdict::COLLISION) return CollisionPairs::COLLISION;
  if (verdict == Verdict::FREE && doubts.empty()) return CollisionPairs::FREE;
  reasons.insert(doubts.begin(), doubts.end());
  return CollisionPairs::UNKNOWN;
}

void checkPoints(BatchCheck& batch, const Asked& asked, CheckTrajectory::Response& response,
                 Reasons& reasons) {
  const auto& active = asked.active;
  const std::size_t nb_points = asked.request.trajectory.points.size();
  response.verdict.resize(nb_points);
  response.in_collision.resize(nb_points);
  response.min_distance.resize(nb_points);
  if (asked.request.want_reports) response.reports.resize(nb_points);
  std::mutex mutex;  // guards `reasons`
  batch.run(
      nb_points, asked.settings,
      [&](std::size_t i, BodyPoses& poses) {
        ofPoint(i, asked, [&](const auto& positions) { asked.query.posesAt(positions, poses); });
        poses.voxels = asked.voxels;
      },
      [&](std::size_t i, const CollisionReport& report) {
        const std::vector<std::string> doubts = allDoubts(asked, report);
        response.min_distance[i] = report.min_distance;
        if (asked.request.want_reports) {
          response.reports[i] = toMessage(report, *active.scene, asked.settings, active.frame,
                                          asked.stamp, active.broken_links);
          notFree(response.reports[i], asked.doubts);
        }
        const std::lock_guard<std::mutex> lock(mutex);
        response.verdict[i] = verdictWith(doubts, report.verdict, reasons);
        response.in_collision[i] = response.verdict[i] != CollisionPairs::FREE;
      });
}

/// The positions of all joints for each point.
std::vector<std::vector<double>> waypointsOf(const Asked& asked) {
  std::vector<std::vector<double>> waypoints;
  for (std::size_t i = 0; i < asked.request.trajectory.points.size(); ++i) {
    waypoints.push_back(ofPoint(
        i, asked, [&](const auto& positions) { return asked.query.jointPositionsAt(positions); }));
  }
  return waypoints;
}

void checkBetween(const Asked& asked, const std::vector<std::vector<double>>& waypoints,
                  CheckTrajectory::Response& response, Reasons& reasons) {
  const auto& active = asked.active;
  MotionSettings settings;
  settings.fidelity = asked.settings.fidelity;
  settings.from_start = true;
  SegmentOptions options;
  options.placed = asked.query.placedBodies();
  options.voxels = asked.voxels;
  const std::vector<std::string> doubts = allDoubts(asked, {});
  for (const MotionReport& report : checkSegments(active.scene, waypoints, settings, options)) {
    const std::uint8_t verdict = verdictWith(doubts, report.verdict, reasons);
    response.segment_verdict.push_back(verdict);
    response.contact_at.push_back(report.contact_at);
    response.free_until.push_back(doubts.empty() ? report.free_until : 0.0);
    response.clearance.push_back(verdict == CollisionPairs::FREE ? report.clearance : 0.0);
    if (report.verdict != Verdict::UNKNOWN) continue;
    for (const auto& [first, second] : report.pairs) {
      const auto& models = active.scene->models();
      reasons.insert("motions that could not be certified: " + models[first].name + '|' +
                     models[second].name);
    }
  }
}

}  // namespace

TrajectoryService::TrajectoryService(const ros::NodeHandle& private_node,
                                     TransformInput& transforms, SceneStore& scenes,
                                     std::function<CheckSettings()> defaults)
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
  const ActiveScenePtr active = sceneFor(request, scenes_);
  const auto& scene = active->scene;
  CheckSettings settings = settingsFor(request, defaults_());
  settings.list_boxes = request.want_reports;
  if (!batch_ || &batch_->scene() != scene.get()) batch_ = std::make_unique<BatchCheck>(scene);
  const ros::Time now = transforms_.followClock();
  const ros::Time stamp = posesAt(*active, request.stamp, now).stamp;
  const JointQuery query(request.trajectory.joint_names, *scene,
                         {transforms_, active->frame, stamp, now, active->tf_poses->heldAt(stamp)});
  if (request.trajectory.points.empty()) throw InputError("the trajectory has no points");
  response.joints_from_tf = query.jointsFromTf();
  response.joints_at_zero = query.jointsAtZero();

  BodyPoses clouds;
  Asked asked{
      request, *active, query, settings, stamp, addVoxels(*active, request.stamp, now, clouds), {}};
  asked.voxels = std::move(clouds.voxels);
  asked.doubts.insert(asked.doubts.end(), query.doubts().begin(), query.doubts().end());
  Reasons reasons;
  checkPoints(*batch_, asked, response, reasons);
  const auto waypoints = waypointsOf(asked);
  if (request.between) checkBetween(asked, waypoints, response, reasons);
  response.message = scene->unchecked();
  for (const std::string& sentence : outsideLimits(waypoints, scene->robot(), "point")) {
    response.message += (response.message.empty() ? "" : "; ") + sentence;
  }
  response.unknown_because.assign(reasons.begin(), reasons.end());
}

}  // namespace collision_pairs
