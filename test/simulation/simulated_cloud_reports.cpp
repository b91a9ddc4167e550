// The claims about what a SimulatedNode says of its clouds.
#include <algorithm>
#include <cmath>

#include "simulated_node.h"

namespace simulation {

/// For diagnostics: the rate is a mean in which each interval weighs a tenth.
void SimulatedNode::noteUse(double latency) {
  const double rate = 1.0 / std::max(steady_ - last_use_, 1e-6);
  if (nb_used_ == 1) rate_ = rate;
  if (nb_used_ > 1) rate_ = 0.9 * rate_ + 0.1 * rate;
  ++nb_used_;
  last_use_ = steady_;
  latency_ = latency;
}

void SimulatedNode::judgeHealth(const CloudHealth& health) {
  if (health.used != static_cast<std::uint64_t>(nb_used_)) fail("another number of used clouds");
  const double age = steady_ - last_use_;
  const double rate = age > 3.0 ? 0.0 : rate_;
  if (std::abs(age - 3.0) > 1e-6 && std::abs(health.rate - rate) > 1e-3 * (1.0 + rate)) {
    fail("the rate of clouds is another");
  }
  if (health.points != sent_points_) fail("the number of points is another");
  if (nb_used_ == 0) return;
  if (std::abs(health.latency - latency_) > ROUNDING) fail("the latency of clouds is another");
  if (health.kept > health.points || health.processing <= 0.0) {
    fail("the numbers of points do not agree");
  }
  const CloudView view = monitor_.scenes().active()->clouds.front()->view();
  if (view.voxels && view.voxels->size() != health.voxels) fail("other voxels are counted");
  if (view.voxels && view.voxels->size() > most_voxels_) fail("voxels of before count");
}

/// Empty: there is none, but that something may have come too near to be seen.
std::string SimulatedNode::expectedCloudProblem(bool is_refused) const {
  if (!used_cloud_) return is_refused ? "none is usable" : "none has arrived yet on /points";
  if (used_cloud_->pass != knowledge_.pass()) return "none has arrived since the clock went back";
  if (seconds(ros_) - used_cloud_->measured > timeout()) return "the newest is ";
  if (is_refused) return "the last was refused";
  const bool is_silent = other_camera_ && settings_.source_timeout > 0.0 &&
                         steady_ - *other_camera_ > settings_.source_timeout;
  if (other_camera_ && !is_silent) return "one was refused: it is of frame '";
  if (used_cloud_->revision < complete_revision_)
    return "none has arrived since the robot, or what";
  return "";
}

/// That are in the node, but for one that was cleared while it was processed.
int SimulatedNode::nbCloudsHere() const {
  const bool is_processed = cloud_work_ && cloud_work_generation_ == cloud_generation_;
  return (next_cloud_ ? 1 : 0) + (waiting_cloud_ ? 1 : 0) + (is_processed ? 1 : 0);
}

void SimulatedNode::judgeClouds(const Snapshot& snapshot) {
  if (!setup_.has_cloud) return;
  const double age = used_cloud_ ? seconds(ros_) - used_cloud_->measured : 0.0;
  std::string said;
  for (const std::string& reason : snapshot.poses.unknown_because) {
    if (reason.rfind("cloud '", 0) == 0) said = reason;
  }
  const auto isSaid = [&](bool is_refused) {
    const std::string expected = expectedCloudProblem(is_refused), begin = "cloud 'points': ";
    const bool is_of_filter = expected.rfind("none has arrived since the robot", 0) == 0;
    const bool is_of_other = expected.rfind("one was refused", 0) == 0;
    const bool may_touch = said.rfind(begin + "something ", 0) == 0;
    if (expected.empty()) return said.empty() || may_touch;
    if (may_touch && (is_of_filter || is_of_other)) return true;
    return said.rfind(begin + expected, 0) == 0;
  };
  const bool is_edge = std::abs(age - timeout()) < 1e-6;
  if (!isSaid(is_cloud_refused_) && !(may_cloud_be_refused_ && isSaid(true)) && !is_edge) {
    fail("of clouds is said: '" + said + "', not: " + expectedCloudProblem(is_cloud_refused_));
  }
  const CloudHealth health = monitor_.scenes().active()->clouds.front()->health();
  const auto nb_gone = health.used + health.refused + health.dropped;
  if (health.received != static_cast<std::uint64_t>(nb_clouds_) ||
      nb_gone + static_cast<std::uint64_t>(nbCloudsHere() + nb_cleared_) != health.received) {
    fail("clouds are lost, or counted twice");
  }
  judgeHealth(health);
  const bool is_waiting = monitor_.scenes().active()->clouds.front()->isWaiting();
  if (is_waiting != (next_cloud_ || waiting_cloud_)) fail("whether a cloud waits is not said");
}

}  // namespace simulation
