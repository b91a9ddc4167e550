#include "robot_poses.h"

#include <algorithm>

#include "collision_pairs/input_error.h"
#include "user_text.h"

namespace collision_pairs {
namespace {

std::vector<LinkFrames::Link> linksOf(const RobotModel& robot) {
  std::vector<LinkFrames::Link> first, others;
  for (std::size_t i = 0; i < robot.links().size(); ++i) {
    const Link& link = robot.links()[i];
    const bool is_first = robot.bodies()[link.body].link == static_cast<int>(i);
    (is_first ? first : others).push_back({link.name, link.body, link.X_BL});
  }
  first.insert(first.end(), others.begin(), others.end());
  return first;
}

}  // namespace

const char* const RobotPoses::NO_FRAME = "TF has no frame of that name";

RobotPoses::RobotPoses(const TransformBuffer& buffer, const RobotModel& robot, std::string frame,
                       const std::vector<std::string>& static_joints)
    : buffer_(buffer),
      links_(buffer, linksOf(robot)),
      robot_(robot.withElements([](const Link&) { return std::vector<Element>(); })),
      frame_(std::move(frame)) {
  for (const std::string& name : static_joints) {
    if (robot.findJoint(name) >= 0) continue;
    throw InputError("static_joints: '" + name + "' is not a joint of the robot" +
                     didYouMean(name, namesOf(robot.joints())));
  }
  for (const Body& body : robot.bodies()) {
    const bool is_root = body.parent < 0;
    roots_.push_back(is_root ? static_cast<int>(roots_.size()) : roots_[body.parent]);
    const std::string joint = body.joint < 0 ? "" : robot.joints()[body.joint].name;
    const bool is_listed = std::count(static_joints.begin(), static_joints.end(), joint) > 0;
    joints_.push_back({joint, body.joint < 0 || is_listed});
  }
  const int link = robot.findLink(frame_);
  if (link >= 0) body_of_frame_ = robot.links()[link].body;
}

const LinkFrames& RobotPoses::links() const {
  links_.update();
  return links_;
}

RobotPoses::Layout RobotPoses::layOut(const Instant& instant,
                                      const std::vector<char>& wanted) const {
  const int W = links().find(frame_);
  Layout layout{{buffer_, W, instant, &links_}, std::vector<Layout::Place>(joints_.size())};
  for (int b = 0; b < static_cast<int>(joints_.size()); ++b) {
    auto& [frame, way] = layout.places[b];
    if (W < 0 || !wanted[b]) continue;
    for (const int link : links_.ofBody(b)) {
      const FrameWays::Way found = layout.ways.to(link);
      if (found.is_known) {
        frame = link;
        way = found;
        break;
      }
      way.oldest = std::min(way.oldest, found.oldest);
    }
  }
  return layout;
}

std::string RobotPoses::whyNot(int body, const Layout& layout) const {
  const std::vector<int>& links = links_.ofBody(body);
  const auto named =
      std::find_if(links.begin(), links.end(), [&](int link) { return links_.isNamed(link); });
  if (named == links.end()) return NO_FRAME;
  if (layout.ways.target() < 0) return "TF has no frame '" + frame_ + "'";
  return layout.ways.whyNot(*named) + " (in '" + frame_ + "')";
}

FoundBodies RobotPoses::place(const Instant& instant, const std::vector<char>& wanted) const {
  return place(layOut(instant, wanted), instant.stamp, wanted);
}

FoundBodies RobotPoses::place(const Layout& layout, StampNs stamp,
                              const std::vector<char>& wanted) const {
  const int W = layout.ways.target(), under = bodyUnder(W, stamp);
  const std::vector<char> stands = standingJoints(W, under);
  FoundBodies found;
  found.known.assign(joints_.size(), 0);
  found.X_WB.assign(joints_.size(), Eigen::Isometry3d::Identity());
  found.problems.assign(joints_.size(), "");
  for (int b = 0; b < static_cast<int>(joints_.size()); ++b) {
    if (!wanted[b]) continue;
    const auto& [frame, way] = layout.places[b];
    const int below = firstStanding(stands, b, under);
    if (frame < 0) {
      found.problems[b] = whyNot(b, layout);
    } else if (below >= 0) {
      found.problems[b] = whyHeld(below);
    } else {
      try {
        found.X_WB[b] = layout.ways.poseOf(frame, way, stamp) * links_.X_BL(frame).inverse();
        found.known[b] = 1;
        if (way.oldest != NEVER) found.stamp = stamp;
      } catch (const InputError& error) {
        found.problems[b] = error.what();
      }
    }
  }
  return found;
}

int RobotPoses::carrierOf(int body, StampNs stamp) const {
  const FrameWays ways(buffer_, -1, {Instant::NEWEST, stamp}, &links());
  for (int frame : links_.ofBody(body)) {
    for (std::size_t i = 0; i < links_.nbFrames() && links_.isNamed(frame); ++i) {  // or a cycle
      frame = ways.lastParent(frame);
      if (frame < 0) break;
      const int other = links_.bodyOf(frame);
      if (other >= 0 && other != body) return other;
    }
  }
  return -1;
}

StampNs RobotPoses::newestAbove(int frame, StampNs now) const {
  const TransformGate& gate = buffer_.gate();
  StampNs newest = EVER_SINCE;
  const std::size_t most = buffer_.frames().size();  // a cycle ends, too
  for (std::size_t step = 0; step < most && frame >= 0 && gate.isHeard(frame); ++step) {
    const StampNs at = gate.newestAt(frame, now);
    if (at == EVER_SINCE) break;
    if (at != NEVER) newest = std::max(newest, at);
    frame = buffer_.parentAt(frame, at == NEVER ? now : at);
  }
  return newest;
}

StampNs RobotPoses::newestOfRobot(int frame, StampNs now) const {
  StampNs newest = newestAbove(frame, now);
  for (int b = 0; b < static_cast<int>(joints_.size()); ++b) {
    for (const int link : links_.ofBody(b)) newest = std::max(newest, newestAbove(link, now));
  }
  return newest;
}

/// All wanted ones hang on a frame that hangs on nothing, by transforms of that very stamp and by
/// static ones that nothing can have changed since. So it is wherever one program sends them all.
bool RobotPoses::holdsAt(StampNs stamp, const Layout& layout,
                         const std::vector<char>& wanted) const {
  const int W = layout.ways.target();
  if (W < 0 || buffer_.gate().isHeard(W)) return false;
  for (int b = 0; b < static_cast<int>(wanted.size()); ++b) {
    if (!wanted[b]) continue;
    const auto& [frame, way] = layout.places[b];  // another link may be known at that stamp
    if (frame != links_.ofBody(b).front() || !way.is_settled) return false;
    if (way.oldest != NEVER && (way.oldest != stamp || way.newest != stamp)) return false;
  }
  return true;
}

RobotPoses::NewestLayout RobotPoses::layOutNewest(StampNs now,
                                                  const std::vector<char>& wanted) const {
  NewestLayout found{layOut({Instant::NEWEST, now}, wanted), {}, {}};
  const Layout& layout = found.layout;
  const auto isFound = [&](std::size_t b) { return layout.places[b].frame >= 0; };
  StampNs newest = EVER_SINCE;
  // One that is not found now may be at an earlier instant, if its own transforms are.
  const auto isDated = [&](std::size_t b) {
    return wanted[b] && layout.places[b].way.oldest != NEVER;
  };
  bool are_found = true;
  for (std::size_t b = 0; b < wanted.size(); ++b) {
    are_found = are_found && (!wanted[b] || isFound(b));
    if (isDated(b) && isFound(b)) newest = std::max(newest, layout.places[b].way.newest);
  }
  // Also of what is suspect now: others may be behind it.
  StampNs heard = std::max(newest, layout.ways.newestUnknown());
  if (!are_found) heard = std::max(heard, newestOfRobot(layout.ways.target(), now));
  if (heard != EVER_SINCE) found.stamps.heard = heard;
  found.problems.resize(wanted.size());
  for (std::size_t b = 0; b < wanted.size(); ++b) {
    if (wanted[b] && !isFound(b)) found.problems[b] = whyNot(static_cast<int>(b), layout);
    if (newest == EVER_SINCE || !isDated(b)) continue;
    const std::string why = whyBehind(heard - layout.places[b].way.oldest, buffer_.limits());
    if (why.empty()) {
      found.stamps.common = std::min(found.stamps.common, layout.places[b].way.oldest);
    } else if (isFound(b)) {
      found.problems[b] = why;
    }
  }
  return found;
}

FoundBodies RobotPoses::newest(StampNs now, const std::vector<char>& wanted) const {
  const auto [layout, stamps, problems] = layOutNewest(now, wanted);
  const StampNs stamp = stamps.common == NEVER ? now : stamps.common;
  FoundBodies found = holdsAt(stamp, layout, wanted) ? place(layout, stamp, wanted)
                                                     : place({Instant::AT, stamp}, wanted);
  for (std::size_t b = 0; b < wanted.size(); ++b) {
    const bool is_lagging = layout.places[b].frame >= 0 && !problems[b].empty();
    if (is_lagging) found.known[b] = 0;
    if (!found.known[b] && !problems[b].empty()) found.problems[b] = problems[b];
  }
  if (stamps.common != NEVER) found.stamp = stamps.common;
  return found;
}

FoundPose RobotPoses::between(const std::string& target, const std::string& source,
                              const Instant& instant) const {
  const FoundPose found = poseBetween(buffer_, target, source, instant, &links());
  const bool is_newest = instant.kind == Instant::NEWEST && found.oldest != NEVER;
  const StampNs stamp = is_newest ? found.oldest : instant.stamp;
  const int from = links_.find(withoutLeadingSlash(target));
  const int under = bodyUnder(from, stamp);
  const int below =
      firstStanding(standingJoints(from, under),
                    bodyUnder(links_.find(withoutLeadingSlash(source)), stamp), under);
  if (below >= 0) throw InputError(whyHeld(below));
  return found;
}

}  // namespace collision_pairs
