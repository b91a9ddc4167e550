#include "collision_pairs_node.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <std_msgs/Bool.h>
#include <visualization_msgs/MarkerArray.h>

#include "collision_pairs/input_error.h"
#include "conversions.h"
#include "markers.h"
#include "scene_markers.h"

namespace collision_pairs {
namespace {

constexpr double LOAD_PERIOD = 2.0;    // s between attempts to find a robot_description
constexpr double OLD_TRANSFORM = 1.0;  // s: older transforms are worth a warning
constexpr double WARN_PERIOD = 5.0;    // s between repeated warnings on the log
// s that rviz has to learn the frames: it would mark what comes before as an error, and never again
// look at it.
constexpr double SUBSCRIBER_WARM_UP = 1.0;

double secondsSince(const ros::WallTime& start) { return (ros::WallTime::now() - start).toSec(); }

}  // namespace

CollisionPairsNode::CollisionPairsNode(ros::NodeHandle node, ros::NodeHandle private_node)
    : node_(node),
      private_node_(private_node),
      parameters_(NodeParameters::read(private_node)),
      tf_listener_(tf_buffer_),
      scenes_(private_node, tf_buffer_, parameters_),
      diagnostics_(node, private_node),
      updates_(private_node, scenes_),
      queries_(private_node, tf_buffer_, scenes_, [this] { return queryDefaults(); }) {
  pairs_publisher_ = private_node_.advertise<CollisionPairs>("collision_pairs", 1);
  in_collision_publisher_ = private_node_.advertise<std_msgs::Bool>("in_collision", 1);
  markers_publisher_ = private_node_.advertise<visualization_msgs::MarkerArray>("markers", 1);
  scene_publisher_ = private_node_.advertise<visualization_msgs::MarkerArray>(
      "scene_markers", 1, [this](const ros::SingleSubscriberPublisher&) {
        updates_.release(std::exchange(shown_scene_, nullptr));
        show_scene_from_ = ros::SteadyTime::now() + ros::WallDuration(SUBSCRIBER_WARM_UP);
      });
  reset_service_ = private_node_.advertiseService("reset", &CollisionPairsNode::onReset, this);

  diagnostics_.setHardwareID("none");
  diagnostics_.add("collision check", [this](auto& status) { diagnose(status); });
  reconfigure_server_ =
      std::make_unique<dynamic_reconfigure::Server<CollisionPairsConfig>>(private_node_);
  reconfigure_server_->setCallback(
      [this](CollisionPairsConfig& config, std::uint32_t) { reconfigure(config); });
}

// A loop of our own, and no ROS timers: nothing but this thread decides when a cycle is due.
void CollisionPairsNode::run() {
  ros::SteadyTime next_diagnosis;
  while (ros::ok()) {
    const ros::WallDuration wait = std::min(next_cycle_, next_diagnosis) - ros::SteadyTime::now();
    ros::getGlobalCallbackQueue()->callAvailable(std::max(wait, ros::WallDuration(0.0)));
    const ros::SteadyTime now = ros::SteadyTime::now();
    if (now >= next_cycle_) {
      cycle();
      // Cycles that were missed are not made up for.
      next_cycle_ = std::max(next_cycle_ + ros::WallDuration(1.0 / parameters_.rate), now);
    }
    if (now >= next_diagnosis) {
      diagnostics_.force_update();
      next_diagnosis = now + ros::WallDuration(1.0);
    }
  }
}

bool CollisionPairsNode::loadScene(std::string& problem) {
  try {
    scenes_.load();
    return true;
  } catch (const std::exception& error) {
    problem = error.what();
    return false;
  }
}

CheckSettings CollisionPairsNode::settings() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return parameters_.check;
}

QueryService::Defaults CollisionPairsNode::queryDefaults() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return {parameters_.check, parameters_.max_transform_age};
}

