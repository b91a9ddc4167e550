#include "collision_pairs_node.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>
#include <utility>

#include <boost/make_shared.hpp>

#include "collision_pairs/input_error.h"
#include "conversions.h"
#include "snapshot_check.h"

namespace collision_pairs {
namespace {

constexpr double LOWEST_RATE = 0.1;  // Hz; dynamic_reconfigure raises a lower one without a word
constexpr double WARN_PERIOD = 5.0;  // s between repeated warnings in the log
// Frame in which the verdict is drawn while there is no robot and so no frame.
const char* const FRAME_OF_NOTHING = "world";

const ros::WallDuration IDLE_PERIOD(0.05);  // of cycles triggered by transforms, without any

/// Ends the wait for callbacks.
struct WakeUp : ros::CallbackInterface {
  CallResult call() override { return Success; }
};

/// Of what can be reconfigured, but for the fidelity.
template <class Do>
void forEachReconfigured(NodeParameters& parameters, CollisionPairsConfig& config, const Do& act) {
  act(parameters.check.alarm_distance, config.alarm_distance);
  act(parameters.check.tolerance, config.tolerance);
  act(parameters.check.time_budget, config.time_budget);
  act(parameters.check.verdict_only, config.verdict_only);
  act(parameters.check.min_distance, config.min_distance);
  act(parameters.rate, config.rate);
  act(parameters.show_only_investigated_boxes, config.show_only_investigated_boxes);
}

/// What is shown, which can change nothing that was decided.
template <class Draw>
void drawing(const Draw& draw) {
  try {
    draw();
  } catch (const std::exception& error) {
    ROS_ERROR_STREAM_THROTTLE(WARN_PERIOD, "the markers are not drawn: " << error.what());
  }
}

double secondsSince(const ros::WallTime& start) { return (ros::WallTime::now() - start).toSec(); }

}  // namespace

CollisionPairsNode::CollisionPairsNode(ros::NodeHandle node, ros::NodeHandle private_node,
                                       ros::CallbackQueue& queue)
    : queue_(queue),
      private_node_(private_node),
      parameters_(NodeParameters::read(private_node)),
      first_frame_(readFixedFrame(private_node)),
      monitor_(parameters_.pose_limits, parameters_.allow_paused),
      clouds_(node, private_node, monitor_),
      scenes_(node, private_node, monitor_, clouds_),
      scene_service_(private_node, monitor_, scenes_),
      publisher_(
          private_node,
          [this](std::shared_ptr<const void> old) { scene_service_.release(std::move(old)); }),
      diagnostics_(node, private_node, private_node.getNamespace()),
      queries_(private_node, {monitor_, scenes_, [this] { return settings(); }}),
      trajectories_(private_node, {monitor_, scenes_, [this] { return settings(); }}),
      limiter_(node, private_node, {monitor_, scenes_, [this] { return settings(); }},
               parameters_.allow_paused) {
  diagnostics_.setHardwareID("none");
  diagnostics_.add("collision check", [this](auto& status) { health_.diagnose(status); });
  if (limiter_.isWanted()) {
    diagnostics_.add("velocity limiter", [this](auto& status) { limiter_.diagnose(status); });
  }
  reconfigure_server_ =
      std::make_unique<dynamic_reconfigure::Server<CollisionPairsConfig>>(private_node_);
  reconfigure_server_->setCallback(
      [this](CollisionPairsConfig& config, std::uint32_t) { reconfigure(config); });
  std::function<void()> taken;
  if (isTriggeredByTf()) {
    taken = [this] { queue_.addCallback(boost::make_shared<WakeUp>()); };
  }
  monitor_.subscribe(node, taken);
}

// A loop instead of ROS timers, so that only this thread decides when a cycle is due.
void CollisionPairsNode::run() {
  ros::SteadyTime next_diagnosis;
  while (ros::ok() && !stops_) {
    const ros::WallDuration wait = std::min(nextCycle(), next_diagnosis) - ros::SteadyTime::now();
    queue_.callAvailable(std::max(wait, ros::WallDuration(0.0)));
    const ros::SteadyTime now = ros::SteadyTime::now();
    if (now >= nextCycle()) {
      last_cycle_ = now;
      nb_taken_ = monitor_.nbTaken();
      cycle();
      const ros::WallDuration period(1.0 / parameters_.rate);
      // Missed cycles are skipped.
      next_cycle_ = isTriggeredByTf() ? now + period : std::max(next_cycle_ + period, now);
    }
    if (now >= next_diagnosis) {
      monitor_.with([this](const Monitor& monitor) {
        health_.noteTransforms(monitor.transforms().refused(), monitor.transforms().nbClockJumps());
      });
      const bool reload = parameters_.reload == NodeParameters::AUTO;
      health_.noteDescriptions(checked_scene_ ? scene_service_.watchDescriptions(reload) : "");
      diagnoseClouds();
      diagnostics_.force_update();
      next_diagnosis = now + ros::WallDuration(1.0);
    }
  }
}

ros::SteadyTime CollisionPairsNode::nextCycle() const {
  const bool waits = isTriggeredByTf() && monitor_.nbTaken() == nb_taken_;
  return waits ? std::max(next_cycle_, last_cycle_ + IDLE_PERIOD) : next_cycle_;
}

void CollisionPairsNode::diagnoseClouds() {
  const bool has_clouds = checked_scene_ && !clouds_.isEmpty();
  if (has_clouds == diagnoses_clouds_) return;
  diagnoses_clouds_ = has_clouds;
  if (!has_clouds) {
    diagnostics_.removeByName("point clouds");
    return;
  }
  diagnostics_.add("point clouds", [this](auto& status) { clouds_.diagnose(status); });
}

CheckSettings CollisionPairsNode::settings() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return parameters_.check;
}

