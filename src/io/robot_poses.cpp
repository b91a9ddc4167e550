#include "robot_poses.h"

#include <algorithm>

#include "collision_pairs/input_error.h"
#include "frame_names.h"
#include "user_text.h"

namespace collision_pairs {
namespace {

using Eigen::Isometry3d;

/// The last frame that static transforms lead up to. `tops`: those found so far, by frame; or -1.
int topOf(const TransformBuffer& buffer, int frame, StampNs stamp, std::vector<int>& tops) {
  int top = frame;
  for (std::size_t i = 0; i < DEEPEST_TREE && tops[top] < 0; ++i) {
    int parent;
    if (!buffer.isStaticAt(top, stamp, parent)) break;
    top = parent;
  }
  if (tops[top] >= 0) top = tops[top];
  return tops[frame] = top;
}

std::string lagging(StampNs lag, StampNs limit) {
  return "its newest transform is " + inWords(inSeconds(lag)) +
         " older than the newest of all links, and max_transform_age is " +
         inWords(inSeconds(limit));
}

}  // namespace

RobotPoses::RobotPoses(const TransformBuffer& buffer, const RobotModel& robot,
                       const std::string& frame, const std::string& prefix,
                       const std::vector<std::string>& static_joints)
    : buffer_(buffer), frame_(frame), prefix_(prefix) {
  for (const std::string& name : static_joints) {
    if (robot.findJoint(name) >= 0) continue;
    std::vector<std::string> joints;
    for (const Joint& joint : robot.joints()) joints.push_back(joint.name);
    throw InputError("static_joints: '" + name + "' is not a joint of the robot; did you mean '" +
                     nearestName(name, joints) + "'?");
  }
  for (const Body& body : robot.bodies()) {
    BodyOfRobot entry{{}, body.parent, "", true};
    if (body.joint >= 0) {
      entry.joint = robot.joints()[body.joint].name;
      entry.may_be_static = std::count(static_joints.begin(), static_joints.end(), entry.joint) > 0;
    }
    bodies_.push_back(std::move(entry));
  }
  for (std::size_t i = 0; i < robot.links().size(); ++i) {
    const Link& link = robot.links()[i];
    auto& links = bodies_[link.body].links;
    const bool is_first = robot.bodies()[link.body].link == static_cast<int>(i);
    links.insert(is_first ? links.begin() : links.end(), {link.name, link.X_BL});
    if (link.name != frame_) continue;
    body_of_frame_ = link.body;
    X_WB_of_frame_ = link.X_BL.inverse();
  }
  frames();
}

int RobotPoses::frameOf(const std::string& link) const {
  if (prefix_.empty()) return buffer_.findFrame(link);
  const int frame = buffer_.findFrame(withPrefix(prefix_, link));
  if (frame >= 0) return frame;
  const int joined = buffer_.findFrame(prefix_ + link);
  // A root that TF does not have under its prefixed name may be there without prefix ("world").
  return joined < 0 && link == bodies_[0].links.front().name ? buffer_.findFrame(link) : joined;
}

const RobotPoses::Frames& RobotPoses::frames() const {
  const std::size_t nb_known = buffer_.frames().size();
  if (frames_.nb_known == nb_known && !frames_.of_links.empty()) return frames_;
  frames_ = {nb_known, frameOf(frame_), std::vector<std::vector<int>>(bodies_.size())};
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    for (const LinkOfBody& link : bodies_[b].links) {
      frames_.of_links[b].push_back(frameOf(link.name));
    }
  }
  return frames_;
}

FramePoses RobotPoses::start(const Instant& instant, FoundBodies& placed) const {
  FramePoses poses(buffer_, instant);
  const int frame = frames().frame;
  if (frame >= 0) poses.anchor(frame, {Isometry3d::Identity()});
  placed.known.assign(bodies_.size(), 0);
  placed.X_WB.assign(bodies_.size(), Isometry3d::Identity());
  placed.stamps.assign(bodies_.size(), NEVER);
  placed.problems.assign(bodies_.size(), "");
  if (body_of_frame_ >= 0) {
    placed.known[body_of_frame_] = 1;
    placed.X_WB[body_of_frame_] = X_WB_of_frame_;
  }
  return poses;
}

