#include "simulated_node.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <boost/make_shared.hpp>

#include "object_messages.h"
#include "point_cloud.h"

namespace simulation {
namespace {

const char* const CLOUD = "points";
constexpr double SOURCE_TIMEOUT = 1.0, SELF_FILTER = 0.02;

Pose motionOf(SimulatedLink::Joint joint, const Pose& at) {
  switch (joint) {
    case SimulatedLink::FLOATING:
      return at;
    case SimulatedLink::SLIDING:
      return {at.x, 0.0, 0.0, 0.0};
    case SimulatedLink::TURNING:
      return {0.0, 0.0, 0.0, at.yaw};
    case SimulatedLink::FIXED:
      return {};
  }
  return {};
}

std::string urdfOf(const Scenario& setup) {
  std::string urdf = emptyLink("root");
  for (int i = 0; i < static_cast<int>(setup.links.size()); ++i) {
    const SimulatedLink& link = setup.links[static_cast<std::size_t>(i)];
    const char* const types[] = {"floating", "prismatic", "continuous", "fixed"};
    const char* const axes[] = {"", "<axis xyz='1 0 0'/><limit lower='-1e6' upper='1e6'/>",
                                "<axis xyz='0 0 1'/>", ""};
    urdf += linkWith(linkName(i), "<sphere radius='" + std::to_string(link.radius) + "'/>") +
            joint("j" + std::to_string(i), types[link.joint], linkName(link.parent), linkName(i),
                  "0 " + std::to_string(link.X_PJ.y) + " 0", axes[link.joint]);
  }
  return urdf;
}

/// As the URDF rounds it.
Scenario asWritten(Scenario setup) {
  for (SimulatedLink& link : setup.links) link.radius = std::stod(std::to_string(link.radius));
  return setup;
}

geometry_msgs::Pose message(const Pose& pose) {
  geometry_msgs::Pose made = poseAt(pose.x, pose.y, pose.z);
  made.orientation.w = std::cos(0.5 * pose.yaw);
  made.orientation.z = std::sin(0.5 * pose.yaw);
  return made;
}

}  // namespace

SimulatedNode::SimulatedNode(const Scenario& setup)
    : setup_(asWritten(setup)),
      monitor_({{setup.max_pose_age, setup.max_transform_age, CLOCK_TOLERANCE},
                setup.is_simulated,
                setup.allow_paused}),
      knowledge_(setup_),
      last_(setup.links.size()),
      X_LC_(setup.X_LC) {
  if (std::any_of(setup_.links.begin(), setup_.links.end(), SimulatedLimiter::isMeasured)) {
    limiter_.emplace(setup_, knowledge_);
  }
  advance(0.0);
  load(monitor_, parameters({}));
  ++revision_;
}

SceneParameters SimulatedNode::parameters(const std::set<int>& ignored) const {
  SceneParameters made = parametersOf(urdfOf(setup_));
  SceneConfig& config = made.sources.config;
  for (const int link : ignored) config.settings.ignored_links.push_back({linkName(link)});
  if (setup_.has_cloud) {
    CloudConfig cloud;
    cloud.topic = CLOUD;
    cloud.voxel_size = 0.05;
    cloud.source_timeout = SOURCE_TIMEOUT;
    cloud.max_range = 100.0;
    cloud.self_filter_padding = SELF_FILTER;
    config.clouds = {cloud};
    made.sources.clouds = {obstacleOf(cloud)};
  }
  return made;
}

void SimulatedNode::fail(const std::string& what) {
  if (violation_.empty()) violation_ = what;
}

std::string SimulatedNode::reasons() const {
  std::string all;
  for (const std::string& reason : report_.unknown_because) all += reason + "; ";
  return all;
}

void SimulatedNode::advance(double dt) {
  steady_ += dt;
  ros_ += static_cast<Ns>(std::llround(1e9 * dt * speed_));
  ros::Time now;
  now.fromNSec(static_cast<std::uint64_t>(ros_));
  monitor_.advance({now, steady_});
  const int pass = knowledge_.pass();
  knowledge_.moveClock(ros_, steady_);
  if (limiter_) limiter_->advance(ros_, steady_, monitor_.transforms().nbClockJumps());
  if (knowledge_.pass() == pass) return;
  seen_.reset();
  last_cloud_ = 0;
}

Ns SimulatedNode::stampOf(double lag) const {
  return ros_ - static_cast<Ns>(std::llround(1e9 * lag));
}

void SimulatedNode::publish(int link, Ns stamp, const Pose& X_PB, const std::string& publisher,
                            bool is_static) {
  const int parent = setup_.links[static_cast<std::size_t>(link)].parent;
  tf2_msgs::TFMessage tf = transformOf(linkName(parent), linkName(link), ros::Time(), 0.0);
  tf.transforms[0].header.stamp.fromNSec(static_cast<std::uint64_t>(stamp));
  const geometry_msgs::Pose pose = message(X_PB);
  tf.transforms[0].transform.translation.x = X_PB.x;
  tf.transforms[0].transform.translation.y = X_PB.y;
  tf.transforms[0].transform.translation.z = X_PB.z;
  tf.transforms[0].transform.rotation = pose.orientation;
  monitor_.take(tf, is_static, publisher);
}

void SimulatedNode::publishBroken(const Event& event) {
  const int parent = setup_.links[static_cast<std::size_t>(event.who)].parent;
  tf2_msgs::TFMessage tf = transformOf(linkName(parent), linkName(event.who), ros::Time(), 1000.0);
  auto& transform = tf.transforms[0];
  transform.header.stamp.fromNSec(static_cast<std::uint64_t>(ros_));
  const double nan = std::numeric_limits<double>::quiet_NaN();
  switch (event.what) {
    case 0:
      transform.transform.translation.x = nan;
      break;
    case 1:
      transform.transform.rotation.w = nan;
      break;
    case 2:
      transform.transform.rotation.w = 2.0;
      break;
    case 3:
      transform.header.stamp = ros::Time();
      break;
    case 4:
      transform.header.stamp += ros::Duration(0.6);
      break;
    case 5:
      transform.header.stamp += ros::Duration(3600.0);
      break;
    case 6:
      transform.header.frame_id = transform.child_frame_id;
      break;
    default:
      transform.header.frame_id = "";
  }
  monitor_.take(tf, false, "honest");
}

void SimulatedNode::publishCamera(const Pose& X_LC) {
  tf2_msgs::TFMessage tf =
      transformOf(linkName(setup_.camera_on), "camera", ros::Time(1.0), X_LC.x);
  tf.transforms[0].transform.translation.y = X_LC.y;
  tf.transforms[0].transform.rotation = message(X_LC).orientation;
  monitor_.take(tf, true, "mount");
  X_LC_ = X_LC;
  is_camera_told_ = true;
}

void SimulatedNode::happen(const Event& event) {
  advance(event.dt);
  const auto joint = setup_.links[static_cast<std::size_t>(event.who)].joint;
  switch (event.kind) {
    case Event::PUBLISH:
      if (joint != SimulatedLink::FIXED) {
        const auto& of = setup_.links[static_cast<std::size_t>(event.who)];
        auto& last = last_[static_cast<std::size_t>(event.who)];
        last = {stampOf(event.lag), of.X_PJ * motionOf(joint, event.at)};
        publish(event.who, last.first, last.second, "honest");
        knowledge_.hear(event.who, last.first, last.second);
      }
      break;
    case Event::REPEAT:
      if (const auto& last = last_[static_cast<std::size_t>(event.who)]; last.first > 0) {
        publish(event.who, last.first, last.second, "repeats");
        knowledge_.hear(event.who, last.first, last.second);
      }
      break;
    case Event::BREAK:
      if (joint != SimulatedLink::FIXED) publishBroken(event);
      break;
    case Event::LIE:
      if (joint != SimulatedLink::FIXED) {
        publish(event.who, stampOf(event.lag), {1000.0, 0.0, 0.0, 0.0}, "liar", event.what == 1);
        knowledge_.hearLie(event.who, stampOf(event.lag), event.what == 1);
      }
      break;
    case Event::CAMERA:
      if (setup_.has_cloud) publishCamera(setup_.X_LC);
      break;
    case Event::STEP_CLOCK:
      ros_ = std::max<Ns>(1, ros_ + static_cast<Ns>(1e9 * 3.0 * event.number));
      advance(0.0);
      break;
    case Event::RUN_CLOCK:
      speed_ = std::max(0.0, 2.0 * event.number);
      break;
    case Event::CLOUD:
      sendCloud(event);
      break;
    case Event::CLOUD_BEGIN:
      beginCloud();
      break;
    case Event::CLOUD_END:
      endCloud();
      break;
    case Event::CLEAR:
      monitor_.clearClouds();
      ++cloud_generation_;
      seen_.reset();
      last_cloud_ = 0;
      break;
    case Event::SCENE_BEGIN:
      beginScene(event);
      break;
    case Event::SCENE_END:
      endScene(event.what % 2 == 0);
      break;
    case Event::JOINTS:
      if (limiter_) limiter_->hear(event);
      break;
    default:
      break;
  }
  report();
}

void SimulatedNode::sendCloud(const Event& event) {
  if (!setup_.has_cloud) return;
  const Ns stamp = event.what == 7 ? 0 : stampOf(event.lag);
  const auto X_WL = knowledge_.poseOf(setup_.camera_on, stamp);
  const Pose X_CW = inverse(X_WL.value_or(Pose()) * X_LC_);
  std::vector<Pose> points;
  if (event.what != 5) {
    points = {{4.0, 0.0, 1.0, 0.0}, {4.0, 0.1, 1.0, 0.0}};  // a wall far away
    for (int i = 0; i < 4; ++i) {
      points.push_back(X_CW * Pose{event.at.x + 0.01 * i, event.at.y, event.at.z, 0.0});
    }
  }
  std::vector<Eigen::Vector3d> sent;
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const Pose& p : points) {
    sent.emplace_back(event.what == 6 ? nan : p.x, p.y, p.z);
  }
  std_msgs::Header header;
  header.frame_id = "camera";
  header.stamp.fromNSec(static_cast<std::uint64_t>(std::max<Ns>(0, stamp)));
  const auto cloud =
      boost::make_shared<const sensor_msgs::PointCloud2>(toPointCloud2(sent, header));
  for (const auto& source : monitor_.scenes().active()->clouds) source->take(cloud);
  sent_[stamp] = points;
  arrivals_[stamp] = seconds(ros_);
}