void CollisionPairsNode::cycle() {
  try {
    const ros::WallTime start = ros::WallTime::now();
    std::optional<Snapshot> snapshot;
    const ros::Time now = monitor_.with([&](const Monitor& monitor) {
      const ActiveScenePtr scene = monitor.scenes().active();
      if (scene) snapshot.emplace(monitor.at(scene));
      return monitor.transforms().now().stamp;
    });
    if (snapshot) {
      check(*snapshot, now, start);
    } else {
      reportUnknown(scene_service_.loadFirst());
    }
  } catch (const std::exception& error) {
    ROS_ERROR_STREAM_THROTTLE(WARN_PERIOD, "the cycle failed: " << error.what());
    reportUnknown(std::string("the cycle failed: ") + error.what());
  }
}

void CollisionPairsNode::check(const Snapshot& snapshot, const ros::Time& now,
                               const ros::WallTime& start) {
  const double transform_time = secondsSince(start);
  if (snapshot.scene != checked_scene_) takeScene(snapshot.scene);
  const CheckSettings settings = this->settings();
  const bool is_left_out = !snapshot.first_left_out.empty();
  if (is_left_out || !snapshot.poses.unknown_because.empty()) {
    ROS_WARN_STREAM_THROTTLE(
        WARN_PERIOD,
        (is_left_out ? "left out, no usable transform: " : "not known to be free: ")
            << (is_left_out ? snapshot.first_left_out : snapshot.poses.unknown_because.front()));
  }
  const CollisionPairs message =
      checkedMessage(monitor_, snapshot, settings, transform_time, *detector_);
  publisher_.publish(message);
  draw(snapshot, message, settings);
  std::optional<double> age;
  if (snapshot.isKnown()) {
    age = now.toSec() - message.header.stamp.toSec();
  }
  health_.noteCycle(message, age, secondsSince(start), 1.0 / parameters_.rate);
}

/// After the report is published: nothing can change it.
void CollisionPairsNode::draw(const Snapshot& snapshot, const CollisionPairs& message,
                              const CheckSettings& settings) {
  drawing([&] {
    const CollisionReport* report = &detector_->report();
    CollisionReport kept;
    std::optional<ShownLimit> shown;
    const auto limit = publisher_.showsMarkers() ? limiter_.lastLimit() : std::nullopt;
    if (limit) {  // the detector looks for its points
      kept = *report;
      report = &kept;
      shown = shownLimit(*limit, *detector_, snapshot.poses, settings.fidelity);
    }
    showMarkers(message, report, shown);
    publisher_.publishScene(snapshot.scene, settings.fidelity, snapshot.nb_found);
    publisher_.publishVoxels(*snapshot.scene, snapshot.poses, report->boxes,
                             settings.alarm_distance);
  });
}

void CollisionPairsNode::reportUnknown(const std::string& why) {
  const std::string frame = checked_scene_         ? checked_scene_->frame
                            : first_frame_.empty() ? FRAME_OF_NOTHING
                                                   : first_frame_;
  const CollisionPairs message = unknown(why, frame, ros::Time::now());
  publisher_.publish(message);
  drawing([&] {
    std::optional<ShownLimit> shown;
    if (const auto limit = limiter_.lastLimit()) shown = ShownLimit{*limit, {}};
    showMarkers(message, nullptr, shown);
  });
  health_.noteProblem(why);
}

void CollisionPairsNode::showMarkers(const CollisionPairs& message, const CollisionReport* report,
                                     const std::optional<ShownLimit>& limit) {
  publisher_.publishMarkers(message, report, parameters_.show_only_investigated_boxes, limit,
                            1.0 / parameters_.rate);
}

void CollisionPairsNode::takeScene(const ActiveScenePtr& scene) {
  auto detector = std::make_unique<CollisionDetector>(scene->scene);
  scene_service_.release(std::exchange(detector_, std::move(detector)));
  scene_service_.release(std::exchange(checked_scene_, scene));
  health_.noteScene(scene->warnings, scene->scene->openMeshes());
}

void CollisionPairsNode::reconfigure(CollisionPairsConfig& config) {
  const std::pair<const char*, double> numbers[] = {{"alarm_distance", config.alarm_distance},
                                                    {"tolerance", config.tolerance},
                                                    {"time_budget", config.time_budget},
                                                    {"rate", config.rate}};
  const auto set = [](auto& to, const auto& from) { to = from; };
  const auto setBack = [](const auto& from, auto& to) { to = from; };
  try {
    for (const auto& [name, number] : numbers) {
      if (!std::isfinite(number)) throw InputError(std::string(name) + " is not finite");
    }
    const Fidelity fidelity = parseFidelity(config.fidelity);
    const std::lock_guard<std::mutex> lock(mutex_);
    if (config.rate <= LOWEST_RATE && parameters_.rate > LOWEST_RATE) {
      ROS_WARN_STREAM("reconfigure: the rate is " << LOWEST_RATE << " Hz now, the lowest there is");
    }
    parameters_.check.fidelity = fidelity;
    forEachReconfigured(parameters_, config, set);
  } catch (const InputError& error) {
    ROS_ERROR_STREAM("reconfigure: " << error.what() << "; nothing is changed");
    config.fidelity = fidelityName(parameters_.check.fidelity);
    forEachReconfigured(parameters_, config, setBack);
    return;
  }
  next_cycle_ = ros::SteadyTime::now();  // whatever the rate was: the change is seen at once
}

}  // namespace collision_pairs