bool RobotPoses::placeByTf(std::size_t body, FramePoses& poses, FoundBodies& placed) const {
  const std::vector<int>& ids = frames_.of_links[body];
  for (std::size_t i = 0; i < ids.size(); ++i) {
    FramePoses::Known found;
    if (ids[i] < 0) continue;
    if (!poses.find(ids[i], found)) {
      placed.stamps[body] = std::min(placed.stamps[body], found.oldest);
      continue;
    }
    placed.known[body] = 1;
    placed.X_WB[body] = found.X_RF * bodies_[body].links[i].X_BL.inverse();
    placed.stamps[body] = found.oldest;
    placed.are_mixed |= found.oldest < found.newest;
    return true;
  }
  return false;
}

/// Links of bodies that are known are where the URDF says if TF does not say, and what TF connects
/// to these is known, too.
void RobotPoses::placeByUrdf(FramePoses& poses, FoundBodies& placed) const {
  std::vector<char> is_done(bodies_.size(), 0);
  for (bool is_new = true; is_new;) {
    is_new = false;
    for (std::size_t b = 0; b < bodies_.size(); ++b) {
      if (is_done[b] || !(placed.known[b] || placeByTf(b, poses, placed))) continue;
      is_done[b] = is_new = true;
      const std::vector<int>& ids = frames_.of_links[b];
      for (std::size_t i = 0; i < ids.size(); ++i) {
        FramePoses::Known found;
        if (ids[i] < 0 || poses.find(ids[i], found)) continue;
        poses.anchor(ids[i], {placed.X_WB[b] * bodies_[b].links[i].X_BL, placed.stamps[b],
                              placed.stamps[b] == NEVER ? EVER_SINCE : placed.stamps[b]});
      }
    }
  }
}

/// Marks the joints on the way from one body to the other.
void RobotPoses::holdBetween(int a, int b, std::vector<int>& held_by) const {
  while (a != b) {
    int& lower = a > b ? a : b;  // a parent comes before its children
    if (!bodies_[lower].may_be_static) held_by[lower] = lower;
    lower = bodies_[lower].parent;
    if (lower < 0) return;  // of another robot
  }
}

std::vector<int> RobotPoses::heldBy(StampNs stamp) const {
  const Frames& ids = frames();
  std::vector<int> tops(ids.nb_known, -1);
  std::vector<int> first_below(ids.nb_known, -1);  // by top frame, the first body
  if (ids.frame >= 0) {
    first_below[topOf(buffer_, ids.frame, stamp, tops)] = std::max(body_of_frame_, 0);
  }
  std::vector<int> held_by(bodies_.size(), -1);
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    for (const int id : ids.of_links[b]) {
      if (id < 0) continue;
      int& first = first_below[topOf(buffer_, id, stamp, tops)];
      if (first < 0) first = static_cast<int>(b);
      holdBetween(first, static_cast<int>(b), held_by);
    }
  }
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    if (held_by[b] < 0 && bodies_[b].parent >= 0) held_by[b] = held_by[bodies_[b].parent];
  }
  if (body_of_frame_ >= 0) held_by[body_of_frame_] = -1;
  return held_by;
}

std::vector<char> RobotPoses::heldAt(StampNs stamp) const {
  std::vector<char> held;
  for (const int by : heldBy(stamp)) held.push_back(by >= 0);
  return held;
}

void RobotPoses::leaveOutHeld(StampNs stamp, FoundBodies& placed) const {
  const std::vector<int> held_by = heldBy(stamp);
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    if (held_by[b] < 0 || !placed.known[b]) continue;
    placed.known[b] = 0;
    placed.problems[b] = "only /tf_static places it, but joint '" + bodies_[held_by[b]].joint +
                         "' is not fixed: publish it on /tf, or list the joint in static_joints";
  }
}

void RobotPoses::explain(std::size_t body, const FramePoses& poses, FoundBodies& placed) const {
  if (!placed.problems[body].empty()) return;
  const std::vector<int>& ids = frames_.of_links[body];
  const int id =
      *std::max_element(ids.begin(), ids.end(), [](int a, int b) { return a < 0 && b >= 0; });
  placed.problems[body] =
      id < 0 ? "TF has no frame of that name" : poses.whyUnknown(id) + " (in '" + frame_ + "')";
}

