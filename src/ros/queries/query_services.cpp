#include "query_services.h"

#include <algorithm>
#include <mutex>
#include <set>

#include "collision_pairs/distance_gradient.h"
#include "collision_pairs/motion_check.h"
#include "conversions.h"
#include "joint_limits.h"
#include "snapshot_check.h"
#include "thread_priority.h"
#include "user_text.h"

namespace collision_pairs {
namespace {

constexpr std::size_t KEPT_DETECTORS = 2;

/// Those that are not empty.
std::string joinedSentences(std::vector<std::string> sentences) {
  sentences.erase(std::remove(sentences.begin(), sentences.end(), ""), sentences.end());
  return joined(sentences, "; ");
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

using Reasons = std::set<std::string>;

/// What was asked about, and all that is known of it.
struct Asked {
  const CheckTrajectory::Request& request;
  const Snapshot& snapshot;
  const CheckSettings& settings;
};

/// Who names no joint and gives no position, but another number, does not mean the present state.
void requirePositions(const std::vector<std::string>& names, const std::vector<double>& positions,
                      const std::vector<const std::vector<double>*>& others,
                      const std::string& what) {
  const auto isEmpty = [](const std::vector<double>* numbers) { return numbers->empty(); };
  if (!names.empty() || !positions.empty()) return;
  if (std::all_of(others.begin(), others.end(), isEmpty)) return;
  throw InputError(what + ", but no names and positions");
}

/// Calls ask(positions) of a point; adds the point to errors.
template <class Ask>
auto ofPoint(std::size_t i, const Asked& asked, const Ask& ask) {
  try {
    return ask(asked.request.trajectory.points[i].positions);
  } catch (const InputError& error) {
    throw InputError("point " + std::to_string(i) + ": " + error.what());
  }
}

void checkPoints(BatchCheck& batch, const Asked& asked, CheckTrajectory::Response& response,
                 Reasons& reasons) {
  const Snapshot& snapshot = asked.snapshot;
  const std::size_t nb_points = asked.request.trajectory.points.size();
  response.verdict.resize(nb_points);
  response.in_collision.resize(nb_points);
  response.min_distance.resize(nb_points);
  if (asked.request.want_reports) response.reports.resize(nb_points);
  std::mutex mutex;  // guards `reasons`
  batch.run(
      nb_points, asked.settings,
      [&](std::size_t i, BodyPoses& poses) {
        ofPoint(i, asked,
                [&](const auto& positions) { snapshot.joints->posesAt(positions, poses); });
        poses.voxels = snapshot.poses.voxels;
        poses.unknown_because = snapshot.poses.unknown_because;
      },
      [&](std::size_t i, const CollisionReport& report) {
        response.verdict[i] = static_cast<std::uint8_t>(report.verdict);
        response.in_collision[i] = report.in_collision;
        response.min_distance[i] = report.min_distance;
        if (asked.request.want_reports) {
          response.reports[i] = toMessage(report, snapshot, asked.settings);
        }
        const std::lock_guard<std::mutex> lock(mutex);
        reasons.insert(report.unknown_because.begin(), report.unknown_because.end());
      });
}

/// The positions of all joints for each point.
std::vector<std::vector<double>> waypointsOf(const Asked& asked) {
  std::vector<std::vector<double>> waypoints;
  for (std::size_t i = 0; i < asked.request.trajectory.points.size(); ++i) {
    waypoints.push_back(ofPoint(i, asked, [&](const auto& positions) {
      return asked.snapshot.joints->jointPositionsAt(positions);
    }));
  }
  return waypoints;
}

void checkBetween(const Asked& asked, const std::vector<std::vector<double>>& waypoints,
                  CheckTrajectory::Response& response, Reasons& reasons) {
  MotionSettings settings;
  settings.fidelity = asked.settings.fidelity;
  settings.from_start = true;
  SegmentOptions options;
  options.placed = asked.snapshot.joints->placedBodies();
  options.voxels = asked.snapshot.poses.voxels;
  options.unknown_because = asked.snapshot.poses.unknown_because;
  const auto& scene = asked.snapshot.scene->scene;
  for (const MotionReport& report : checkSegments(scene, waypoints, settings, options)) {
    response.segment_verdict.push_back(static_cast<std::uint8_t>(report.verdict));
    response.contact_at.push_back(report.contact_at);
    response.free_until.push_back(report.free_until);
    response.clearance.push_back(report.clearance);
    reasons.insert(report.unknown_because.begin(), report.unknown_because.end());
  }
}

}  // namespace

QueryService::QueryService(const ros::NodeHandle& private_node, const QueryContext& context)
    : context_(context), spinner_(1, &queue_) {
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
    response.message = error.what();
    response.result = unknown(error.what(), "", ros::Time::now());
  }
  return true;  // false would hide the message from the caller
}

void QueryService::check(const CheckCollisions::Request& request,
                         CheckCollisions::Response& response) {
  CheckSettings settings = settingsFor(request, context_.defaults());
  refuseGradientOfNothing(request);
  if (request.gradient) settings.tolerance = 0.0;  // a gradient needs the exact distance
  const auto& names = request.joint_state.name;
  const auto& positions = request.joint_state.position;
  const bool has_joints = !names.empty() || !positions.empty();
  requirePositions(names, positions, {&request.joint_state.velocity, &request.joint_state.effort},
                   "joint_state has velocities or efforts");
  ros::WallTime start;
  Snapshot snapshot = context_.scenes.snapshot(
      {request.group, request.links}, [&](const Monitor& monitor, const ActiveScenePtr& scene) {
        start = ros::WallTime::now();
        return has_joints ? monitor.withJoints(scene, names, request.stamp)
                          : monitor.at(scene, request.stamp);
      });
  const CollisionScene& scene = *snapshot.scene->scene;
  std::vector<Eigen::Isometry3d> X_WB;
  std::vector<std::string> sentences;
  if (has_joints) {
    const JointQuery& joints = *snapshot.joints;
    joints.bodyPosesAt(positions, X_WB);
    scene.gatherPoses(X_WB, snapshot.poses);
    sentences = outsideLimits({joints.jointPositionsAt(positions)}, scene.robot(), "state");
    response.joints_from_tf = joints.jointsFromTf();
    response.joints_at_zero = joints.jointsAtZero();
  } else if (!snapshot.isKnown()) {
    const bool has_clock = !contains(snapshot.poses.unknown_because, NO_CLOCK);
    throw InputError("no transform is known: " + (has_clock ? snapshot.first_left_out : NO_CLOCK));
  }
  const double transform_time = (ros::WallTime::now() - start).toSec();
  CollisionDetector& detector = detectorFor(snapshot.scene->scene);
  response.result = checkedMessage(context_.monitor, snapshot, settings, transform_time, detector);
  if (request.gradient) {
    addGradients(detector.report(), scene, snapshot.joints->columns(), X_WB, response.result);
  }
  const auto& reasons = snapshot.poses.unknown_because;
  const bool is_first_told = scene.unchecked().empty() && !reasons.empty();
  sentences.insert(sentences.begin(), is_first_told ? reasons.front() : scene.unchecked());
  response.message = joinedSentences(sentences);
}

TrajectoryService::TrajectoryService(const ros::NodeHandle& private_node,
                                     const QueryContext& context)
    : context_(context), spinner_(1, &queue_) {
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
  CheckSettings settings = settingsFor(request, context_.defaults());
  settings.list_boxes = request.want_reports;
  const Snapshot snapshot = context_.scenes.snapshot(
      {request.group, request.links}, [&](const Monitor& monitor, const ActiveScenePtr& active) {
        return monitor.withJoints(active, request.trajectory.joint_names, request.stamp);
      });
  const auto& scene = snapshot.scene->scene;
  if (!batch_ || &batch_->scene() != scene.get()) batch_ = std::make_unique<BatchCheck>(scene);
  if (request.trajectory.points.empty()) throw InputError("the trajectory has no points");
  for (const auto& point : request.trajectory.points) {
    requirePositions(request.trajectory.joint_names, point.positions,
                     {&point.velocities, &point.accelerations, &point.effort},
                     "the trajectory has velocities, accelerations or efforts");
    if (request.trajectory.joint_names.empty() && !point.time_from_start.isZero()) {
      throw InputError("the trajectory has times, but no joint_names");
    }
  }
  response.joints_from_tf = snapshot.joints->jointsFromTf();
  response.joints_at_zero = snapshot.joints->jointsAtZero();
  const Asked asked{request, snapshot, settings};
  Reasons reasons;
  checkPoints(*batch_, asked, response, reasons);
  const auto waypoints = waypointsOf(asked);
  if (request.between) checkBetween(asked, waypoints, response, reasons);
  std::vector<std::string> sentences = outsideLimits(waypoints, scene->robot(), "point");
  sentences.insert(sentences.begin(), scene->unchecked());
  response.message = joinedSentences(sentences);
  response.unknown_because.assign(reasons.begin(), reasons.end());
}

}  // namespace collision_pairs
