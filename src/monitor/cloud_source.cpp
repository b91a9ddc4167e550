#include "cloud_source.h"

#include <algorithm>
#include <chrono>
#include <utility>

#include "collision_pairs/input_error.h"
#include "point_cloud.h"
#include "user_text.h"

namespace collision_pairs {
namespace {

constexpr double LONGEST_WAIT = 1.0;     // s, for the transforms at a cloud's stamp
constexpr double SILENCE = 3.0;          // s, after which the rate is 0
constexpr double SHARE_OF_NEWEST = 0.1;  // weight in the mean rate

}  // namespace

const std::string CloudSource::REFUSED = "a message was refused: ";

void CloudJob::run() {
  const auto start = std::chrono::steady_clock::now();
  try {
    std::vector<Eigen::Vector3d> points;
    readPoints(*cloud_, points);
    nb_points_ = points.size();
    latest_.stamp = cloud_->header.stamp.toSec();
    latest_.voxels = processor_->add(points, X_WS_, robot_, latest_.stamp, followed_->filter);
    nb_kept_ = processor_->kept().size();
    latest_.warning = processor_->warning();
    latest_.may_touch = processor_->mayTouch();
  } catch (const std::exception& error) {
    latest_.problem = error.what();
  }
  seconds_ = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

CloudSource::CloudSource(const CloudConfig& config, std::string topic, std::string frame,
                         const TransformInput& transforms)
    : config_(config),
      topic_(std::move(topic)),
      frame_(std::move(frame)),
      transforms_(transforms),
      processor_(std::make_shared<CloudProcessor>(config)) {
  gathered_clock_jumps_ = transforms.nbClockJumps();
}

std::shared_ptr<FollowedRobot> CloudSource::follow(std::shared_ptr<FollowedRobot> robot,
                                                   bool may_keep_more) {
  robot->number = robot_ ? robot_->number + 1 : 0;
  if (may_keep_more) complete_from_ = robot->number;
  return std::exchange(robot_, std::move(robot));
}

/// Of the memory of the processor, which is about to go.
void CloudSource::rememberWhatMayTouch() {
  if (!latest_.may_touch.empty()) may_touch_ = latest_.may_touch;
  const bool is_hidden = may_touch_.empty() && processor_->hidesAny();
  if (is_hidden) may_touch_ = "was hidden when the clock went back: it may touch";
}

void CloudSource::replace(const CloudSource& before) {
  may_touch_ = before.latest_.may_touch.empty() ? before.may_touch_ : before.latest_.may_touch;
  if (topic_ != before.topic_ || gathered_clock_jumps_ != before.gathered_clock_jumps_) return;
  camera_ = before.camera_;
  other_camera_ = before.other_camera_;
  other_at_ = before.other_at_;
  last_use_ = before.last_use_;
}

void CloudSource::take(const Cloud::ConstPtr& cloud, const std::string& publisher) {
  ++health_.received;
  const Now& now = transforms_.now();
  const std::string other = otherCamera(withoutSlashes(cloud->header.frame_id), publisher);
  if (!other.empty()) {
    other_camera_ = other;
    other_at_ = now.steady;
    return refuse(other);
  }
  if (next_.cloud) ++health_.dropped;
  next_ = {cloud, publisher, now.stamp, now.steady, transforms_.nbClockJumps()};
}

std::string CloudSource::otherCamera(const std::string& frame, const std::string& publisher) const {
  if (!camera_ || transforms_.nbClockJumps() != gathered_clock_jumps_) return "";
  const bool is_recent = transforms_.now().steady - last_use_ < config_.source_timeout;
  if (frame == camera_->frame && (publisher == camera_->publisher || !is_recent)) return "";
  return "it is of frame '" + frame + "' and node '" + publisher + "', and those before were of '" +
         camera_->frame + "' and '" + camera_->publisher +
         "': each camera needs a topic of its own; ~clear_clouds starts anew";
}

std::shared_ptr<CloudJob> CloudSource::next() {
  if (!robot_ || !running_.expired()) return nullptr;
  if (!waiting_.cloud) {
    waiting_ = std::exchange(next_, {});
    waiting_.steady = transforms_.now().steady;
  }
  if (!waiting_.cloud) return nullptr;
  std::shared_ptr<CloudJob> job;
  try {
    job = begin(waiting_);
    const bool has_newer = next_.cloud && next_.cloud->header.stamp > waiting_.cloud->header.stamp;
    if (!job && has_newer) job = beginNewer();
  } catch (const std::exception& error) {
    refuse(error.what());
    waiting_ = {};
  }
  if (job) waiting_ = {};
  running_ = job;
  return job;
}

/// What the waiting cloud lacks may never come, since a suspect stamp stays so. A newer one
/// that lacks nothing need not wait for it. If something is wrong with that one, it is said when
/// its turn comes.
std::shared_ptr<CloudJob> CloudSource::beginNewer() {
  try {
    auto job = begin(next_);
    if (!job) return nullptr;
    next_ = {};
    ++health_.dropped;
    return job;
  } catch (const InputError&) {
    return nullptr;
  }
}

std::shared_ptr<CloudJob> CloudSource::begin(Arrived& arrived) {
  const std_msgs::Header& header = arrived.cloud->header;
  if (arrived.clock_jumps != transforms_.nbClockJumps()) {
    throw InputError("it came before the clock went back");
  }
  const bool is_new = !arrived.nb_taken;
  const bool is_over = transforms_.now().steady - arrived.steady >= LONGEST_WAIT;
  // Nothing was received since.
  if (!is_over && !is_new && *arrived.nb_taken == transforms_.nbTaken()) return nullptr;
  if (gathered_generation_ != generation_ || gathered_clock_jumps_ != transforms_.nbClockJumps()) {
    if (gathered_generation_ == generation_ && !transforms_.isNewRun()) rememberWhatMayTouch();
    gathered_generation_ = generation_;
    gathered_clock_jumps_ = transforms_.nbClockJumps();
    processor_ = std::make_shared<CloudProcessor>(config_);
    last_stamp_ = ros::Time();
    camera_.reset();
    other_camera_.clear();
  }
  if (is_new) {
    requireUsableStamp(header.stamp);
    requireReadable(*arrived.cloud);
  }
  // Another may have been used since it was looked at.
  if (!last_stamp_.isZero() && header.stamp <= last_stamp_) {
    throw InputError(
        "its stamp is not later than that of the previous cloud: are there two publishers?");
  }
  arrived.nb_taken = transforms_.nbTaken();

  auto job = std::make_shared<CloudJob>();
  const Missing missing = lookUp(header, *job);
  if (!missing.why.empty()) {
    const std::string problem = "TF has no poses of the sensor ('" + header.frame_id +
                                "') and the robot at its stamp: " + missing.why;
    if (!missing.is_connected) latest_.problem = problem;
    if (is_over) throw InputError(problem);
    return nullptr;
  }
  robot_->filter.keeps_more = latest_robot_ < complete_from_;
  job->cloud_ = arrived.cloud;
  job->arrived_ = arrived.when;
  job->publisher_ = arrived.publisher;
  job->followed_ = robot_;
  job->processor_ = processor_;
  job->generation_ = generation_;
  job->clock_jumps_ = gathered_clock_jumps_;
  return job;
}

CloudSource::Missing CloudSource::lookUp(const std_msgs::Header& header, CloudJob& found) const {
  try {
    found.X_WS_ = robot_->poses.lookUp(frame_, header.frame_id, header.stamp).X_TS;
  } catch (const NotConnected& error) {
    return {error.what(), false};
  } catch (const InputError& error) {
    return {error.what()};
  }
  StampedPoses stamped = robot_->poses.at(header.stamp);
  if (!stamped.problems.empty()) return {stamped.problems.front()};
  found.robot_ = std::move(stamped.poses);
  return {};
}

void CloudSource::take(CloudJob& job) {
  running_.reset();
  if (job.generation_ != generation_) return;  // cleared meanwhile
  if (!job.latest_.problem.empty()) return refuse(job.latest_.problem);
  last_stamp_ = job.cloud_->header.stamp;
  camera_ = {withoutSlashes(job.cloud_->header.frame_id), job.publisher_};
  std::swap(latest_, job.latest_);  // what is replaced is freed with the job
  if (latest_.may_touch.empty()) latest_.may_touch = may_touch_;
  latest_.stamp = measuredAt(latest_.stamp, job.arrived_.toSec());
  latest_robot_ = job.followed_->number;
  latest_clock_jumps_ = job.clock_jumps_;
  const Now& now = transforms_.now();
  const double rate = 1.0 / std::max(now.steady - last_use_, 1e-6);
  if (health_.used == 1) health_.rate = rate;
  if (health_.used > 1) health_.rate += SHARE_OF_NEWEST * (rate - health_.rate);
  last_use_ = now.steady;
  ++health_.used;
  health_.latency = now.stamp.toSec() - latest_.stamp;
  health_.processing = job.seconds_;
  health_.points = job.nb_points_;
  health_.kept = job.nb_kept_;
  health_.voxels = latest_.voxels->size();
  if (!latest_.warning.empty()) note_ = latest_.warning;
}

void CloudSource::refuse(const std::string& why) {
  latest_.problem = why;
  note_ = REFUSED + why;
  ++health_.refused;
}

void CloudSource::requireUsableStamp(const ros::Time& stamp) const {
  const ros::Time& now = transforms_.now().stamp;
  if (now.isZero()) throw InputError(NO_CLOCK);
  if (stamp.isZero()) throw InputError("its stamp is zero");
  const double age = secondsBetween(stamp, now);
  if (-age > transforms_.limits().clock_tolerance) {
    throw InputError("its stamp is " + inWords(-age) + " ahead of the clock");
  }
  if (config_.source_timeout > 0.0 && age > config_.source_timeout) {
    throw InputError("it was " + inWords(age) + " old when it arrived, and source_timeout is " +
                     inWords(config_.source_timeout));
  }
}

CloudView CloudSource::view() const {
  const auto problemSince = [&](const std::string& event) {
    return "cloud '" + config_.name() + "': none has arrived since " + event + refusalOf(latest_);
  };
  CloudView view;
  if (latest_.voxels && latest_clock_jumps_ != transforms_.nbClockJumps()) {
    view.problem = problemSince("the clock went back");
    return view;
  }
  view = viewOf(config_, latest_, transforms_.now().stamp.toSec(), topic_);
  const double since_other = transforms_.now().steady - other_at_;
  const bool is_other_silent = config_.source_timeout > 0.0 && since_other > config_.source_timeout;
  if (view.problem.empty() && !other_camera_.empty() && !is_other_silent) {
    view.problem = "cloud '" + config_.name() + "': one was refused: " + other_camera_;
  }
  if (view.voxels && view.problem.empty() && latest_robot_ < complete_from_) {
    view.problem = problemSince("the robot, or what is attached to it, changed");
  }
  return view;
}

void CloudSource::clear() {
  ++generation_;
  next_ = waiting_ = {};
  latest_ = {};
  may_touch_.clear();
  camera_.reset();
  other_camera_.clear();
}

CloudHealth CloudSource::health() const {
  CloudHealth health = health_;
  if (transforms_.now().steady - last_use_ > SILENCE) health.rate = 0.0;
  return health;
}

}  // namespace collision_pairs