void CollisionPairsNode::cycle() {
  try {
    const ros::WallTime start = ros::WallTime::now();
    ActiveScenePtr scene = scenes_.active();
    if (!scene) {
      if (start < next_load_) return;
      next_load_ = start + ros::WallDuration(LOAD_PERIOD);
      if (!loadScene(health_.problem)) {
        ROS_ERROR_STREAM_THROTTLE(WARN_PERIOD, health_.problem);
        return;
      }
      scene = scenes_.active();
    }
    if (scene != reported_scene_) takeScene(scene);
    const StampedPoses stamped = freshPoses(*scene->tf_poses);
    const double transform_time = secondsSince(start);
    // What only static transforms describe is as good now as ever.
    const ros::Time stamp = stamped.stamp.isZero() ? ros::Time::now() : stamped.stamp;
    detector_->detect(stamped.poses, settings());
    publish(*scene, stamped, stamp, transform_time);
    publishSceneMarkers(stamped.nb_found);
    health_.cycle_time = secondsSince(start);
    if (health_.cycle_time > 1.0 / parameters_.rate) ++health_.overruns;
  } catch (const std::exception& error) {
    health_.problem = std::string("the cycle failed: ") + error.what();
    ROS_ERROR_STREAM_THROTTLE(WARN_PERIOD, health_.problem);
  }
}

void CollisionPairsNode::takeScene(const ActiveScenePtr& scene) {
  auto detector = std::make_unique<CollisionDetector>(scene->scene);
  updates_.release(std::exchange(detector_, std::move(detector)));
  updates_.release(std::exchange(reported_scene_, scene));
}

StampedPoses CollisionPairsNode::freshPoses(const TfPoses& tf_poses) {
  const ros::Time now = ros::Time::now();
  const ros::WallTime wall_now = ros::WallTime::now();
  if (clock_watch_.wentBack(now, wall_now)) {
    ROS_INFO_STREAM("the clock went back to " << now << " s: starting afresh");
    tf_buffer_.clear();  // static transforms stay
  }
  StampedPoses stamped = tf_poses.latest(parameters_.max_transform_age);
  if (!clock_watch_.isLeftOver(stamped.stamp, now, wall_now)) return stamped;
  tf_buffer_.clear();
  return tf_poses.latest(parameters_.max_transform_age);
}

void CollisionPairsNode::publish(const ActiveScene& scene, const StampedPoses& stamped,
                                 const ros::Time& stamp, double transform_time) {
  CollisionPairs message = toMessage(detector_->report(), *scene.scene, settings(), scene.frame,
                                     stamp, scene.broken_links);
  message.time_transforms = transform_time;
  message.time_total += transform_time;
  pairs_publisher_.publish(message);
  std_msgs::Bool verdict;
  verdict.data = message.in_collision;
  in_collision_publisher_.publish(verdict);
  reported_stamp_ = stamp;
  publishMarkers();
  noteHealth(message, stamped.problem);
}

void CollisionPairsNode::publishMarkers() {
  if (!reported_scene_ || markers_publisher_.getNumSubscribers() == 0) return;
  markers_publisher_.publish(toMarkers(detector_->report(),
                                       parameters_.show_only_investigated_boxes,
                                       reported_scene_->frame, reported_stamp_));
}

// Only when the scene is another, somebody new looks at it, or TF has come to know more of it: rviz
// moves what moves.
void CollisionPairsNode::publishSceneMarkers(std::size_t nb_known) {
  if (shown_scene_ == reported_scene_ && nb_known <= nb_shown_) return;
  if (scene_publisher_.getNumSubscribers() == 0) return;
  if (ros::SteadyTime::now() < show_scene_from_) return;
  updates_.release(std::exchange(shown_scene_, reported_scene_));
  nb_shown_ = nb_known;
  scene_publisher_.publish(
      toSceneMarkers(*shown_scene_->scene, settings().fidelity, shown_scene_->frame));
}