FoundBodies RobotPoses::place(const Instant& instant, const std::vector<char>& wanted) const {
  FoundBodies placed;
  FramePoses poses = start(instant, placed);
  bool are_all_known = true;
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    if (wanted[b] && !placed.known[b] && !placeByTf(b, poses, placed)) are_all_known = false;
  }
  if (!are_all_known) placeByUrdf(poses, placed);
  leaveOutHeld(instant.stamp, placed);
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    if (wanted[b] && !placed.known[b]) explain(b, poses, placed);
  }
  return placed;
}

FoundBodies RobotPoses::newest(StampNs now, const std::vector<char>& wanted) const {
  FoundBodies found = place({Instant::NEWEST, now}, wanted);
  StampNs newest = EVER_SINCE, common = NEVER;
  // One that is not known now may be known at an earlier instant, if its own transforms are.
  const auto isDated = [&](std::size_t b) { return wanted[b] && found.stamps[b] != NEVER; };
  for (std::size_t b = 0; b < wanted.size(); ++b) {
    if (isDated(b) && found.known[b]) newest = std::max(newest, found.stamps[b]);
  }
  if (newest == EVER_SINCE) return found;
  // Most robots publish all joints with one stamp; then nothing has to be looked up again.
  bool is_one_instant = !found.are_mixed;
  for (std::size_t b = 0; b < wanted.size(); ++b) {
    if (wanted[b] && !found.known[b]) is_one_instant = false;
    if (!isDated(b)) continue;
    is_one_instant &= found.stamps[b] == newest;
    const StampNs lag = newest - found.stamps[b];
    if (lag <= buffer_.limits().max_gap) {
      common = std::min(common, found.stamps[b]);
    } else if (found.known[b]) {
      found.problems[b] = lagging(lag, buffer_.limits().max_gap);
    }
  }
  found.stamp = common;
  if (is_one_instant) return found;
  FoundBodies then = place({Instant::AT, common}, wanted);
  for (std::size_t b = 0; b < wanted.size(); ++b) {
    if (!then.known[b] && !found.problems[b].empty()) then.problems[b] = found.problems[b];
  }
  then.stamp = common;
  return then;
}

bool RobotPoses::frameAt(const Instant& instant, const std::string& frame, FramePoses::Known& found,
                         std::string& why) const {
  const std::string name = withoutLeadingSlash(frame);
  const int id = buffer_.findFrame(name);
  FoundBodies placed;
  FramePoses poses = start(instant, placed);
  if (id >= 0 && poses.find(id, found)) return true;
  placeByUrdf(poses, placed);
  if (id < 0 ? isLinkAt(name, placed, found) : poses.find(id, found)) return true;
  why = id < 0 ? "TF has no frame of that name" : poses.whyUnknown(id);
  return false;
}

bool RobotPoses::isLinkAt(const std::string& frame, const FoundBodies& placed,
                          FramePoses::Known& found) const {
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    for (const LinkOfBody& link : bodies_[b].links) {
      if (!placed.known[b] || !isFrameOf(link.name, prefix_, frame)) continue;
      const StampNs stamp = placed.stamps[b];
      found = {placed.X_WB[b] * link.X_BL, stamp, stamp == NEVER ? EVER_SINCE : stamp};
      return true;
    }
  }
  return false;
}

FramePoses::Known RobotPoses::between(const std::string& target, const std::string& source,
                                      const Instant& instant) const {
  try {
    return poseBetween(buffer_, target, source, instant);
  } catch (const InputError&) {
    FramePoses::Known in_target, in_source;
    std::string why;
    const auto look = [&](const Instant& when) {
      return frameAt(when, target, in_target, why) && frameAt(when, source, in_source, why);
    };
    if (!look(instant)) throw;
    const StampNs oldest = std::min(in_target.oldest, in_source.oldest);
    const StampNs newest = std::max(in_target.newest, in_source.newest);
    if (instant.kind == Instant::NEWEST && oldest < newest && !look({Instant::AT, oldest})) throw;
    return {in_target.X_RF.inverse() * in_source.X_RF, oldest, newest};
  }
}

}  // namespace collision_pairs
