#include "cloud_replay.h"

#include <algorithm>

#include <ros/serialization.h>

#include "collision_pairs/input_error.h"
#include "point_cloud.h"
#include "user_text.h"

namespace collision_pairs {
namespace {

constexpr std::size_t MOST_WAITING = 1000;  // clouds

bool isChecked(const CollisionScene& scene, const std::string& name) {
  return std::any_of(scene.clouds().begin(), scene.clouds().end(), [&](const SceneCloud& cloud) {
    return scene.models()[cloud.model].name == name;
  });
}

std::string whyLate(const CloudConfig& config, StampNs stamp, StampNs received) {
  const double age = inSeconds(received) - inSeconds(stamp);
  if (config.source_timeout == 0.0 || age <= config.source_timeout) return "";
  return "it was " + inWords(age) + " old when it arrived, and source_timeout is " +
         inWords(config.source_timeout);
}

}  // namespace

const char* const BAG_CHANGED = "it changed while it was read";

CloudReplay::CloudReplay(const BagCloudIndex& index, const std::vector<CloudConfig>& configs,
                         const SceneDescription& description, const CollisionScene& scene,
                         const BagPoses& poses)
    : index_(index), scene_(scene), poses_(poses) {
  for (const CloudConfig& config : configs) {
    sources_.push_back({config, CloudGatherer(config), RobotFilter(description, scene, config),
                        isChecked(scene, config.name())});
  }
  least_since_.assign(index.entries().size() + 1, NEVER);
  for (std::size_t i = index.entries().size(); i-- > 0;) {
    least_since_[i] = std::min(least_since_[i + 1], index.entries()[i].since);
  }
}

void CloudReplay::take(const RawMessage& raw, StampNs next_row) {
  const int number = index_.sourceOf(raw);
  if (number < 0) return;
  if (nb_taken_ == index_.entries().size() || index_.entries()[nb_taken_].source != number) {
    throw InputError(BAG_CHANGED);
  }
  const CloudEntry& entry = index_.entries()[nb_taken_++];
  Source& source = sources_[number];
  if (!source.is_checked) return;
  LatestCloud latest = source.later.empty() ? source.latest : source.later.back().second;
  latest.problem = entry.problem;
  ++source.nb_clouds;
  if (latest.problem.empty()) latest.problem = whyLate(source.config, entry.stamp, raw.received);
  if (latest.problem.empty()) {
    try {
      latest.voxels = gather(raw, entry.stamp, source);
      latest.stamp = measuredAt(inSeconds(entry.stamp), inSeconds(raw.received));
      latest.may_touch = source.gatherer.mayTouch();
      const std::string& warning = source.gatherer.warning();
      if (!warning.empty() && source.nb_warned++ == 0) source.first_warning = warning;
    } catch (const InputError& error) {
      latest.problem = error.what();
    }
  }
  if (!latest.problem.empty() && source.nb_refused++ == 0) source.first_problem = latest.problem;
  source.later.emplace_back(entry.since, std::move(latest));
  ++nb_waiting_;
  advance(next_row);
  if (nb_waiting_ > MOST_WAITING) {
    throw InputError("--clouds: more than " + std::to_string(MOST_WAITING) +
                     " clouds are recorded before others of earlier stamps; sort it by time");
  }
}

std::shared_ptr<const OccupiedVoxels> CloudReplay::gather(const RawMessage& raw, StampNs stamp,
                                                          Source& source) {
  if (!pointCloudFits(raw)) throw InputError("it is truncated");
  sensor_msgs::PointCloud2 cloud;
  try {
    ros::serialization::IStream stream(raw.data, raw.size);
    ros::serialization::deserialize(stream, cloud);
  } catch (const ros::Exception& error) {
    throw InputError(error.what());
  }
  readPoints(cloud, points_);
  Eigen::Isometry3d X_WS;
  if (!poses_.frameAt(stamp, cloud.header.frame_id, X_WS)) {
    throw InputError("the pose of its frame '" + cloud.header.frame_id +
                     "' at its stamp is unknown");
  }
  BodyPoses robot;
  poses_.at(stamp, source.filter.own.bodies(), robot);
  return source.gatherer.add(points_, X_WS, robot, inSeconds(stamp), source.filter);
}

void CloudReplay::advance(StampNs row) {
  for (Source& source : sources_) {
    while (!source.later.empty() && source.later.front().first <= row) {
      source.latest = std::move(source.later.front().second);
      source.later.pop_front();
      --nb_waiting_;
    }
  }
}

std::vector<CloudDoubt> CloudReplay::addVoxels(StampNs row, BodyPoses& poses) {
  advance(row);
  std::map<std::string, CloudView> views;
  for (const Source& source : sources_) {
    views[source.config.name()] =
        viewOf(source.config, source.latest, inSeconds(row), source.config.topic);
  }
  return collision_pairs::addVoxels(views, scene_, poses);
}

std::vector<std::string> CloudReplay::refusals() const {
  std::vector<std::string> sentences;
  const auto add = [&](const Source& source, std::size_t count, const std::string& what) {
    if (count == 0) return;
    sentences.push_back("cloud '" + source.config.name() + "': " + std::to_string(count) + " of " +
                        std::to_string(source.nb_clouds) + " messages " + what);
  };
  for (const Source& source : sources_) {
    add(source, source.nb_refused, "were refused; the first: " + source.first_problem);
    add(source, source.nb_warned, "show nothing; the first: " + source.first_warning);
  }
  return sentences;
}

}  // namespace collision_pairs
