#include "cloud_sources.h"

#include <algorithm>
#include <chrono>
#include <utility>

#include <ros/console.h>
#include <ros/names.h>

#include "collision_pairs/input_error.h"
#include "measured_at.h"
#include "point_cloud.h"
#include "user_text.h"

namespace collision_pairs {
namespace {

constexpr std::uint32_t QUEUE_SIZE = 2;     // messages waiting for the callback
const ros::WallDuration LONGEST_WAIT(1.0);  // for the transforms at a cloud's stamp
const std::chrono::milliseconds PAUSE(1);   // between two attempts
const ros::WallDuration TELL_PERIOD(5.0);   // between two warnings in the log
const ros::WallDuration SILENCE(3.0);       // after which the rate is 0
constexpr double SHARE_OF_NEWEST = 0.1;     // weight in the mean rate

}  // namespace

CloudSource::CloudSource(const ros::NodeHandle& node, const CloudConfig& config, Context context)
    : config_(config), context_(std::move(context)), gatherer_(config), spinner_(1, &queue_) {
  ros::NodeHandle own_queue(node);
  own_queue.setCallbackQueue(&queue_);
  subscriber_ = own_queue.subscribe<Cloud>(config_.topic, QUEUE_SIZE, &CloudSource::onCloud, this,
                                           ros::TransportHints().tcpNoDelay());
  worker_ = std::thread([this] { work(); });
  spinner_.start();
}

CloudSource::~CloudSource() {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    stopping_ = true;
  }
  wakes_worker_.notify_all();
  worker_.join();
}

void CloudSource::follow(std::shared_ptr<FollowedRobot> robot, bool may_keep_more) {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    robot->number = robot_ ? robot_->number + 1 : 0;
    if (may_keep_more) complete_from_ = robot->number;
    robot_ = std::move(robot);
  }
  wakes_worker_.notify_all();
}

void CloudSource::onCloud(const Cloud::ConstPtr& cloud) {
  {
    const ros::Time now = context_.transforms.followClock();
    const std::lock_guard<std::mutex> lock(mutex_);
    next_arrived_ = now;
    next_clock_jumps_ = context_.transforms.nbClockJumps();
    ++health_.received;
    if (next_) ++health_.dropped;
    next_ = cloud;
  }
  wakes_worker_.notify_all();
}

void CloudSource::work() {
  std::unique_lock<std::mutex> lock(mutex_);
  while (true) {
    wakes_worker_.wait(lock, [this] { return stopping_ || (next_ && robot_); });
    if (stopping_) return;
    const Cloud::ConstPtr cloud = std::exchange(next_, nullptr);
    const std::shared_ptr<FollowedRobot> robot = robot_;
    const unsigned generation = generation_;
    const ros::Time arrived = next_arrived_;
    context_.transforms.followClock();
    const bool is_of_before = next_clock_jumps_ != context_.transforms.nbClockJumps();
    robot->filter.keeps_more = latest_robot_ < complete_from_;
    lock.unlock();
    std::string problem;
    try {
      if (is_of_before) throw InputError("it came before the clock went back");
      use(*cloud, arrived, generation, *robot);
    } catch (const std::exception& error) {
      problem = error.what();
    }
    if (!problem.empty()) tell("a message was refused: " + problem);
    lock.lock();
    if (problem.empty() || stopping_) continue;
    latest_.problem = std::move(problem);
    ++health_.refused;
  }
}

void CloudSource::use(const Cloud& cloud, const ros::Time& arrived, unsigned generation,
                      FollowedRobot& robot) {
  const ros::Time now = context_.transforms.followClock();
  if (cleared_for_ != generation ||
      nb_clock_jumps_ != context_.transforms.nbClockJumps()) {  // the bag was restarted
    cleared_for_ = generation;
    nb_clock_jumps_ = context_.transforms.nbClockJumps();
    gatherer_.clear();
    last_stamp_ = ros::Time();
  }
  requireUsableStamp(cloud.header.stamp, now);
  readPoints(cloud, points_);
  const Instant instant = waitForInstant(cloud.header, generation, robot);
  const ros::WallTime start = ros::WallTime::now();
  const auto voxels =
      gatherer_.add(points_, instant.X_WS, instant.robot, cloud.header.stamp.toSec(), robot.filter);
  last_stamp_ = cloud.header.stamp;
  const double measured = measuredAt(cloud.header.stamp.toSec(), arrived.toSec());
  keep(voxels, measured, generation, robot, (ros::WallTime::now() - start).toSec());
  if (!gatherer_.warning().empty()) tell(gatherer_.warning());
  publishKept(cloud.header);
}

