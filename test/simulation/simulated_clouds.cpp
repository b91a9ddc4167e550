// Clouds of a SimulatedNode, and the claims about what becomes of them.
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <boost/make_shared.hpp>

#include "point_cloud.h"
#include "simulated_node.h"

namespace simulation {
namespace {

enum {
  WHERE_IT_WAS,
  BESIDE_THE_ROBOT,
  REPEATED = 3,
  OF_NO_FRAME,
  EMPTY,
  NOT_FINITE,
  WITHOUT_STAMP,
  MALFORMED  // it has more points than it says
};           // kinds of clouds; others are sound

}  // namespace

void SimulatedNode::sendCloud(const Event& event) {
  if (!setup_.has_cloud) return;
  const bool is_other = setup_.has_other_camera && event.number > 0.3;
  const std::string publisher = is_other ? "/other_camera" : "/camera";
  if (event.what == REPEATED && sent_) {
    return takeCloud(sent_, {sent_cloud_.stamp, sent_cloud_.what, sent_cloud_.points, seconds(ros_),
                             knowledge_.pass(), publisher});
  }
  const int what = event.what == EMPTY && event.other % 2 == 1 ? MALFORMED : event.what;
  const bool is_ahead = event.what == 2 && event.number < -0.5;  // by more than the tolerance
  const Ns stamp = what == WITHOUT_STAMP ? 0 : stampOf(is_ahead ? -0.8 : event.lag);
  const auto X_WL = knowledge_.poseOf(setup_.camera_on, stamp);
  const Pose X_CW = inverse(X_WL.value_or(Pose()) * X_LC_);
  std::vector<Pose> points;
  if (what != EMPTY) {
    points = {{4.0, 0.0, 1.0, 0.0}, {4.0, 0.1, 1.0, 0.0}};  // a wall far away
    const auto X_WB = knowledge_.poseOf(event.who, stamp);
    if (what != WHERE_IT_WAS) obstacle_ = event.at;
    if (what == BESIDE_THE_ROBOT && X_WB) {
      obstacle_ = *X_WB;
      obstacle_.z += ballOf(event.who).radius + SELF_FILTER + 0.02;
    }
    for (int i = 0; i < 4; ++i) {
      points.push_back(X_CW * Pose{obstacle_.x + 0.01 * i, obstacle_.y, obstacle_.z, 0.0});
    }
  }
  std::vector<Eigen::Vector3d> sent;
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const Pose& p : points) {
    sent.push_back(inSpace(p));
    if (what == NOT_FINITE) sent.back().x() = nan;
  }
  std_msgs::Header header;
  header.frame_id = what == OF_NO_FRAME ? "elsewhere" : "camera";
  header.stamp.fromNSec(static_cast<std::uint64_t>(std::max<Ns>(0, stamp)));
  const auto cloud = boost::make_shared<sensor_msgs::PointCloud2>(toPointCloud2(sent, header));
  if (what == MALFORMED) cloud->width -= 4;
  sent_ = cloud;
  sent_cloud_ = {stamp, what, points, seconds(ros_), knowledge_.pass(), publisher};
  takeCloud(sent_, sent_cloud_);
}

/// Each camera needs a topic of its own: nothing would tell that one of two is silent.
bool SimulatedNode::isOfOtherCamera(const SentCloud& cloud) const {
  if (!camera_ || camera_->pass != knowledge_.pass()) return false;
  const bool is_recent = steady_ - camera_->last_use < settings_.source_timeout;
  return cloud.what == OF_NO_FRAME || (cloud.publisher != camera_->publisher && is_recent);
}

void SimulatedNode::takeCloud(const sensor_msgs::PointCloud2::ConstPtr& message,
                              const SentCloud& cloud) {
  CloudSource& source = *monitor_.scenes().active()->clouds.front();
  const auto nb_refused = source.health().refused;
  const std::string before = source.takeNote();
  if (!before.empty()) fail("a note that nobody took: " + before);
  source.take(message, cloud.publisher);
  ++nb_clouds_;
  const bool is_other = isOfOtherCamera(cloud);
  if ((source.health().refused > nb_refused) != is_other) {
    fail(is_other ? "two cameras on one topic are taken for one" : "it is of the same camera");
  }
  if (source.takeNote().empty() == is_other) fail("whether a cloud was refused is not told");
  if (!is_other) return void(next_cloud_ = cloud);
  other_camera_ = steady_;
  is_cloud_refused_ = true;
}