void SimulatedNode::beginCloud() {
  if (!setup_.has_cloud) return;
  const auto job = monitor_.scenes().active()->clouds.front()->next();
  if (!job) return;
  if (cloud_work_) return fail("a cloud is handed out while another is being processed");
  const Ns stamp = static_cast<Ns>(job->header().stamp.toNSec());
  const auto X_WL = knowledge_.poseOf(setup_.camera_on, stamp);
  const bool can_be_known = is_camera_told_ && (X_WL || knowledge_.isLiedAbout(setup_.camera_on));
  if (!can_be_known) return fail("a cloud is processed whose camera is nowhere");
  cloud_work_ = job;
  cloud_work_generation_ = cloud_generation_;
  cloud_work_pass_ = knowledge_.pass();
  cloud_work_revision_ = revision_;
  cloud_points_.clear();
  if (!X_WL || knowledge_.isLiedAbout(setup_.camera_on)) return;
  for (const Pose& p : sent_[stamp]) {
    const Pose in_world = *X_WL * X_LC_ * p;
    bool is_own = false;  // or it may be
    for (int i = 0; i < static_cast<int>(setup_.links.size()); ++i) {
      const auto X_WB = knowledge_.poseOf(i, stamp);
      const double radius = setup_.links[static_cast<std::size_t>(i)].radius;
      is_own = is_own || !X_WB || knowledge_.isLiedAbout(i) ||
               distance({false, radius, {}}, *X_WB, {}, in_world) < SELF_FILTER + 1e-3;
    }
    for (const auto& [name, object] : objects_) {
      const auto X_WB = knowledge_.poseOf(object.link, stamp);
      is_own = is_own || (object.link >= 0 && (!X_WB || distance(object.solid, *X_WB * object.X_PO,
                                                                 {}, in_world) < 0.15));
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
  monitor_.scenes().active()->clouds.front()->take(*job);
  const bool is_of_now =
      cloud_work_generation_ == cloud_generation_ && cloud_work_pass_ == knowledge_.pass();
  if (!is_used || !is_of_now) return;
  const Ns stamp = static_cast<Ns>(job->header().stamp.toNSec());
  if (stamp <= last_cloud_) fail("a cloud is used after a later one");
  last_cloud_ = stamp;
  // It may have been filtered by what was attached before.
  if (cloud_work_revision_ < complete_revision_) return;
  seen_ = Seen{std::min(seconds(stamp), arrivals_[stamp]), cloud_points_};
}

}  // namespace simulation