void CloudSource::keep(const std::shared_ptr<const OccupiedVoxels>& voxels, double measured,
                       unsigned generation, const FollowedRobot& robot, double processing) {
  const ros::SteadyTime now = ros::SteadyTime::now();
  const std::lock_guard<std::mutex> lock(mutex_);
  if (generation != generation_) return;  // cleared meanwhile
  latest_ = {voxels, measured, "", gatherer_.warning(), gatherer_.mayTouch()};
  latest_robot_ = robot.number;
  latest_clock_jumps_ = nb_clock_jumps_;
  const double rate = 1.0 / std::max((now - last_use_).toSec(), 1e-6);
  if (health_.used == 1) health_.rate = rate;
  if (health_.used > 1) health_.rate += SHARE_OF_NEWEST * (rate - health_.rate);
  last_use_ = now;
  ++health_.used;
  health_.latency = ros::Time::now().toSec() - measured;
  health_.processing = processing;
  health_.points = points_.size();
  health_.kept = gatherer_.kept().size();
  health_.voxels = voxels->size();
}

void CloudSource::requireUsableStamp(const ros::Time& stamp, const ros::Time& now) {
  if (now.isZero()) throw InputError(NO_CLOCK);
  if (stamp.isZero()) throw InputError("its stamp is zero");
  const double age = secondsBetween(stamp, now);
  if (-age > context_.transforms.limits().clock_tolerance) {
    throw InputError("its stamp is " + inWords(-age) + " ahead of the clock");
  }
  if (config_.source_timeout > 0.0 && age > config_.source_timeout) {
    throw InputError("it was " + inWords(age) + " old when it arrived, and source_timeout is " +
                     inWords(config_.source_timeout));
  }
  if (!last_stamp_.isZero() && stamp <= last_stamp_) {
    throw InputError(
        "its stamp is not later than that of the previous cloud: are there two publishers?");
  }
}

void CloudSource::tell(const std::string& what) {
  const ros::SteadyTime now = ros::SteadyTime::now();
  if (now < next_telling_) return;
  next_telling_ = now + TELL_PERIOD;
  ROS_WARN_STREAM("cloud '" << config_.name() << "': " << what);
}

CloudSource::Missing CloudSource::lookUp(const std_msgs::Header& header, const FollowedRobot& robot,
                                         Instant& found) {
  try {
    found.X_WS = robot.poses.lookUp(context_.frame, header.frame_id, header.stamp).X_TS;
  } catch (const NotConnected& error) {
    return {error.what(), false};
  } catch (const InputError& error) {
    return {error.what()};
  }
  StampedPoses stamped = robot.poses.at(header.stamp);
  if (!stamped.problems.empty()) return {stamped.problems.front()};
  found.robot = std::move(stamped.poses);
  return {};
}

CloudSource::Instant CloudSource::waitForInstant(const std_msgs::Header& header,
                                                 unsigned generation, const FollowedRobot& robot) {
  const ros::SteadyTime end = ros::SteadyTime::now() + LONGEST_WAIT;
  Instant found;
  while (true) {
    // Read first: messages that arrive later are considered in the next attempt.
    const std::uint64_t nb_taken = context_.transforms.nbTaken();
    const Missing missing = lookUp(header, robot, found);
    if (missing.why.empty()) return found;
    const std::string problem = "TF has no poses of the sensor ('" + header.frame_id +
                                "') and the robot at its stamp: " + missing.why;
    do {
      std::unique_lock<std::mutex> lock(mutex_);
      if (!missing.is_connected && generation == generation_) latest_.problem = problem;
      wakes_worker_.wait_for(lock, PAUSE, [this] { return stopping_; });
      if (stopping_ || ros::SteadyTime::now() >= end) throw InputError(problem);
    } while (context_.transforms.nbTaken() == nb_taken);
  }
}

void CloudSource::publishKept(const std_msgs::Header& header) const {
  if (context_.filtered_cloud.getNumSubscribers() == 0) return;
  context_.filtered_cloud.publish(toPointCloud2(gatherer_.kept(), header));
}

CloudView CloudSource::view(const ros::Time& now) const {
  const std::lock_guard<std::mutex> lock(mutex_);
  const bool is_outdated =
      latest_.voxels && latest_clock_jumps_ != context_.transforms.nbClockJumps();
  const auto doubtSince = [&](const std::string& event) {
    return "cloud '" + config_.name() + "': none has arrived since " + event + refusalOf(latest_);
  };
  CloudView view;
  if (is_outdated) {
    view.doubt = doubtSince("the clock went back");
    return view;
  }
  view = viewOf(config_, latest_, now.toSec(), subscriber_.getTopic());
  if (view.voxels && view.doubt.empty() && latest_robot_ < complete_from_) {
    view.doubt = doubtSince("the robot, or what is attached to it, changed");
  }
  return view;
}

void CloudSource::clear() {
  const std::lock_guard<std::mutex> lock(mutex_);
  ++generation_;
  next_ = nullptr;
  latest_ = {};
}

CloudHealth CloudSource::health() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  CloudHealth health = health_;
  if ((ros::SteadyTime::now() - last_use_) > SILENCE) health.rate = 0.0;
  return health;
}

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

void CloudSources::follow(FollowedRobots filters, bool may_keep_more) {
  for (std::size_t i = 0; i < sources_.size(); ++i) {
    sources_[i]->follow(std::move(filters[i]), may_keep_more);
  }
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
