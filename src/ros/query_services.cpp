#include "query_services.h"

#include <algorithm>
#include <mutex>
#include <optional>
#include <set>

#include "collision_pairs/distance_gradient.h"
#include "collision_pairs/motion_check.h"
#include "conversions.h"
#include "joint_limits.h"
#include "joint_query.h"
#include "low_priority.h"
#include "tf_check.h"

namespace collision_pairs {
namespace {

constexpr std::size_t KEPT_DETECTORS = 2;

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
  const ActiveScenePtr active_scene = sceneFor(request, context_.scenes);
  const ActiveScene& active = *active_scene;
  const auto& scene = active.scene;
  CheckSettings settings = settingsFor(request, context_.defaults());
  refuseGradientOfNothing(request);
  if (request.gradient) settings.tolerance = 0.0;  // a gradient needs the exact distance
  const ros::WallTime start = ros::WallTime::now();
  const ros::Time now = context_.transforms.followClock();
  StampedPoses stamped = posesAt(active, request.stamp, now);
  std::vector<std::string> doubts, limits_left;
  std::optional<JointQuery> query;
  std::vector<Eigen::Isometry3d> X_WB;
  if (!request.joint_state.name.empty() || !request.joint_state.position.empty()) {
    query.emplace(request.joint_state.name, *scene,
                  JointQueryTf{context_.transforms, active.frame, stamped.stamp, now,
                               active.tf_poses->heldAt(stamped.stamp), active.tf_poses.get()});
    query->bodyPosesAt(request.joint_state.position, X_WB);
    scene->gatherPoses(X_WB, stamped.poses);
    doubts = query->doubts();
    limits_left = outsideLimits({query->jointPositionsAt(request.joint_state.position)},
                                scene->robot(), "state");
    response.joints_from_tf = query->jointsFromTf();
    response.joints_at_zero = query->jointsAtZero();
  } else {
    doubts = doubtsOf(stamped, context_.transforms, now);
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
  const ActiveScenePtr active = sceneFor(request, context_.scenes);
  const auto& scene = active->scene;
  CheckSettings settings = settingsFor(request, context_.defaults());
  settings.list_boxes = request.want_reports;
  if (!batch_ || &batch_->scene() != scene.get()) batch_ = std::make_unique<BatchCheck>(scene);
  const ros::Time now = context_.transforms.followClock();
  const ros::Time stamp = posesAt(*active, request.stamp, now).stamp;
  const JointQuery query(request.trajectory.joint_names, *scene,
                         {context_.transforms, active->frame, stamp, now,
                          active->tf_poses->heldAt(stamp), active->tf_poses.get()});
  if (request.trajectory.points.empty()) throw InputError("the trajectory has no points");
  response.joints_from_tf = query.jointsFromTf();
  response.joints_at_zero = query.jointsAtZero();

  BodyPoses clouds;
  Asked asked{request,
              *active,
              query,
              settings,
              stamp.isZero() ? now : stamp,
              addVoxels(*active, request.stamp, now, clouds),
              {}};
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