void CollisionPairsNode::noteHealth(const CollisionPairs& message, const std::string& problem) {
  if (!problem.empty())
    ROS_WARN_STREAM_THROTTLE(WARN_PERIOD, "left out, no transform: " << problem);
  health_.problem.clear();
  health_.transform_age = (ros::Time::now() - message.header.stamp).toSec();
  health_.left_out = message.left_out;
  health_.nb_boxes = message.nb_boxes;
  health_.nb_pairs = message.nb_pairs;
  health_.nb_degraded = message.nb_degraded;
  if (message.budget_spent) ++health_.out_of_time;
  health_.nb_unresolved = static_cast<std::uint32_t>(
      std::count_if(message.pairs.begin(), message.pairs.end(),
                    [](const CollisionPair& p) { return p.state == CollisionPair::UNRESOLVED; }));
  ++health_.cycles;
}

void CollisionPairsNode::diagnose(diagnostic_updater::DiagnosticStatusWrapper& status) const {
  using diagnostic_msgs::DiagnosticStatus;
  if (!health_.problem.empty()) {
    status.summary(DiagnosticStatus::ERROR, health_.problem);
    return;
  }
  status.summary(DiagnosticStatus::OK, "checking");
  if (health_.transform_age > OLD_TRANSFORM) {
    status.mergeSummary(DiagnosticStatus::WARN, "the transforms are old");
  }
  if (!health_.left_out.empty()) status.mergeSummary(DiagnosticStatus::WARN, "links are left out");
  if (health_.nb_unresolved > 0) status.mergeSummary(DiagnosticStatus::WARN, "unresolved pairs");
  std::string left_out;
  for (const std::string& link : health_.left_out) left_out += link + " ";
  status.add("transform age [s]", health_.transform_age);
  status.add("cycle time [s]", health_.cycle_time);
  status.add("cycles", health_.cycles);
  status.add("overruns", health_.overruns);
  status.add("cycles out of time", health_.out_of_time);
  status.add("times the clock went back", clock_watch_.nbJumps());
  status.add("links left out", left_out);
  status.add("nb_boxes", health_.nb_boxes);
  status.add("nb_pairs", health_.nb_pairs);
  status.add("degraded pairs", health_.nb_degraded);
  status.add("unresolved pairs", health_.nb_unresolved);
}

void CollisionPairsNode::reconfigure(CollisionPairsConfig& config) {
  try {
    if (!std::isfinite(config.alarm_distance)) throw InputError("alarm_distance is not finite");
    if (!std::isfinite(config.time_budget)) throw InputError("time_budget is not finite");
    if (!std::isfinite(config.rate)) throw InputError("rate is not finite");
    const Fidelity fidelity = parseFidelity(config.fidelity);
    const std::lock_guard<std::mutex> lock(mutex_);
    parameters_.check.alarm_distance = config.alarm_distance;
    if (fidelity != parameters_.check.fidelity) shown_scene_.reset();  // it looks different now
    parameters_.check.fidelity = fidelity;
    parameters_.check.time_budget = config.time_budget;
    parameters_.rate = config.rate;
    parameters_.show_only_investigated_boxes = config.show_only_investigated_boxes;
  } catch (const InputError& error) {
    ROS_ERROR_STREAM("reconfigure: " << error.what() << "; nothing is changed");
    config.alarm_distance = parameters_.check.alarm_distance;
    config.fidelity = fidelityName(parameters_.check.fidelity);
    config.time_budget = parameters_.check.time_budget;
    config.rate = parameters_.rate;
    config.show_only_investigated_boxes = parameters_.show_only_investigated_boxes;
    return;
  }
  next_cycle_ = ros::SteadyTime::now();  // the rate, too, is another from now on
  publishMarkers();                      // boxes that are to be hidden go at once
}

bool CollisionPairsNode::onReset(std_srvs::Trigger::Request&,
                                 std_srvs::Trigger::Response& response) {
  std::string problem;
  response.success = loadScene(problem);
  response.message =
      response.success ? "the robot was read anew" : "the old scene stays: " + problem;
  return true;
}

}  // namespace collision_pairs
