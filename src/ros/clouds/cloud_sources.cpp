#include "cloud_sources.h"

#include <algorithm>
#include <utility>

#include <ros/names.h>

#include "collision_pairs/input_error.h"

namespace collision_pairs {

CloudSources::CloudSources(const ros::NodeHandle& node, const std::vector<CloudConfig>& configs,
                           const CloudSource::Context& context)
    : context_(context) {
  for (const CloudConfig& config : configs) {
    std::string why;
    if (!ros::names::validate(config.topic, why)) {
      throw InputError("clouds: '" + config.topic + "' is not a valid topic name: " + why);
    }
    sources_.push_back(std::make_unique<CloudSource>(node, config, context_));
  }
}

bool CloudSources::areOf(const std::vector<CloudConfig>& configs, const std::string& frame) const {
  return frame == context_.frame &&
         std::equal(sources_.begin(), sources_.end(), configs.begin(), configs.end(),
                    [](const auto& source, const CloudConfig& config) {
                      return source->config() == config;
                    });
}

CloudSources::FollowedRobots CloudSources::filtersFor(const SceneDescription& description,
                                                      const CollisionScene& scene,
                                                      const std::vector<std::string>& static_joints,
                                                      SceneCache* cache) const {
  FollowedRobots filters;
  for (const auto& source : sources_) {
    RobotFilter filter(description, scene, source->config(), cache);
    TfPoses poses(context_.transforms, scene.robot(), filter.own.bodies(), context_.frame,
                  static_joints);
    filters.push_back(
        std::make_shared<FollowedRobot>(FollowedRobot{std::move(filter), std::move(poses)}));
  }
  return filters;
}

void CloudSources::follow(FollowedRobots filters) {
  for (std::size_t i = 0; i < sources_.size(); ++i) sources_[i]->follow(std::move(filters[i]));
}

std::vector<std::string> CloudSources::addVoxels(const CollisionScene& scene, const ros::Time& now,
                                                 BodyPoses& poses) const {
  std::vector<std::string> doubts;
  for (CloudDoubt& doubt : collision_pairs::addVoxels(views(now), scene, poses)) {
    doubts.push_back(std::move(doubt.why));
  }
  return doubts;
}

std::map<std::string, CloudView> CloudSources::views(const ros::Time& now) const {
  std::map<std::string, CloudView> views;
  for (const auto& source : sources_) views[source->config().name()] = source->view(now);
  return views;
}

void CloudSources::clear() {
  for (const auto& source : sources_) source->clear();
}

void CloudSources::diagnose(diagnostic_updater::DiagnosticStatusWrapper& status) const {
  using diagnostic_msgs::DiagnosticStatus;
  status.summary(DiagnosticStatus::OK, "all clouds are fresh");
  const ros::Time now = ros::Time::now();
  for (const auto& source : sources_) {
    const std::string name = source->config().name() + " ";
    const CloudView view = source->view(now);
    const CloudHealth health = source->health();
    for (const std::string* words : {&view.doubt, &view.warning}) {
      if (!words->empty()) status.mergeSummary(DiagnosticStatus::WARN, *words);
    }
    status.add(name + "problem", view.doubt.empty() ? view.warning : view.doubt);
    status.add(name + "rate [Hz]", health.rate);
    status.add(name + "latency [s]", health.latency);
    status.add(name + "processing [s]", health.processing);
    status.add(name + "points", health.points);
    status.add(name + "points kept", health.kept);
    status.add(name + "voxels", health.voxels);
    status.add(name + "received", health.received);
    status.add(name + "used", health.used);
    status.add(name + "dropped", health.dropped);
    status.add(name + "refused", health.refused);
  }
}

}  // namespace collision_pairs
