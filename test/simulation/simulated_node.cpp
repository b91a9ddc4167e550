#include "simulated_node.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "object_messages.h"

namespace simulation {
namespace {

/// Far from its parent: the same pose has other numbers in it.
const Pose X_PM{5000.0, 0.0, 0.0, 0.2};

std::string mountName(int parent) { return "mount_of_" + linkName(parent); }

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

std::string text(const Scenario& setup, const Pose& p) {
  const auto at = setup.inSpace(p);
  return std::to_string(at[0]) + ' ' + std::to_string(at[1]) + ' ' + std::to_string(at[2]);
}

/// Of link `broken` a mesh cannot be read; -1: of none. `robot`: its base; -1: there is one robot,
/// whose root is the frame of the reports.
std::string urdfOf(const Scenario& setup, int broken, int robot) {
  std::string urdf = robot < 0 ? emptyLink("root") : "";
  for (int i = 0; i < static_cast<int>(setup.links.size()); ++i) {
    const SimulatedLink& link = setup.links[static_cast<std::size_t>(i)];
    if (robot >= 0 && setup.baseOf(i) != robot) continue;
    const char* const types[] = {"floating", "prismatic", "continuous", "fixed"};
    const std::string axes[] = {
        "", "<axis xyz='" + text(setup, {1, 0, 0, 0}) + "'/><limit lower='-1e6' upper='1e6'/>",
        "<axis xyz='" + text(setup, {0, 0, 1, 0}) + "'/>", ""};
    const std::string ball = "<sphere radius='" + std::to_string(link.radius) + "'/>";
    const std::string inner = "<collision><geometry><sphere radius='" +
                              std::to_string(0.5 * link.radius) + "'/></geometry></collision>";
    const std::string mesh =
        "<collision><geometry><mesh filename='package://none/a.stl'/></geometry></collision>";
    urdf += "<link name='" + linkName(i) + "'><collision><geometry>" + ball +
            "</geometry></collision>" + (link.is_double ? inner : "") + (i == broken ? mesh : "") +
            "</link>";
    if (i == robot) continue;
    urdf += joint("j" + std::to_string(i), types[link.joint], linkName(link.parent), linkName(i),
                  text(setup, link.X_PJ), axes[link.joint]);
  }
  if (setup.has_mast && (robot < 0 || setup.baseOf(setup.camera_on) == robot)) {
    urdf += emptyLink("mast") + joint("j_mast", "continuous", linkName(setup.camera_on), "mast",
                                      "0 0 0", "<axis xyz='" + text(setup, {0, 0, 1, 0}) + "'/>");
  }
  return urdf;
}

/// As the URDF rounds it.
Scenario asWritten(Scenario setup) {
  for (SimulatedLink& link : setup.links) link.radius = std::stod(std::to_string(link.radius));
  return setup;
}

}  // namespace

geometry_msgs::Pose SimulatedNode::message(const Pose& pose) const {
  const auto p = setup_.inSpace(pose);
  const auto q = setup_.quaternion(pose.yaw);
  geometry_msgs::Pose made = poseAt(p[0], p[1], p[2]);
  made.orientation.x = q[0];
  made.orientation.y = q[1];
  made.orientation.z = q[2];
  made.orientation.w = q[3];
  return made;
}

Eigen::Vector3d SimulatedNode::inSpace(const Pose& pose) const {
  const auto p = setup_.inSpace(pose);
  return {p[0], p[1], p[2]};
}

void SimulatedNode::place(geometry_msgs::TransformStamped& transform, const Pose& pose) const {
  const geometry_msgs::Pose made = message(pose);
  transform.transform.translation.x = made.position.x;
  transform.transform.translation.y = made.position.y;
  transform.transform.translation.z = made.position.z;
  transform.transform.rotation = made.orientation;
}

SimulatedNode::SimulatedNode(const Scenario& setup)
    : setup_(asWritten(setup)),
      monitor_({{setup.max_pose_age, setup.max_transform_age, CLOCK_TOLERANCE},
                setup.is_simulated,
                setup.allow_paused}),
      knowledge_(setup_),
      last_(setup.links.size()),
      X_LC_(setup.X_LC) {
  for (const SimulatedLink& link : setup_.links) stands_.push_back(link.is_static);
  if (std::any_of(setup_.links.begin(), setup_.links.end(), SimulatedLimiter::isMeasured)) {
    limiter_.emplace(setup_, knowledge_);
  }
  advance(0.0);
  if (setup_.is_marked) {
    publish(linkName(setup_.fixed_frame), setup_.frame(), 0, Pose(), "mark", true);
  }
  for (int i = 0; i < static_cast<int>(setup_.links.size()); ++i) {
    if (setup_.of(i).is_led_away) publish("apart", linkName(i), 0, X_PM, "mount", true);
  }
  load(monitor_, parameters(settings_));
  ++revision_;
  changed_ = ros_;
}

SceneParameters SimulatedNode::parameters(const PlainSettings& wanted) const {
  SceneParameters made;
  if (!setup_.is_apart) made = parametersOf(urdfOf(setup_, wanted.broken, -1));
  const bool is_root = !setup_.is_apart && !setup_.is_marked && setup_.fixed_frame < 0;
  if (!is_root) made.fixed_frame = setup_.frame();
  for (int i = 0; i < static_cast<int>(setup_.links.size()); ++i) {
    if (!setup_.isBase(i)) continue;
    auto robots = std::move(parametersOf(urdfOf(setup_, wanted.broken, i)).sources.robots);
    made.sources.robots.push_back(std::move(robots.front()));
  }
  if (setup_.has_world) {
    const std::string ball = "<collision><origin xyz='500 0 500'/><geometry><sphere radius='1'/>";
    made.sources.world = std::make_unique<RobotSource>(
        "<robot name='world'><link name='far'>" + ball + "</geometry></collision></link></robot>",
        noMeshes);
  }
  std::string settings = "ignored_links: [";
  for (const int link : wanted.ignored) settings += linkName(link);
  settings += "]\nstatic_joints: [";
  for (int i = 0; i < static_cast<int>(setup_.links.size()); ++i) {
    const bool is_listed = setup_.links[static_cast<std::size_t>(i)].is_listed;
    if (is_listed && !setup_.isBase(i)) settings += jointName(i) + ", ";
  }
  if (setup_.is_mast_listed && setup_.has_mast) settings += "j_mast";
  settings += "]\npadding: " + std::to_string(wanted.padding) + '\n';
  if (setup_.has_cloud) {
    settings += "clouds: [{topic: points, voxel_size: 0.05, source_timeout: " +
                std::to_string(wanted.source_timeout) +
                ", max_range: " + std::to_string(MAX_RANGE) +
                ", self_filter_padding: " + std::to_string(SELF_FILTER) + "}]\n";
    made.cloud_topics = {"/points"};
  }
  made.sources.readSettings({"settings", settings});
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
  if (clock_ > 0) clock_ += static_cast<Ns>(std::llround(1e9 * dt * speed_));
  if (clock_ == 0 && steady_ >= setup_.clock_begins) clock_ = BEGIN;
  ros::Time now;
  now.fromNSec(static_cast<std::uint64_t>(clock_));
  monitor_.advance({now, steady_});
  const int pass = knowledge_.pass();
  const double back = seconds(ros_ - clock_);
  knowledge_.moveClock(clock_, steady_);
  ros_ = knowledge_.now();
  if (limiter_) limiter_->advance(clock_, steady_, monitor_.transforms().nbClockJumps());
  if (knowledge_.pass() == pass) return;
  for (auto& [link, refusal] : refusals_) refusal = {"", -1e9};
  seen_.reset();
  was_lost_ = (was_lost_ || is_lost_) && !(setup_.is_simulated && back > NEW_RUN);
  is_lost_ = false;
  changed_ = 0;
  last_cloud_ = 0;
}

Ns SimulatedNode::stampOf(double lag) const {
  return std::max<Ns>(0, clock_ - static_cast<Ns>(std::llround(1e9 * lag)));
}

void SimulatedNode::take(const tf2_msgs::TFMessage& tf, bool is_static,
                         const std::string& publisher) {
  const TransformInput& transforms = monitor_.transforms();
  nb_refused_ = transforms.nbRefused();
  const std::uint64_t nb_taken = transforms.nbTaken();
  monitor_.take(tf, is_static, publisher);
  if (transforms.nbTaken() != nb_taken + 1) fail("another number of transforms is counted");
}

void SimulatedNode::publish(const std::string& parent, const std::string& link, Ns stamp,
                            const Pose& X_PB, const std::string& publisher, bool is_static) {
  // Older nodes begin names with a slash.
  const bool has_slash = monitor_.transforms().nbTaken() % 7 == 0;
  tf2_msgs::TFMessage tf = transformOf((has_slash ? "/" : "") + parent, link, ros::Time(), 0.0);
  tf.transforms[0].header.stamp.fromNSec(static_cast<std::uint64_t>(stamp));
  place(tf.transforms[0], X_PB);
  take(tf, is_static, publisher);
}

/// As /tf, or /tf_static, has it.
void SimulatedNode::publish(int link, const std::string& publisher) {
  const SimulatedLink& of = setup_.links[static_cast<std::size_t>(link)];
  const auto& [stamp, X_PB] = last_[static_cast<std::size_t>(link)];
  const bool stands = stands_[static_cast<std::size_t>(link)];
  const bool is_rehung = X_PB.is_rehung;
  publish(is_rehung ? mountName(of.parent) : linkName(of.parent), setup_.hungFrame(link), stamp,
          (is_rehung ? inverse(X_PM) : Pose()) * X_PB * setup_.inHung(link), publisher, stands);
  const bool is_new = knowledge_.told(link).samples.count(stamp) == 0;
  knowledge_.hear(link, stamp, X_PB, stands, publisher);
  noteHeard(link, stamp, is_new);
}

void SimulatedNode::lie(const Event& event) {
  const Pose elsewhere{1000.0 + 300.0 * event.other, 0.0, 0.0, 0.0};
  Ns stamp = stampOf(event.lag);
  if (event.what == 3) {
    publish(linkName(setup_.cycle_through), linkName(-1), stamp, elsewhere, "liar", false);
    return knowledge_.hearRootLie(stamp);
  }
  const SimulatedLink& of = setup_.links[static_cast<std::size_t>(event.who)];
  if (of.joint == SimulatedLink::FIXED) return;
  std::string parent = linkName(of.parent);
  if (event.what == 4) stamp = last_[static_cast<std::size_t>(event.who)].first;
  const bool is_other = event.other != event.who && event.other != of.parent &&
                        linkName(event.other) != setup_.hungFrame(event.who);
  if (event.what == 2) parent = is_other ? linkName(event.other) : "nowhere";
  const std::string publisher = "liar" + std::to_string(event.other % 2);
  // In another parent it may have the same numbers.
  const bool is_same = event.what == 2 && event.number > 0.0, is_near = event.what > 5;
  Pose X_PB =
      is_same || is_near ? Pose(last_[static_cast<std::size_t>(event.who)].second) : elsewhere;
  if (is_near) X_PB.x += event.number;
  publish(parent, setup_.hungFrame(event.who), stamp, X_PB * setup_.inHung(event.who), publisher,
          event.what == 1);
  knowledge_.hearLie(event.who, {stamp, X_PB, event.what == 2}, event.what == 1);
  refusals_.erase(event.who);
}

void SimulatedNode::publishBroken(const Event& event) {
  const int parent = setup_.links[static_cast<std::size_t>(event.who)].parent;
  tf2_msgs::TFMessage tf =
      transformOf(linkName(parent), setup_.hungFrame(event.who), ros::Time(), 1000.0);
  auto& transform = tf.transforms[0];
  const char* const words[] = {"not finite", "not finite",   "its quaternion is of length",
                               "is zero",    "ahead of the", "ahead of the",
                               "own parent", "has no name"};
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
  take(tf, false, "honest");
  noteTransform(event.who, ros_ > 0 ? words[event.what] : "");
}

void SimulatedNode::publishCamera(const Pose& X_LC) {
  const std::string link = linkName(setup_.camera_on);
  tf2_msgs::TFMessage tf =
      transformOf(setup_.has_mast ? "mast" : link, "camera", ros::Time(1.0), 0.0);
  place(tf.transforms[0], X_LC);
  if (setup_.has_mast) {
    tf.transforms.push_back(transformOf(link, "mast", ros::Time(1.0), 0.0).transforms[0]);
  }
  take(tf, true, "mount");
  X_LC_ = X_LC;
  is_camera_told_ = true;
}

void SimulatedNode::happen(const Event& event) {
  advance(event.dt);
  const auto joint = setup_.links[static_cast<std::size_t>(event.who)].joint;
  switch (event.kind) {
    case Event::PUBLISH:
      if (const auto& of = setup_.links[static_cast<std::size_t>(event.who)];
          joint != SimulatedLink::FIXED || of.is_static) {
        auto& last = last_[static_cast<std::size_t>(event.who)];
        // Some come exactly as long after the one before as is allowed.
        const Ns gap = static_cast<Ns>(1e9 * setup_.max_transform_age), next = last.first + gap;
        const bool is_exact = event.what == 7 && std::abs(next - clock_) < static_cast<Ns>(4e8);
        last = {is_exact ? next : stampOf(event.lag),
                {of.X_PJ * motionOf(joint, event.at), last.second.is_rehung}};
        publish(event.who, "honest");
        if (of.is_relayed) publish(event.who, "relay");
      }
      break;
    case Event::SWITCH:
      if (joint == SimulatedLink::FIXED) break;
      stands_[static_cast<std::size_t>(event.who)] ^= 1;
      last_[static_cast<std::size_t>(event.who)].first = 0;
      break;
    case Event::REHANG: {
      if (joint == SimulatedLink::FIXED && !stands_[static_cast<std::size_t>(event.who)]) break;
      const int parent = setup_.links[static_cast<std::size_t>(event.who)].parent;
      publish(linkName(parent), mountName(parent), 0, X_PM, "mount", true);
      last_[static_cast<std::size_t>(event.who)].first = 0;
      last_[static_cast<std::size_t>(event.who)].second.is_rehung ^= true;
      break;
    }
    case Event::REPEAT:
      if (last_[static_cast<std::size_t>(event.who)].first > 0) publish(event.who, "repeats");
      break;
    case Event::BREAK:
      if (joint != SimulatedLink::FIXED) publishBroken(event);
      break;
    case Event::LIE:
      lie(event);
      break;
    case Event::CAMERA:
      if (setup_.has_cloud) publishCamera(setup_.X_LC);
      break;
    case Event::STEP_CLOCK:
      if (clock_ > 0) {
        const double most = event.what < 3   ? 0.1
                            : event.what < 6 ? 0.5
                            : event.what < 7 ? 3.0
                                             : 8.0;
        clock_ = std::max<Ns>(1, clock_ + static_cast<Ns>(1e9 * most * event.number));
      }
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
      clearClouds();
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
  if (event.kind == Event::REQUEST) request(event);
}

}  // namespace simulation
