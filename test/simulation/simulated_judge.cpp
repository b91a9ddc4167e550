// The claims about a SimulatedNode.
#include <algorithm>
#include <cmath>
#include <functional>

#include "simulated_node.h"

namespace simulation {
namespace {

constexpr double ROUNDING = 1e-6;  // m
constexpr double SOURCE_TIMEOUT = 1.0;

void mix(std::size_t& digest, std::size_t value) {
  digest = digest * 1099511628211u + value + 0x9e3779b97f4a7c15u;
}

}  // namespace

void SimulatedNode::report() {
  const ActiveScenePtr scene = monitor_.scenes().active();
  if (!detector_ || &detector_->scene() != scene->scene.get()) {
    detector_ = std::make_unique<CollisionDetector>(scene->scene);
  }
  const Snapshot snapshot = monitor_.at(scene);
  report_ = detector_->detect(snapshot.poses, {});
  ++counts[report_.verdict];
  mix(digest_, static_cast<std::size_t>(report_.verdict));
  mix(digest_, static_cast<std::size_t>(snapshot.stamp.toNSec()));
  mix(digest_, std::hash<std::string>()(reasons()));
  judge(snapshot);
}

void SimulatedNode::judge(const Snapshot& snapshot) {
  const bool is_unknown = report_.verdict == Verdict::UNKNOWN;
  if (is_unknown == report_.unknown_because.empty()) fail("UNKNOWN and its reasons do not agree");
  if (report_.verdict != Verdict::COLLISION && !snapshot.poses.doubts.empty() && !is_unknown) {
    fail("FREE in spite of doubts");
  }
  judgeBodies(snapshot);
  judgeReasons(snapshot);
  if (report_.verdict == Verdict::FREE) judgeFree(snapshot);
  judgeAgreement(snapshot);
  if (limiter_) {
    const std::string wrong = limiter_->violation(monitor_);
    if (!wrong.empty()) fail(wrong);
    nb_limited += limiter_->doubt().empty() ? 1 : 0;
  }
  judgeMemory();
}

/// A pose that is known is one that may be known.
void SimulatedNode::judgeBodies(const Snapshot& snapshot) {
  const CollisionScene& scene = *snapshot.scene->scene;
  const Ns stamp = static_cast<Ns>(snapshot.stamp.toNSec());
  for (int link = 0; link < static_cast<int>(setup_.links.size()); ++link) {
    const int model = scene.findModel(linkName(link));
    if (model < 0) continue;
    const int body = scene.models()[static_cast<std::size_t>(model)].body;
    if (body < 0) continue;
    const bool is_known = snapshot.poses.known[static_cast<std::size_t>(body)] != 0;
    if (!is_known || knowledge_.isLiedAbout(link)) continue;
    if (knowledge_.isTooOld(stamp)) fail("the pose of a link is too old");
    if (!knowledge_.poseOf(link, stamp)) fail(linkName(link) + " is known, but nobody said so");
  }
}

/// What is said to be old is old, and whose clock is said to stand stands.
void SimulatedNode::judgeReasons(const Snapshot& snapshot) {
  const double rounding = 0.02;  // s: ages are said with two digits
  for (const std::string& doubt : snapshot.poses.doubts) {
    const auto says = [&](const char* words) { return doubt.find(words) != std::string::npos; };
    if (says("/clock stands still") && !knowledge_.isClockInDoubt()) fail("it runs: " + doubt);
    if (says("cloud 'points': the newest is") && seen_ &&
        seconds(ros_) - seen_->measured < SOURCE_TIMEOUT - rounding) {
      fail("it is young: " + doubt);
    }
    if (!says("and max_pose_age is")) continue;
    for (int link = 0; link < static_cast<int>(setup_.links.size()); ++link) {
      const bool is_of_link = doubt.rfind("link '" + linkName(link) + "'", 0) == 0;
      if (!is_of_link || knowledge_.isLiedAbout(link)) continue;
      if (!knowledge_.hasOldOn(link, setup_.max_pose_age - rounding)) fail("it is young: " + doubt);
    }
  }
}

void SimulatedNode::judgeFree(const Snapshot& snapshot) {
  const Ns stamp = static_cast<Ns>(snapshot.stamp.toNSec());
  if (knowledge_.isClockInDoubt()) fail("FREE although the clock stands still");
  if (knowledge_.isTooOld(stamp)) fail("FREE although the poses are too old");
  if (ignored_.empty() && knowledge_.isBehind(stamp)) fail("FREE although a link lags behind");
  const int nb_links = static_cast<int>(setup_.links.size());
  std::vector<std::optional<Pose>> at;
  for (int link = 0; link < nb_links; ++link) {
    at.push_back(knowledge_.poseOf(link, stamp));
    if (ignored_.count(link) > 0) continue;
    if (!at.back() && !knowledge_.isLiedAbout(link)) return fail("FREE although a link is nowhere");
    if (knowledge_.isInDoubt(link, stamp)) fail("FREE although two nodes contradict each other");
  }
  const auto solidOf = [&](int link) {
    return Solid{false, setup_.links[static_cast<std::size_t>(link)].radius, {}};
  };
  const auto require = [&](double gap, const std::string& a, const std::string& b) {
    if (gap <= -ROUNDING) fail("FREE although " + a + " touches " + b);
  };
  for (int i = 0; i < nb_links; ++i) {
    for (int j = 0; j < i; ++j) {
      const int parent = setup_.links[static_cast<std::size_t>(i)].parent;
      const bool is_checked = at[i] && at[j] && bodyOf(i) != bodyOf(j) && parent != j &&
                              ignored_.count(i) + ignored_.count(j) == 0 &&
                              setup_.links[static_cast<std::size_t>(j)].parent != i;
      if (is_checked && !areAdjacent(i, j)) {
        require(distance(solidOf(i), *at[i], solidOf(j), *at[j]), linkName(i), linkName(j));
      }
    }
  }
  for (const auto& [name, object] : objects_) {
    const bool is_placed = object.link < 0 || at[static_cast<std::size_t>(object.link)];
    if (!is_placed) continue;
    const Pose X_WO =
        object.link < 0 ? object.X_PO : *at[static_cast<std::size_t>(object.link)] * object.X_PO;
    for (int i = 0; i < nb_links; ++i) {
      if (!at[i] || !isCheckedAgainst(i, object)) continue;
      require(distance(solidOf(i), *at[i], object.solid, X_WO), linkName(i), name);
    }
    for (const auto& [other_name, other] : objects_) {
      if (object.link < 0 || other.link >= 0) continue;
      require(distance(object.solid, X_WO, other.solid, other.X_PO), name, other_name);
    }
  }
  if (!setup_.has_cloud) return;
  if (!seen_) return fail("FREE although no cloud is in use");
  if (seconds(ros_) - seen_->measured > SOURCE_TIMEOUT + 1e-6) fail("FREE of an old cloud");
  for (int i = 0; i < nb_links; ++i) {
    for (const Pose& p : seen_->points) {
      if (!at[i] || ignored_.count(i) > 0) continue;
      require(distance(solidOf(i), *at[i], {}, p), linkName(i), "what a camera saw");
    }
  }
}

/// Requests, the limiter and the cycle say the same of the same.
void SimulatedNode::judgeAgreement(const Snapshot& snapshot) {
  const Verdict verdict = report_.verdict;
  try {
    Snapshot asked = monitor_.withJoints(snapshot.scene, {}, ros::Time());
    requireSharedDoubts(snapshot, asked, "a request");
    // Of joints it takes what is newest of each: that may be in doubt where older poses are not.
    requireSharedDoubts(snapshot, monitor_.withMeasured(snapshot.scene, {}), "the limiter");
    if (verdict == Verdict::UNKNOWN) return;
    std::vector<Eigen::Isometry3d> X_WB;
    asked.joints->bodyPosesAt({}, X_WB);
    snapshot.scene->scene->gatherPoses(X_WB, asked.poses);
    const std::vector<std::string>& doubts = asked.poses.doubts;
    const Verdict of_request = detector_->detect(asked.poses, {}).verdict;
    if (doubts.empty() && of_request != verdict) fail("a request and the cycle do not agree");
    if (verdict == Verdict::FREE && !doubts.empty()) {
      fail("the cycle is FREE, a request is in doubt: " + doubts.front());
    }
  } catch (const InputError& error) {
    if (verdict == Verdict::FREE) fail(std::string("a request fails: ") + error.what());
  }
}

/// What is in doubt whatever the instant of the poses.
void SimulatedNode::requireSharedDoubts(const Snapshot& cycle, const Snapshot& other,
                                        const std::string& whose) {
  for (const std::string& doubt : cycle.poses.doubts) {
    const bool is_of_cloud = doubt.rfind("cloud '", 0) == 0;
    const bool is_of_clock = doubt.rfind("use_sim_time", 0) == 0;
    const auto& others = other.poses.doubts;
    const bool is_shared = std::find(others.begin(), others.end(), doubt) != others.end();
    const bool must_be =
        is_of_cloud || (is_of_clock && (whose == "the limiter" || !cycle.is_static));
    if (must_be && !is_shared) fail(whose + " does not know that " + doubt);
  }
}

void SimulatedNode::judgeMemory() {
  const TransformBuffer& buffer = monitor_.transforms().buffer();
  if (buffer.nbEpochs() > 150) fail("epochs pile up");
  for (int frame = 0; frame < static_cast<int>(buffer.frames().size()); ++frame) {
    const bool is_heard = buffer.gate().isHeard(frame);
    if (is_heard && buffer.gate().nbKept(frame) > 1000) fail("samples pile up");
  }
}

bool SimulatedNode::areAdjacent(int a, int b) const {
  const auto parentBody = [&](int link) {
    const int parent = setup_.links[static_cast<std::size_t>(bodyOf(link))].parent;
    return parent < 0 ? -1 : bodyOf(parent);
  };
  return parentBody(a) == bodyOf(b) || parentBody(b) == bodyOf(a);
}

void SimulatedNode::recover(double duration) {
  speed_ = 1.0;
  scene_works_.clear();
  if (cloud_work_) endCloud();
  Event change;
  change.what = 6;  // no object
  change.kind = Event::SCENE_BEGIN;
  happen(change);
  change.kind = Event::SCENE_END;
  happen(change);
  change.kind = Event::CAMERA;
  happen(change);
  change.kind = Event::CLEAR;
  happen(change);
  const double begin = steady_;
  for (int step = 0; steady_ < begin + duration; ++step) {
    for (int link = 0; link < static_cast<int>(setup_.links.size()); ++link) {
      Event publish;
      publish.kind = Event::PUBLISH;
      publish.who = link;
      publish.at = {10.0 * std::pow(2.0, link), 0.0, 0.0, 0.0};
      happen(publish);
    }
    Event joints;
    joints.kind = Event::JOINTS;
    joints.at = {10.0, 0.0, 0.0, 0.0};
    happen(joints);
    if (step % 5 == 0) {
      Event cloud;
      cloud.at = {-2.0, -2.0, 0.0, 0.0};
      for (const auto kind : {Event::CLOUD, Event::CLOUD_BEGIN, Event::CLOUD_END}) {
        cloud.kind = kind;
        happen(cloud);
      }
    }
    Event wait;
    wait.dt = 0.02;
    happen(wait);
  }
  const bool checks =
      monitor_.scenes().active()->scene->unchecked().empty() && !knowledge_.isAmbiguousForEver();
  if (checks && report_.verdict != Verdict::FREE)
    fail("everything is sound, but not FREE: " + reasons());
  if (checks && limiter_ && !limiter_->doubt().empty()) {
    fail("everything is sound, but the limiter stands: " + limiter_->doubt());
  }
}

}  // namespace simulation
