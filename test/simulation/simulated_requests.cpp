// Requests to a SimulatedNode, and the claims about their answers.
#include <algorithm>

#include "simulated_node.h"

namespace simulation {

void SimulatedNode::request(const Event& event) {
  const double reach = event.other == 0 ? 5e9 : 1.5e9;
  const Ns stamp = ros_ + static_cast<Ns>(reach * event.number);
  requestInCycle();
  switch (event.what % 4) {
    case 0:
      if (stamp > 0 && stamp != ros_) requestAt(stamp);
      break;
    case 1:
      requestJoints(event, event.what > 3 && stamp > 0 ? stamp : 0);
      break;
    case 2:
      requestPart(event);
      break;
    default:
      requestReplaced();
      if (event.what > 3 && event.number > 0.0) requestWrong();  // takes long
  }
}

/// Of a stamp: with the poses of then, and never with clouds, which are of now.
void SimulatedNode::requestAt(Ns stamp) {
  ros::Time time;
  time.fromNSec(static_cast<std::uint64_t>(stamp));
  const Snapshot snapshot = monitor_.at(monitor_.scenes().active(), time);
  judgeBodies(snapshot);
  requireOfThen(stamp, snapshot.poses.unknown_because);
  const auto& bodies = snapshot.scene->scene->bodies();
  for (std::size_t i = 0; i < bodies.size() && ros_ > 0; ++i) {
    const int link = bodies[i].link == "root" ? -1 : std::stoi(bodies[i].link.substr(1));
    // Where a frame has changed its topic, tf2 is told anew of the last seconds only.
    const bool is_long_ago = seconds(ros_ - stamp) > 1.5;
    if (snapshot.poses.known[i] || is_long_ago || !knowledge_.isCertain(link, stamp)) continue;
    fail(linkName(link) + " was known then");
  }
  if (setup_.has_cloud && snapshot.poses.unknown_because.empty())
    fail("clouds of now count for then");
  const Verdict verdict = detector_->detect(snapshot.poses, {}).verdict;
  if (verdict != Verdict::FREE) return;
  if (ros_ == 0 || knowledge_.isClockSuspect()) fail("FREE then although the clock is suspect");
  judgeApart(posesAt(stamp));
}

/// Of another scene than that of now the objects are not known.
void SimulatedNode::requireOfThen(Ns stamp, const std::vector<std::string>& reasons) {
  const std::string changed =
      "the scene was changed after the stamp of the request, and only the newest is kept";
  const bool is_said = std::find(reasons.begin(), reasons.end(), changed) != reasons.end();
  if (is_said != (stamp != 0 && stamp < changed_)) {
    fail(is_said ? "the scene was not changed since" : "objects of now count for then");
  }
}

/// Of joints that it names, which slide or turn: the others are as TF has them; `at_stamp` 0: now.
void SimulatedNode::requestJoints(const Event& event, Ns at_stamp) {
  const ActiveScenePtr scene = monitor_.scenes().active();
  std::vector<std::string> names;
  std::vector<double> positions;
  for (int i = 0; i < static_cast<int>(setup_.links.size()); ++i) {
    const SimulatedLink& link = setup_.links[static_cast<std::size_t>(i)];
    const bool is_named = event.who != i || event.other % 2 == 0;
    if (!SimulatedLimiter::isMeasured(link) || !is_named) continue;
    names.push_back(jointName(i));
    positions.push_back(link.joint == SimulatedLink::SLIDING ? event.at.x + i : event.at.yaw * i);
  }
  try {
    Snapshot asked = monitor_.withJoints(scene, names, toTime(at_stamp));
    const Ns stamp = static_cast<Ns>(asked.stamp.toNSec());
    if (at_stamp > 0 && stamp != at_stamp) fail("a request is of another stamp");
    judgeJointsOf(*asked.joints, names);
    requireOfThen(at_stamp, asked.poses.unknown_because);
    Poses at;
    bool are_certain = ros_ > 0 && !knowledge_.isClockSuspect() && !setup_.has_cloud &&
                       (at_stamp == 0 || at_stamp >= changed_) && knowledge_.isCertain(-1, stamp);
    // Where TF has it, whatever is named.
    std::optional<Pose> X_WR = knowledge_.poseOf(-1, stamp);
    if (knowledge_.isLiedAbout(-1) || knowledge_.isUnsettled(-1)) X_WR.reset();
    if (setup_.fixed_frame < 0) X_WR = Pose();
    bool can_age = setup_.has_cloud;
    for (int i = 0; i < static_cast<int>(setup_.links.size()); ++i) {
      const SimulatedLink& link = setup_.links[static_cast<std::size_t>(i)];
      const auto named = std::find(names.begin(), names.end(), jointName(i));
      const bool is_base = setup_.isBase(i);
      are_certain = are_certain && knowledge_.isCertain(i, stamp);
      const auto heard = is_base ? knowledge_.poseOf(i, stamp) : knowledge_.inParent(i, stamp);
      Pose X_PB = heard.value_or(Pose());
      bool is_placed = heard.has_value();
      if (named != names.end()) {
        const double position = positions[static_cast<std::size_t>(named - names.begin())];
        Pose motion;
        (link.joint == SimulatedLink::SLIDING ? motion.x : motion.yaw) = position;
        X_PB = link.X_PJ * motion;
        is_placed = true;
      } else if (link.joint != SimulatedLink::FIXED) {
        const bool is_checked = scene->scene->findModel(linkName(i)) >= 0;
        const auto moves = [&](int joint) {
          const bool is_fixed =
              setup_.links[static_cast<std::size_t>(joint)].joint == SimulatedLink::FIXED;
          return !is_fixed && !knowledge_.told(joint).is_static;
        };
        const auto& path = setup_.pathTo(i);
        const bool ages = is_base ? std::any_of(path.begin(), path.end(), moves) : moves(i);
        can_age = can_age || (heard && is_checked && ages);
        is_placed = heard && !knowledge_.isLiedAbout(i) && !knowledge_.isUnsettled(i);
      }
      if (!is_base) {
        const auto X_WP = link.parent < 0 ? X_WR : at[static_cast<std::size_t>(link.parent)];
        is_placed = is_placed && X_WP;
        X_PB = X_WP.value_or(Pose()) * X_PB;
      }
      at.push_back(is_placed ? std::optional<Pose>(X_PB) : std::nullopt);
    }
    for (const std::string& reason : asked.poses.unknown_because) judgeWords(reason);
    if (can_age && knowledge_.isClockSuspect() && asked.poses.unknown_because.empty()) {
      fail("a request does not know that the clock stands still");
    }
    if (are_certain && settings_.broken < 0 && !asked.poses.unknown_because.empty()) {
      fail("a request is suspect without a reason: " + asked.poses.unknown_because.front());
    }
    if (!asked.poses.unknown_because.empty()) return;
    if (!setup_.is_apart && !scene->scene->bodies().empty() && knowledge_.isHeld(-1) &&
        !knowledge_.isLiedAbout(-1)) {
      fail("only /tf_static places the root");
    }
    requireRefusal({"joints are named, but there are"}, [&] {
      std::vector<double> more = positions;
      more.push_back(0.0);
      asked.joints->posesAt(more, asked.poses);
    });
    if (!positions.empty()) {
      requireRefusal({"its position is not finite"}, [&] {
        std::vector<double> none = positions;
        none[static_cast<std::size_t>(event.other) % none.size()] = std::nan("");
        asked.joints->posesAt(none, asked.poses);
      });
    }
    asked.joints->posesAt(positions, asked.poses);
    if (detector_->detect(asked.poses, {}).verdict == Verdict::FREE) judgeApart(at);
    for (std::size_t i = 0; i < scene->scene->bodies().size(); ++i) {
      const SceneBody& body = scene->scene->bodies()[i];
      const int link = body.link == "root" ? -1 : bodyOf(std::stoi(body.link.substr(1)));
      const Eigen::Vector3d p = asked.poses.X_WB[i].translation();
      const std::optional<Pose> expected = link < 0 ? X_WR : at[static_cast<std::size_t>(link)];
      if (expected && (p - inSpace(*expected)).norm() > 1e-5) {
        fail("a request has " + body.link + " elsewhere");
      }
    }
  } catch (const InputError&) {
  }
}

/// Each joint that is not named is either as TF has it, or at zero.
void SimulatedNode::judgeJointsOf(const JointQuery& query, const std::vector<std::string>& names) {
  std::multiset<std::string> said(query.jointsFromTf().begin(), query.jointsFromTf().end()),
      expected;
  said.insert(query.jointsAtZero().begin(), query.jointsAtZero().end());
  for (int i = 0; i < static_cast<int>(setup_.links.size()); ++i) {
    const bool is_fixed = setup_.of(i).joint == SimulatedLink::FIXED;
    const bool is_named = std::find(names.begin(), names.end(), jointName(i)) != names.end();
    if (!is_fixed && !is_named && !setup_.isBase(i)) expected.insert(jointName(i));
  }
  said.erase("j_mast");
  if (said != expected) fail("joints that are not named are left out, or counted twice");
}

/// The limiter takes the newest position of each joint: one that is behind the others is suspect.
void SimulatedNode::judgeLagging(const Snapshot& limited) {
  if (!limited.poses.unknown_because.empty()) return;
  std::vector<Ns> newest;
  for (int i = 0; i < static_cast<int>(setup_.links.size()); ++i) {
    const SimulatedLink& link = setup_.links[static_cast<std::size_t>(i)];
    const bool is_checked = limited.scene->scene->findModel(linkName(i)) >= 0;
    const Told& told = knowledge_.told(i);
    const bool stands = link.joint == SimulatedLink::FIXED || told.is_static || !told.is_settled;
    if (!is_checked || stands || setup_.isBase(i) || knowledge_.isLiedAbout(i)) continue;
    const auto ahead = told.samples.upper_bound(ros_);
    const bool has_reached = ahead != told.samples.begin();
    // Of a node whose clock is ahead, the first that is.
    const bool is_old = has_reached && knowledge_.isTooOld(std::prev(ahead)->first, ros_);
    if (has_reached && !(is_old && ahead != told.samples.end())) {
      newest.push_back(std::prev(ahead)->first);
    }
  }
  if (newest.empty() || knowledge_.isAmbiguousForEver()) return;
  const auto [oldest, last] = std::minmax_element(newest.begin(), newest.end());
  if (seconds(*last - *oldest) > setup_.max_transform_age + 1e-6) {
    fail("the limiter does not know that a joint is behind the others");
  }
}

/// Of pairs with one of some links.
void SimulatedNode::requestPart(const Event& event) {
  const std::set<std::string> members = {linkName(event.who), linkName(event.other)};
  Restriction restriction;
  for (const std::string& name : members) restriction.names.push_back({name});
  SceneJob job = monitor_.scenes().restrictedTo(restriction);
  try {
    job.run();
  } catch (const InputError&) {
    return;
  }
  if (!monitor_.scenes().take(job)) return fail("a part of the scene is refused");
  const ActiveScenePtr part = job.scene();
  const Snapshot snapshot = monitor_.at(part);
  judgeBodies(snapshot);
  if (part->revision != revision_) fail("a part is of a scene that was replaced");
  SceneJob all = monitor_.scenes().restrictedTo({});
  all.run();
  if (!monitor_.scenes().take(all) || all.scene() != monitor_.scenes().active()) {
    fail("all of the scene is another scene");
  }
  SceneJob again = monitor_.scenes().restrictedTo(restriction);
  again.run();
  if (!monitor_.scenes().take(again) || again.scene() != part) fail("a part is built again");
  CollisionDetector detector(part->scene);
  const Verdict verdict = detector.detect(snapshot.poses, {}).verdict;
  if (verdict == Verdict::FREE) {
    if (!isAnyChecked(members)) fail("a part is FREE although nothing of it is checked");
    judgeApart(posesAt(static_cast<Ns>(snapshot.stamp.toNSec())), members);
  }
  replaced_ = part;
}

/// Of a scene that was replaced, by who still has it.
void SimulatedNode::requestReplaced() {
  if (!replaced_) return;
  const Snapshot snapshot = monitor_.at(replaced_);
  const bool is_replaced = replaced_->revision != revision_;
  if (is_replaced && snapshot.poses.unknown_because.empty())
    fail("a scene counts that was replaced");
}

}  // namespace simulation