void SimulatedNode::clearClouds() {
  monitor_.clearClouds();
  camera_.reset();
  other_camera_.reset();
  noteCleared();
  is_lost_ = was_lost_ = false;
}

void SimulatedNode::noteCleared() {
  nb_cleared_ += nbCloudsHere();
  ++cloud_generation_;
  next_cloud_.reset();
  waiting_cloud_.reset();
  used_cloud_.reset();
  is_cloud_refused_ = may_cloud_be_refused_ = false;
  seen_.reset();
  last_cloud_ = 0;
}

/// There is a new source of the same camera.
void SimulatedNode::forgetClouds() {
  noteCleared();
  was_lost_ = was_lost_ || is_lost_;
  is_lost_ = false;
  cloud_work_.reset();
  nb_clouds_ = nb_cleared_ = nb_used_ = 0;
  last_use_ = rate_ = latency_ = 0.0;
  sent_points_ = 0;
}

/// Of all that a cloud needs.
bool SimulatedNode::arePosesCertain(Ns stamp) const {
  bool are_certain = is_camera_told_ && !setup_.isCameraHeld();
  for (int i = 0; i < static_cast<int>(setup_.links.size()); ++i) {
    are_certain = are_certain && knowledge_.isCertain(i, stamp);
  }
  return are_certain && knowledge_.isCertain(-1, stamp);
}

/// It can be handed out.
bool SimulatedNode::isSound(const SentCloud& cloud) const {
  const double age = seconds(ros_ - cloud.stamp);
  return ros_ > 0 && cloud.stamp > last_cloud_ && cloud.pass == knowledge_.pass() &&
         cloud.what != OF_NO_FRAME && cloud.what != MALFORMED && age > -0.5 + 1e-6 &&
         age < timeout() - 1e-6 && arePosesCertain(cloud.stamp);
}

/// It was refused when it was looked at.
void SimulatedNode::requireRefusable(const SentCloud& cloud) {
  const double age = seconds(ros_ - cloud.stamp);
  const bool is_stamp_bad = cloud.may_be_new && (ros_ == 0 || cloud.stamp == 0 ||
                                                 -age > 0.5 - 1e-6 || age > timeout() - 1e-6);
  const bool is_late = cloud.pass != knowledge_.pass() || cloud.stamp <= last_cloud_;
  const bool has_waited = steady_ - cloud.since > LONGEST_WAIT - 1e-6;
  const bool is_known = cloud.what != OF_NO_FRAME && arePosesCertain(cloud.stamp);
  if (cloud.what == MALFORMED) return;
  if (!is_stamp_bad && !is_late && (is_known || !has_waited)) fail("a sound cloud is refused");
}

/// When it is looked at first.
bool SimulatedNode::hasNoUsableStamp(const SentCloud& cloud) const {
  const double age = seconds(ros_ - cloud.stamp);
  return cloud.is_new &&
         (ros_ == 0 || cloud.stamp == 0 || -age > 0.5 + 1e-6 || age > timeout() + 1e-6);
}

/// It was handed out when it was looked at.
void SimulatedNode::requireUsable(const SentCloud& cloud) {
  if (hasNoUsableStamp(cloud)) fail("a cloud is processed that has no usable stamp");
  if (cloud.pass != knowledge_.pass()) fail("a cloud is processed of before the clock went back");
  const auto X_WL = knowledge_.poseOf(setup_.camera_on, cloud.stamp);
  const bool can_be_known =
      is_camera_told_ && (X_WL || knowledge_.isLiedAbout(setup_.camera_on, cloud.stamp));
  if (!can_be_known || cloud.what == OF_NO_FRAME)
    fail("a cloud is processed whose camera is nowhere");
  if (setup_.isCameraHeld()) fail("a cloud is processed whose camera only /tf_static places");
  if (cloud.what == MALFORMED) fail("a cloud is processed that hides points");
}

