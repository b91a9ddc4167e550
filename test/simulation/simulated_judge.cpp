// The claims about a SimulatedNode.
#include <algorithm>
#include <cmath>
#include <functional>

#include "collision_pairs/occupied_voxels.h"
#include "simulated_node.h"

namespace simulation {
namespace {

void mix(std::size_t& digest, std::size_t value) {
  digest = digest * 1099511628211u + value + 0x9e3779b97f4a7c15u;
}

}  // namespace

/// Requests need it, the cycle what lies between W and what is checked: a lie may lead past it.
bool SimulatedNode::isRootNowhere(const Snapshot& snapshot) const {
  const Ns stamp = static_cast<Ns>(snapshot.stamp.toNSec());
  if (setup_.fixed_frame < 0) return knowledge_.isRootHung(stamp);
  const std::optional<Ns> newest = newestStampOf(-1, ros_);
  const auto isCertain = [&](Ns at) { return knowledge_.isCertain(-1, at); };
  return !newest || !isCertain(stamp) || !isCertain(std::min(stamp, *newest));
}

void SimulatedNode::report() {
  const ActiveScenePtr scene = monitor_.scenes().active();
  if (!detector_ || &detector_->scene() != scene->scene.get()) {
    detector_ = std::make_unique<CollisionDetector>(scene->scene);
  }
  const Snapshot snapshot = monitor_.at(scene);
  const bool is_thorough = digest_ % 4 == 0;  // else a run takes twice as long
  CheckSettings settings;
  if (is_thorough) settings.alarm_distance = ALARM_DISTANCE;
  report_ = detector_->detect(snapshot.poses, settings);
  ++counts[report_.verdict];
  mix(digest_, static_cast<std::size_t>(report_.verdict));
  mix(digest_, static_cast<std::size_t>(snapshot.stamp.toNSec()));
  mix(digest_, std::hash<std::string>()(reasons()));
  judge(snapshot);
  if (!is_thorough) return;
  judgeCertain(snapshot);
  judgePairs(snapshot);
  judgeBefore(snapshot);
  if (digest_ % 64 == 0) judgeMessage(snapshot);
}

void SimulatedNode::judge(const Snapshot& snapshot) {
  const bool is_unknown = report_.verdict == Verdict::UNKNOWN;
  if (is_unknown == report_.unknown_because.empty()) fail("UNKNOWN and its reasons do not agree");
  if (report_.verdict != Verdict::COLLISION && !snapshot.poses.unknown_because.empty() &&
      !is_unknown) {
    fail("FREE in spite of reasons");
  }
  bool can_move = false;
  for (int i = 0; i < static_cast<int>(setup_.links.size()); ++i) {
    if (snapshot.scene->scene->findModel(linkName(i)) < 0) continue;
    for (const int joint : setup_.pathTo(i)) {
      const Told& told = knowledge_.told(joint);
      const bool is_fixed =
          setup_.links[static_cast<std::size_t>(joint)].joint == SimulatedLink::FIXED;
      can_move = can_move || (!is_fixed && !told.is_static && told.is_settled);
    }
  }
  if (can_move && snapshot.is_static && report_.verdict == Verdict::FREE) {
    fail("what moves is said to stand");
  }
  judgeBodies(snapshot, true);
  judgeSame(snapshot);
  judgeReasons(snapshot);
  judgeClouds(snapshot);
  if (report_.verdict == Verdict::FREE) judgeFree(snapshot);
  judgeAgreement(snapshot);
  if (limiter_) {
    const std::string wrong = limiter_->violation(monitor_);
    if (!wrong.empty()) fail(wrong);
    nb_limited += limiter_->problem().empty() ? 1 : 0;
  }
  judgeMemory();
}

SimulatedNode::Poses SimulatedNode::posesAt(Ns stamp) const {
  Poses at;
  for (int link = 0; link < static_cast<int>(setup_.links.size()); ++link) {
    at.push_back(knowledge_.poseOf(link, stamp));
    if (knowledge_.isLiedAbout(link, stamp)) at.back().reset();
  }
  return at;
}

/// Whether a link's body is where the truth has it at that stamp.
bool SimulatedNode::isBody(int link, const Eigen::Isometry3d& X_WB, Ns stamp) const {
  const auto expected = knowledge_.poseOf(bodyOf(link), stamp);
  if (!expected) return false;
  const Eigen::AngleAxisd R(expected->yaw, inSpace({0.0, 0.0, 1.0, 0.0}));
  return (X_WB.translation() - inSpace(*expected)).norm() +
             (X_WB.linear() - R.toRotationMatrix()).norm() <
         1e-5;
}

/// A pose that is known is one that was said, and one that was said plainly is known.
void SimulatedNode::judgeBodies(const Snapshot& snapshot, bool is_newest) {
  const CollisionScene& scene = *snapshot.scene->scene;
  const Ns stamp = static_cast<Ns>(snapshot.stamp.toNSec());
  for (int link = 0; link < static_cast<int>(setup_.links.size()); ++link) {
    const int model = scene.findModel(linkName(link));
    const int body = model < 0 ? -1 : scene.models()[static_cast<std::size_t>(model)].body;
    if (body < 0) continue;
    const bool is_known = snapshot.poses.known[static_cast<std::size_t>(body)] != 0;
    const bool is_hung = knowledge_.isRootHung(stamp) || knowledge_.isFrameLiedAbout(stamp);
    if (is_known && !is_hung && knowledge_.isForbidden(link, stamp)) {
      fail(linkName(link) + " is known by a topic that does not count");
    }
    if (!is_known || knowledge_.isLiedAbout(link, stamp)) continue;
    if (knowledge_.isHeld(link)) fail("only /tf_static places " + linkName(link));
    const bool is_cycle = setup_.fixed_frame < 0 && knowledge_.isCycle(stamp);
    if (is_cycle) fail("the root hangs on itself, but known is " + linkName(link));
    if (knowledge_.isSuspect(link, stamp)) fail(linkName(link) + " is known, but suspect");
    const bool are_all_wanted = settings_.ignored.empty() && setup_.fixed_frame < 0;
    if (are_all_wanted && is_newest && !snapshot.is_static && knowledge_.isBehind(stamp)) {
      fail(linkName(link) + " lags behind");
    }
    if (!knowledge_.poseOf(link, stamp)) fail(linkName(link) + " is known, but nobody said so");
    if (!isBody(link, snapshot.poses.X_WB[static_cast<std::size_t>(body)], stamp)) {
      fail(linkName(link) + " is elsewhere");
    }
  }
  std::size_t nb_asked = 0, nb_found = 0;
  bool are_all_known = true;
  for (std::size_t i = 0; i < scene.bodies().size(); ++i) {
    const bool is_known = snapshot.poses.known[i] != 0;
    are_all_known = are_all_known && is_known;
    const std::string of_frame = linkName(bodyOf(setup_.fixed_frame));
    if (scene.bodies()[i].link == of_frame && !setup_.is_marked) continue;
    ++nb_asked;
    nb_found += is_known ? 1 : 0;
  }
  if (snapshot.nb_asked != nb_asked || snapshot.nb_found != nb_found ||
      snapshot.isKnown() != (nb_found > 0 || nb_asked == 0) ||
      are_all_known != snapshot.first_left_out.empty()) {
    fail("the number of bodies found is wrong");
  }
}

/// What is certain is known, at the newest stamp that all have reached, unless it is too
/// old, or older than others.
void SimulatedNode::judgeCertain(const Snapshot& snapshot) {
  const CollisionScene& scene = *snapshot.scene->scene;
  const Ns stamp = static_cast<Ns>(snapshot.stamp.toNSec());
  const bool may_be_known = ros_ > 0 && !knowledge_.isTooOld(stamp);
  const Ns heard = std::max(knowledge_.newest(), EVER / 2);
  Ns expected = NEVER;
  bool are_certain = ros_ > 0 && !knowledge_.isPoseOpen(-1);  // what stands is asked for now
  for (const SceneBody& body : scene.bodies()) {
    const int link = body.link == "root" ? -1 : std::stoi(body.link.substr(1));
    const auto newest = newestStampOf(link, ros_);
    // Of what is ahead of the clock alone, a lie of before would be newer; and what stands, which
    // is asked for now, may be known from then on only.
    const bool is_ahead = newest && *newest > ros_;
    const bool may_differ = knowledge_.isLiedAbout(link) || knowledge_.isUnsettled(link);
    are_certain = are_certain && newest && !knowledge_.isPoseOpen(link);
    are_certain = are_certain && !(is_ahead && may_differ);
    expected = std::min(expected, newest.value_or(NEVER));
  }
  for (const SceneBody& body : scene.bodies()) {
    const int link = body.link == "root" ? -1 : std::stoi(body.link.substr(1));
    const std::size_t i = static_cast<std::size_t>(&body - scene.bodies().data());
    if (knowledge_.isTooOld(stamp) && snapshot.poses.known[i] && !knowledge_.isLiedAbout(link) &&
        !snapshot.is_static) {
      fail("the pose of a link is too old");
    }
    are_certain = are_certain && (expected == NEVER || knowledge_.isCertain(link, expected));
    if (snapshot.poses.known[i] || !may_be_known) continue;
    const Ns newest = std::min(stamp, newestStampOf(link, ros_).value_or(EVER / 2));
    const double lag = seconds(heard - newest);
    if (lag < setup_.max_transform_age - 1e-6 && knowledge_.isCertain(link, stamp)) {
      fail(body.link + " is not known, but certain: " + reasons());
    }
  }
  const bool is_sound = are_certain && expected != NEVER && !knowledge_.isTooOld(expected) &&
                        seconds(heard - expected) < setup_.max_transform_age - 1e-6;
  if (is_sound && stamp != expected) {
    fail("the poses are of " + std::to_string(seconds(stamp - expected)) + " s after the newest");
  }
}

/// Of a link that nothing is checked against no geometry is read.
bool SimulatedNode::isGeometryMissing() const {
  bool is_checked = setup_.has_cloud || setup_.has_world;
  for (const auto& [name, object] : objects_) is_checked = is_checked || object.link < 0;
  for (int i = 0; settings_.broken >= 0 && i < static_cast<int>(setup_.links.size()); ++i) {
    is_checked = is_checked || (i != settings_.broken && areChecked(settings_.broken, i));
  }
  return settings_.broken >= 0 && settings_.ignored.count(settings_.broken) == 0 && is_checked;
}

void SimulatedNode::judgeFree(const Snapshot& snapshot) {
  const Ns stamp = static_cast<Ns>(snapshot.stamp.toNSec());
  if (ros_ == 0) fail("FREE without a clock");
  if (isGeometryMissing()) fail("FREE although geometry is missing");
  if (!isAnyChecked({})) fail("FREE although nothing is checked");
  if (knowledge_.isClockSuspect()) fail("FREE although the clock stands still");
  if (knowledge_.isTooOld(stamp) && !snapshot.is_static) fail("FREE although poses are too old");
  const bool are_all_wanted = settings_.ignored.empty() && !knowledge_.isRootHung(stamp);
  if (are_all_wanted && knowledge_.isBehind(stamp)) fail("FREE although a link lags behind");
  Poses at;
  for (int link = 0; link < static_cast<int>(setup_.links.size()); ++link) {
    at.push_back(knowledge_.poseOf(link, stamp));
    const bool is_open = knowledge_.isReplaced(link) || knowledge_.isOpen(link, stamp);
    if (is_open || knowledge_.isLiedAbout(link, stamp)) at.back().reset();
    if (snapshot.scene->scene->findModel(linkName(link)) < 0) continue;  // it is in no pair
    const bool is_known = at.back() || knowledge_.isLiedAbout(link, stamp);
    if (!is_known) return fail("FREE although a link is nowhere");
    // Who hangs the frame of the reports on a link places that link, whatever it hangs on itself.
    if (knowledge_.isRootHung(stamp)) continue;
    if (knowledge_.isSuspect(link, stamp)) fail("FREE although two nodes contradict each other");
    if (knowledge_.isLiedAbout(link, stamp)) continue;
    if (knowledge_.isOnBoth(link)) fail("FREE although a frame is on /tf and on /tf_static");
  }
  judgeApart(at);
  if (!setup_.has_cloud) return;
  if (!seen_) return fail("FREE although no cloud is in use");
  if (is_lost_ || was_lost_) fail("FREE although what was beside the robot has vanished");
  if (seconds(ros_) - seen_->measured > timeout() + 1e-6) fail("FREE of an old cloud");
  const double oldest = std::min(seen_->measured, snapshot.stamp.toSec());
  if (std::abs(snapshot.oldest_cloud - oldest) > 1e-6) fail("a cloud has another age");
  const OccupiedVoxels& voxels = *snapshot.poses.voxels.front();
  for (const Pose& p : seen_->points) {
    const Eigen::Vector3d at_p = inSpace(p);
    if (!voxels.anyWithin({at_p, at_p}, 1e-3)) fail("what a camera saw is elsewhere");
  }
  for (int i = 0; i < static_cast<int>(setup_.links.size()); ++i) {
    for (const Pose& p : seen_->points) {
      if (!at[i] || settings_.ignored.count(i) > 0) continue;
      if (distance(ballOf(i), *at[i], {}, p) > settings_.padding - ROUNDING) continue;
      fail("FREE although " + linkName(i) + " touches what a camera saw");
    }
  }
}

Pose SimulatedNode::poseOf(const PlainObject& object, const Poses& at) const {
  if (object.link < 0) return object.X_PO;
  return *at[static_cast<std::size_t>(object.link)] * object.X_PO;
}

void SimulatedNode::judgeApart(const Poses& at, const std::set<std::string>& members) {
  const auto require = [&](double gap, const std::string& a, const std::string& b) {
    const int nb_padded = (a.front() == 'l' ? 1 : 0) + (b.front() == 'l' ? 1 : 0);
    if (gap > nb_padded * settings_.padding - ROUNDING || !isOneOf(members, a, b)) return;
    fail("FREE although " + a + " touches " + b);
  };
  for (int i = 0; i < static_cast<int>(setup_.links.size()); ++i) {
    for (int j = 0; j < i; ++j) {
      if (!at[i] || !at[j] || !areChecked(i, j)) continue;
      require(distance(ballOf(i), *at[i], ballOf(j), *at[j]), linkName(i), linkName(j));
    }
  }
  for (const auto& [name, object] : objects_) {
    if (!isPlaced(object, at)) continue;
    const Pose X_WO = poseOf(object, at);
    for (int i = 0; i < static_cast<int>(setup_.links.size()); ++i) {
      if (!at[i] || !isCheckedAgainst(i, object)) continue;
      require(distance(ballOf(i), *at[i], object.solid, X_WO), linkName(i), name);
    }
    for (const auto& [other_name, other] : objects_) {
      if (object.link < 0 || other.link >= 0 || object.touched_objects.count(other_name) > 0) {
        continue;
      }
      require(distance(object.solid, X_WO, other.solid, other.X_PO), name, other_name);
    }
  }
}

/// Requests, the limiter and the cycle say the same of the same.
void SimulatedNode::judgeAgreement(const Snapshot& snapshot) {
  const Verdict verdict = report_.verdict;
  if (verdict == Verdict::UNKNOWN && digest_ % 4 != 0) return;  // takes longest, and says least
  try {
    Snapshot asked = monitor_.withJoints(snapshot.scene, {}, ros::Time());
    requireSharedReasons(snapshot, asked, "a request");
    // What the cycle cannot place at any instant, a request may not have to ask about.
    // … nor do the newest transforms of its joints lead where those of the clock's stamp do.
    const bool is_static = asked.is_static && asked.poses.unknown_because.empty();
    if (!snapshot.isKnown()) {  // that is of the clock's instant
      if (asked.poses.unknown_because.empty()) fail("a request knows what the cycle does not");
    } else if (!snapshot.is_static && (asked.stamp != snapshot.stamp || is_static)) {
      fail("a request is of another instant");
    }
    // Of joints it takes what is newest of each: that may be suspect where older poses are not.
    try {
      const Snapshot limited = monitor_.withMeasured(snapshot.scene, {}, {});
      requireSharedReasons(snapshot, limited, "the limiter");
      judgeLagging(limited);
    } catch (const InputError&) {
    }
    if (verdict == Verdict::UNKNOWN) return;
    std::vector<Eigen::Isometry3d> X_WB;
    asked.joints->bodyPosesAt({}, X_WB);
    snapshot.scene->scene->gatherPoses(X_WB, asked.poses);
    const std::vector<std::string>& reasons = asked.poses.unknown_because;
    const Verdict of_request = detector_->detect(asked.poses, {}).verdict;
    if (reasons.empty() && of_request != verdict) fail("a request and the cycle do not agree");
    // A lie may lead past a link that is in no pair, so the cycle does not need it.
    // … nor the root, which a request does, and which moves where all else stands.
    bool is_nowhere = isRootNowhere(snapshot) || (snapshot.is_static && !asked.is_static);
    for (int i = 0; i < static_cast<int>(setup_.links.size()); ++i) {
      const bool is_checked = snapshot.scene->scene->findModel(linkName(i)) >= 0;
      const Ns stamp = static_cast<Ns>(snapshot.stamp.toNSec());
      is_nowhere = is_nowhere || (!is_checked && !knowledge_.poseOf(i, stamp));
    }
    if (verdict == Verdict::FREE && !reasons.empty() && !is_nowhere) {
      fail("the cycle is FREE, a request is suspect: " + reasons.front());
    }
  } catch (const InputError& error) {
    const bool is_needed = verdict == Verdict::FREE && !isRootNowhere(snapshot);
    if (is_needed) fail(std::string("a request fails: ") + error.what());
  }
}

void SimulatedNode::judgeMemory() {
  constexpr double KEPT = 10.0;           // s
  constexpr std::size_t OF_OTHERS = 100;  // spans, static poses, samples of liars
  const TransformBuffer& buffer = monitor_.transforms().buffer();
  for (int link = 0; link < static_cast<int>(setup_.links.size()); ++link) {
    const auto& samples = knowledge_.told(link).samples;
    const int frame = buffer.findFrame(setup_.hungFrame(link));
    if (samples.empty() || !buffer.gate().isHeard(frame)) continue;
    const Ns begin = samples.rbegin()->first - static_cast<Ns>(1e9 * KEPT);
    const auto nb =
        static_cast<std::size_t>(std::distance(samples.lower_bound(begin), samples.end()));
    // Each may be of three nodes.
    if (buffer.gate().nbKept(frame) > 3 * nb + OF_OTHERS) {
      fail("samples pile up of " + linkName(link));
    }
  }
}

void SimulatedNode::recover(double duration) {
  speed_ = 1.0;
  scene_works_.clear();
  if (cloud_work_) endCloud();
  Event change;
  for (const int what : {6, 7}) {  // no object, and nothing ignored
    change.what = what;
    change.kind = Event::SCENE_BEGIN;
    happen(change);
    change.kind = Event::SCENE_END;
    happen(change);
  }
  change.kind = Event::CAMERA;
  happen(change);
  change.kind = Event::CLEAR;
  happen(change);
  const double begin = std::max(steady_, setup_.clock_begins);
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
      cloud.what = 2;  // sound, and where `at` says
      cloud.at = {-2.0, -2.0, 0.0, 0.0};
      for (const auto kind : {Event::CLOUD, Event::CLOUD_BEGIN, Event::CLOUD_END}) {
        cloud.kind = kind;
        happen(cloud);
      }
    }
    Event wait;
    wait.dt = 0.023;  // no divisor of the ages
    happen(wait);
  }
  bool checks = monitor_.scenes().active()->scene->unchecked().empty() &&
                !knowledge_.isAmbiguousForEver() && !setup_.isCameraHeld();
  for (int link = -1; link < static_cast<int>(setup_.links.size()); ++link) {
    checks = checks && !knowledge_.isHeld(link);
  }
  if (checks && report_.verdict != Verdict::FREE)
    fail("everything is sound, but not FREE: " + reasons());
  if (checks && limiter_ && !limiter_->problem().empty()) {
    fail("everything is sound, but the limiter stands: " + limiter_->problem());
  }
  if (!setup_.is_simulated) return;
  speed_ = 0.0;
  Event stands;  // all that can age is suspect, also for a request of all joints
  stands.dt = setup_.max_pose_age + 0.1;
  happen(stands);
  requestJoints(stands, 0);
}

}  // namespace simulation