void SimulatedNode::beginCloud() {
  if (!setup_.has_cloud) return;
  CloudSource& source = *monitor_.scenes().active()->clouds.front();
  const auto nb_refused = source.health().refused;
  const auto job = source.next();
  if (cloud_work_) {
    if (job) fail("a cloud is handed out while another is being processed");
    return;
  }
  if (!waiting_cloud_ && next_cloud_) {
    waiting_cloud_ = std::exchange(next_cloud_, std::nullopt);
    waiting_cloud_->since = steady_;
  }
  const bool is_refused = source.health().refused > nb_refused;
  const std::string note = source.takeNote();
  if (note.empty() == is_refused || (is_refused && note.rfind(CloudSource::REFUSED, 0) != 0)) {
    fail("what is told of a refused cloud is '" + note + "'");
  }
  if (!waiting_cloud_) {
    if (job || is_refused) fail("a cloud comes from nowhere");
    return;
  }
  if (is_refused) {
    requireRefusable(*waiting_cloud_);
    waiting_cloud_.reset();
    is_cloud_refused_ = true;
    return;
  }
  if (!job) {
    const SentCloud& cloud = *waiting_cloud_;
    if (steady_ - cloud.since > LONGEST_WAIT + 1e-6) fail("a cloud waits for too long");
    if (hasNoUsableStamp(cloud)) fail("a cloud waits that has no usable stamp");
    const bool is_connected = cloud.what != OF_NO_FRAME;
    if (is_connected && arePosesCertain(cloud.stamp)) fail("a cloud waits for what is known");
    if (next_cloud_ && next_cloud_->stamp > cloud.stamp && isSound(*next_cloud_)) {
      fail("a newer cloud waits, of which all is known");
    }
    is_cloud_refused_ = is_cloud_refused_ || !is_connected || !is_camera_told_;
    may_cloud_be_refused_ = true;  // of its camera, what is above may not be connected
    waiting_cloud_->is_new = waiting_cloud_->may_be_new = false;
    if (next_cloud_ && next_cloud_->stamp > cloud.stamp) next_cloud_->is_new = false;
    return;
  }
  const Ns stamp = static_cast<Ns>(job->header().stamp.toNSec());
  const bool is_newer = stamp != waiting_cloud_->stamp;
  if (is_newer && !(next_cloud_ && next_cloud_->stamp == stamp))
    return fail("a cloud was not sent");
  sent_work_ = is_newer ? *next_cloud_ : *waiting_cloud_;
  if (is_newer) next_cloud_.reset();
  waiting_cloud_.reset();
  requireUsable(sent_work_);
  cloud_work_ = job;
  cloud_work_generation_ = cloud_generation_;
  cloud_work_pass_ = knowledge_.pass();
  cloud_work_revision_ = revision_;
  cloud_points_.clear();
  const auto X_WL = knowledge_.poseOf(setup_.camera_on, stamp);
  if (!X_WL || knowledge_.isLiedAbout(setup_.camera_on)) return;
  if (knowledge_.isOpen(setup_.camera_on, stamp)) return;
  for (const Pose& p : sent_work_.points) {
    if (std::hypot(p.x, p.y, p.z) > 0.99 * MAX_RANGE) continue;
    const Pose in_world = *X_WL * X_LC_ * p;
    bool is_own = false;  // or it may be
    for (int i = 0; i < static_cast<int>(setup_.links.size()); ++i) {
      const auto X_WB = knowledge_.poseOf(i, stamp);
      const double radius = setup_.links[static_cast<std::size_t>(i)].radius;
      is_own = is_own || !X_WB || knowledge_.isLiedAbout(i) || knowledge_.isOpen(i, stamp) ||
               distance({false, radius, {}}, *X_WB, {}, in_world) < SELF_FILTER + 1e-3;
    }
    for (const auto& [name, object] : objects_) {
      const auto X_WB = knowledge_.poseOf(object.link, stamp);
      const bool is_nowhere = !X_WB || knowledge_.isOpen(object.link, stamp);
      is_own = is_own ||
               (object.link >= 0 &&
                (is_nowhere || distance(object.solid, *X_WB * object.X_PO, {}, in_world) < 0.15));
    }
    if (!is_own) cloud_points_.push_back(in_world);
  }
}

void SimulatedNode::endCloud() {
  if (!cloud_work_) return;
  const auto job = std::move(cloud_work_);
  cloud_work_.reset();
  job->run();
  const bool is_used = job->isUsed();
  CloudSource& source = *monitor_.scenes().active()->clouds.front();
  source.take(*job);
  const bool is_told = source.takeNote().rfind(CloudSource::REFUSED, 0) == 0;
  if (is_told == (is_used || cloud_work_generation_ != cloud_generation_)) {
    fail(is_told ? "it is told that a sound cloud was refused" : "no one is told of a refusal");
  }
  if (is_used == (sent_work_.what == EMPTY || sent_work_.what == NOT_FINITE)) {
    fail(is_used ? "a cloud without points is used" : "a cloud with points is not used");
  }
  if (cloud_work_generation_ != cloud_generation_) return;
  is_cloud_refused_ = !is_used;
  may_cloud_be_refused_ = false;
  if (!is_used) return;
  const double measured = std::min(seconds(sent_work_.stamp), sent_work_.arrival);
  noteUse(seconds(ros_) - measured);
  sent_points_ = sent_work_.points.size();
  const bool is_first = !used_cloud_ || used_cloud_->pass != cloud_work_pass_;
  most_voxels_ = (is_first ? 0 : most_voxels_) + sent_points_;
  used_cloud_ = {measured, cloud_work_pass_, cloud_work_revision_};
  if (camera_ && camera_->pass != cloud_work_pass_) other_camera_.reset();
  camera_ = {sent_work_.publisher, cloud_work_pass_, steady_};
  if (cloud_work_pass_ != knowledge_.pass()) return;
  if (sent_work_.stamp <= last_cloud_) fail("a cloud is used after a later one");
  last_cloud_ = sent_work_.stamp;
  // It may have been filtered by what was attached before.
  if (cloud_work_revision_ < complete_revision_) return;
  Seen seen{measured, cloud_points_, cloud_work_revision_};
  is_lost_ = isAnyLost();
  if (seen_) seen.before = seen_->points;
  seen_ = seen;
}

/// Whether something that two clouds showed beside a link is not in the one that is used now, where
/// nothing hides it and nothing is near that it may have become.
bool SimulatedNode::isAnyLost() const {
  constexpr double BESIDE = 0.06, NEAR = 0.4, SHADOW = 0.1;  // m, m, rad
  const auto X_WL = knowledge_.poseOf(setup_.camera_on, sent_work_.stamp);
  if (!seen_ || seen_->revision != cloud_work_revision_ || cloud_points_.empty() || !X_WL) {
    return false;
  }
  for (const auto& [name, object] : objects_) {
    if (object.link >= 0) return false;
  }
  const Pose X_CW = inverse(*X_WL * X_LC_);
  const auto isBeside = [&](int link, const Pose& p) {
    const auto X_WB = knowledge_.poseOf(link, sent_work_.stamp);
    const bool is_certain =
        X_WB && settings_.ignored.count(link) == 0 && knowledge_.isCertain(link, sent_work_.stamp);
    return is_certain && std::abs(distance(ballOf(link), *X_WB, {}, p)) < BESIDE;
  };
  const auto isLost = [&](const Pose& p) {
    const Pose in_camera = X_CW * p;
    const auto explains = [&](const Pose& q) {
      const double of_p = metresOf(in_camera, {}), of_q = metresOf(q, {});
      const double cosine =
          (q.x * in_camera.x + q.y * in_camera.y + q.z * in_camera.z) / (of_p * of_q);
      const bool may_hide = of_q < of_p + NEAR && !(cosine < std::cos(SHADOW));
      return may_hide || metresOf(q, in_camera) < NEAR;
    };
    const auto isSame = [&](const Pose& q) { return metresOf(p, q) < 0.01; };
    if (std::none_of(seen_->before.begin(), seen_->before.end(), isSame)) return false;
    if (std::any_of(sent_work_.points.begin(), sent_work_.points.end(), explains)) return false;
    for (int link = 0; link < static_cast<int>(setup_.links.size()); ++link) {
      if (isBeside(link, p)) return true;
    }
    return false;
  };
  return std::any_of(seen_->points.begin(), seen_->points.end(), isLost);
}

}  // namespace simulation
