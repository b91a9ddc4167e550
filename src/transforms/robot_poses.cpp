#include "robot_poses.h"

#include <algorithm>

#include "collision_pairs/input_error.h"
#include "frame_names.h"
#include "user_text.h"

namespace collision_pairs {
namespace {

using Eigen::Isometry3d;

bool isAmong(const std::vector<int>& frames, int frame) {
  return std::find(frames.begin(), frames.end(), frame) != frames.end();
}

}  // namespace

const char* const RobotPoses::NO_FRAME = "TF has no frame of that name";

RobotPoses::RobotPoses(const TransformBuffer& buffer, const RobotModel& robot,
                       const std::string& frame, const std::vector<std::string>& static_joints)
    : buffer_(buffer), frame_(frame) {
  for (const std::string& name : static_joints) {
    if (robot.findJoint(name) >= 0) continue;
    std::vector<std::string> joints;
    for (const Joint& joint : robot.joints()) joints.push_back(joint.name);
    throw InputError("static_joints: '" + name + "' is not a joint of the robot; did you mean '" +
                     nearestName(name, joints) + "'?");
  }
  for (const Body& body : robot.bodies()) {
    const bool is_root = body.parent < 0;
    const int root = is_root ? static_cast<int>(bodies_.size())
                             : bodies_[static_cast<std::size_t>(body.parent)].root;
    BodyOfRobot entry{{}, body.parent, root, "", true};
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
}

const RobotPoses::Frames& RobotPoses::frames() const {
  const std::size_t nb_known = buffer_.frames().size();
  if (frames_.nb_known == nb_known && !frames_.of_links.empty()) return frames_;
  frames_ = {nb_known, buffer_.findFrame(frame_), std::vector<std::vector<int>>(bodies_.size())};
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    for (const LinkOfBody& link : bodies_[b].links) {
      frames_.of_links[b].push_back(buffer_.findFrame(link.name));
    }
  }
  return frames_;
}

bool RobotPoses::isFound(const Layout& layout, std::size_t body) const {
  return layout.places[body].anchor >= 0 || static_cast<int>(body) == body_of_frame_;
}

int RobotPoses::bodyOf(int frame) const {
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    if (isAmong(frames().of_links[b], frame)) return static_cast<int>(b);
  }
  return -1;
}

FrameWays RobotPoses::waysFrom(int frame, const Instant& instant) const {
  FrameWays ways(buffer_, frame, instant);
  std::vector<int> tried;
  if (hangsOnItself(ways, {frame}, -1, tried)) ways.breakCycle();
  return ways;
}

/// Links of one body that hang on each other in another order than in the URDF are no cycle.
bool RobotPoses::isCycle(const std::vector<int>& path, int met) const {
  int first = -1;
  return std::any_of(std::find(path.begin(), path.end(), met), path.end(), [&](int frame) {
    const int body = bodyOf(frame);
    if (first < 0) first = body;
    return body >= 0 && body != first;
  });
}

bool RobotPoses::hangsOnItself(const FrameWays& ways, std::vector<int> path, int below,
                               std::vector<int>& tried) const {
  for (int parent; (parent = ways.lastParent(path.back())) >= 0; path.push_back(parent)) {
    if (isAmong(path, parent)) return parent != below && isCycle(path, parent);
  }
  const int top = path.back(), body = path.size() > 1 ? bodyOf(top) : -1;
  if (body < 0 || isAmong(tried, top)) return false;
  tried.push_back(top);
  for (const int fixed : frames().of_links[static_cast<std::size_t>(body)]) {
    if (fixed < 0 || ways.lastParent(fixed) < 0) continue;
    std::vector<int> longer = path;
    longer.push_back(fixed);
    const bool is_met = isAmong(path, fixed);
    if (is_met ? isCycle(path, fixed) : hangsOnItself(ways, longer, top, tried)) return true;
  }
  return false;
}

bool RobotPoses::findPlace(std::size_t body, Layout& layout) const {
  const std::vector<int>& ids = frames_.of_links[body];
  Place& place = layout.places[body];
  for (std::size_t i = 0; i < ids.size(); ++i) {
    for (std::size_t a = 0; ids[i] >= 0 && a < layout.anchors.size(); ++a) {
      FrameWays::Way way = layout.anchors[a].ways.to(ids[i]);
      if (!way.is_known) {
        place.way.oldest = std::min(place.way.oldest, way.oldest);
        continue;
      }
      way.join(layout.anchors[a].way);
      place = {static_cast<int>(a), i, way};
      return true;
    }
  }
  return false;
}

/// Links of bodies that are found are where the URDF says if TF does not say, and what TF connects
/// to these is found, too.
void RobotPoses::joinByUrdf(const Instant& instant, Layout& layout) const {
  std::vector<char> is_done(bodies_.size(), 0);
  for (bool is_new = true; is_new;) {
    is_new = false;
    for (std::size_t b = 0; b < bodies_.size(); ++b) {
      if (is_done[b] || !(isFound(layout, b) || findPlace(b, layout))) continue;
      is_done[b] = is_new = true;
      const std::vector<int>& ids = frames_.of_links[b];
      for (std::size_t i = 0; i < ids.size(); ++i) {
        const bool is_known =
            ids[i] < 0 || std::any_of(layout.anchors.begin(), layout.anchors.end(),
                                      [&](const Anchor& a) { return a.ways.to(ids[i]).is_known; });
        if (is_known) continue;
        layout.anchors.push_back(
            {waysFrom(ids[i], instant), static_cast<int>(b), i, layout.places[b].way});
      }
    }
  }
}

RobotPoses::Layout RobotPoses::layOut(const Instant& instant,
                                      const std::vector<char>& wanted) const {
  Layout layout;
  layout.places.resize(bodies_.size());
  const int frame = frames().frame;
  if (frame >= 0) layout.anchors.push_back({waysFrom(frame, instant), -1, 0, {}});
  bool are_all_found = true;
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    if (wanted[b] && !isFound(layout, b) && !findPlace(b, layout)) are_all_found = false;
  }
  if (!are_all_found) joinByUrdf(instant, layout);
  return layout;
}

Isometry3d RobotPoses::poseOf(const Anchor& anchor, const Layout& layout, StampNs stamp) const {
  if (anchor.body < 0) return Isometry3d::Identity();
  const auto body = static_cast<std::size_t>(anchor.body);
  return poseOf(body, layout, stamp) * bodies_[body].links[anchor.link].X_BL;
}

/// Throws InputError if tf2 does not know it.
Isometry3d RobotPoses::poseOf(std::size_t body, const Layout& layout, StampNs stamp) const {
  const Place& place = layout.places[body];
  if (place.anchor < 0) return X_WB_of_frame_;
  const Anchor& anchor = layout.anchors[static_cast<std::size_t>(place.anchor)];
  return poseOf(anchor, layout, stamp) *
         buffer_.poseAt(anchor.ways.target(), frames_.of_links[body][place.link], stamp) *
         bodies_[body].links[place.link].X_BL.inverse();
}

std::string RobotPoses::whyNot(std::size_t body, const Layout& layout) const {
  const std::vector<int>& ids = frames_.of_links[body];
  const int id =
      *std::max_element(ids.begin(), ids.end(), [](int a, int b) { return a < 0 && b >= 0; });
  if (id < 0) return NO_FRAME;
  if (layout.anchors.empty()) return "TF has no frame '" + frame_ + "'";
  return layout.anchors.front().ways.whyNot(id) + " (in '" + frame_ + "')";
}

FoundBodies RobotPoses::place(const Instant& instant, const std::vector<char>& wanted) const {
  return place(layOut(instant, wanted), instant.stamp, wanted);
}

FoundBodies RobotPoses::place(const Layout& layout, StampNs stamp,
                              const std::vector<char>& wanted) const {
  const std::vector<int> held_by = heldBy(stamp);
  FoundBodies found;
  found.known.assign(bodies_.size(), 0);
  found.X_WB.assign(bodies_.size(), Isometry3d::Identity());
  found.problems.assign(bodies_.size(), "");
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    if (!isFound(layout, b)) {
      if (wanted[b]) found.problems[b] = whyNot(b, layout);
    } else if (held_by[b] >= 0) {
      found.problems[b] = "only /tf_static places it, but joint '" + bodies_[held_by[b]].joint +
                          "' is not fixed: publish it on /tf, or list the joint in static_joints";
    } else if (wanted[b]) {
      try {
        found.X_WB[b] = poseOf(b, layout, stamp);
        found.known[b] = 1;
      } catch (const InputError& error) {
        found.problems[b] = error.what();
      }
    }
  }
  return found;
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

/// All wanted ones hang on a frame that hangs on nothing, by transforms of that very stamp and by
/// static ones that nothing can have changed since. So it is wherever one program sends them all.
bool RobotPoses::holdsAt(StampNs stamp, const Layout& layout,
                         const std::vector<char>& wanted) const {
  const bool is_one_tree = layout.anchors.size() == 1 && layout.anchors[0].body < 0;
  if (!is_one_tree || buffer_.gate().isHeard(layout.anchors[0].ways.target())) return false;
  for (std::size_t b = 0; b < wanted.size(); ++b) {
    if (!wanted[b]) continue;
    const auto& [anchor, link, way] = layout.places[b];  // another link may be known at that stamp
    if (!isFound(layout, b) || link > 0 || !way.is_settled) return false;
    if (way.oldest != NEVER && (way.oldest != stamp || way.newest != stamp)) return false;
  }
  return true;
}

FoundBodies RobotPoses::newest(StampNs now, const std::vector<char>& wanted) const {
  const Layout layout = layOut({Instant::NEWEST, now}, wanted);
  StampNs newest = EVER_SINCE, common = NEVER;
  // One that is not found now may be at an earlier instant, if its own transforms are.
  const auto isDated = [&](std::size_t b) {
    return wanted[b] && layout.places[b].way.oldest != NEVER;
  };
  for (std::size_t b = 0; b < wanted.size(); ++b) {
    if (isDated(b) && isFound(layout, b)) newest = std::max(newest, layout.places[b].way.newest);
  }
  StampNs heard = newest;  // also of what is in doubt now: others may be behind it
  for (std::size_t b = 0; b < wanted.size(); ++b) {
    if (!wanted[b] || isFound(layout, b)) continue;
    for (const int id : frames().of_links[b]) heard = std::max(heard, newestAbove(id, now));
  }
  std::vector<std::string> problems(wanted.size());
  for (std::size_t b = 0; b < wanted.size(); ++b) {
    if (wanted[b] && !isFound(layout, b)) problems[b] = whyNot(b, layout);
    if (newest == EVER_SINCE || !isDated(b)) continue;
    const StampNs lag = heard - layout.places[b].way.oldest;
    if (lag <= buffer_.limits().max_gap) {
      common = std::min(common, layout.places[b].way.oldest);
    } else if (isFound(layout, b)) {
      problems[b] = "its newest transform is " + inWords(inSeconds(lag)) +
                    " older than the newest of all links, and max_transform_age is " +
                    inWords(inSeconds(buffer_.limits().max_gap));
    }
  }
  const StampNs stamp = common == NEVER ? now : common;
  FoundBodies found = holdsAt(stamp, layout, wanted) ? place(layout, stamp, wanted)
                                                     : place({Instant::AT, stamp}, wanted);
  for (std::size_t b = 0; b < wanted.size(); ++b) {
    const bool is_lagging = isFound(layout, b) && !problems[b].empty();
    if (is_lagging) found.known[b] = 0;
    if (!found.known[b] && !problems[b].empty()) found.problems[b] = problems[b];
  }
  found.stamp = common;
  return found;
}

bool RobotPoses::locate(const std::string& frame, const Layout& layout, Located& found) const {
  const int id = buffer_.findFrame(frame);
  for (std::size_t a = 0; id >= 0 && a < layout.anchors.size(); ++a) {
    found.way = layout.anchors[a].ways.to(id);
    if (!found.way.is_known) continue;
    found.way.join(layout.anchors[a].way);
    found.anchor = static_cast<int>(a);
    found.frame = id;
    return true;
  }
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    for (const LinkOfBody& link : bodies_[b].links) {
      if (id >= 0 || link.name != frame) continue;
      found = {-1, static_cast<int>(b), link.X_BL, layout.places[b].way};
      return isFound(layout, b);
    }
  }
  found.frame = -1;
  return false;
}

Isometry3d RobotPoses::poseOf(const Located& located, const Layout& layout, StampNs stamp) const {
  if (located.anchor < 0) {
    return poseOf(static_cast<std::size_t>(located.frame), layout, stamp) * located.X_BL;
  }
  const Anchor& anchor = layout.anchors[static_cast<std::size_t>(located.anchor)];
  return poseOf(anchor, layout, stamp) * buffer_.poseAt(anchor.ways.target(), located.frame, stamp);
}

FoundPose RobotPoses::between(const std::string& target, const std::string& source,
                              const Instant& instant) const {
  try {
    return poseBetween(buffer_, target, source, instant,
                       [&](int from, const Instant& when) { return waysFrom(from, when); });
  } catch (const InputError&) {
    Layout layout;
    Located in_target, in_source;
    const auto look = [&](const Instant& when) {
      layout = layOut(when, std::vector<char>(bodies_.size(), 0));
      joinByUrdf(when, layout);
      for (const auto& [name, found] : {std::pair(&target, &in_target), {&source, &in_source}}) {
        if (locate(withoutLeadingSlash(*name), layout, *found)) continue;
        // TF does not name this link: what matters is why its body is not known.
        if (found->frame < 0 || frames_.of_links.empty()) return false;
        const auto body = static_cast<std::size_t>(found->frame);
        const auto& ids = frames_.of_links[body];
        if (std::all_of(ids.begin(), ids.end(), [](int id) { return id < 0; })) return false;
        throw InputError("'" + *name + "': " + whyNot(body, layout));
      }
      return true;
    };
    if (!look(instant)) throw;
    const StampNs oldest = std::min(in_target.way.oldest, in_source.way.oldest);
    StampNs stamp = instant.stamp;
    if (instant.kind == Instant::NEWEST && oldest != NEVER) {
      stamp = oldest;
      if (!look({Instant::AT, stamp})) throw;
    }
    const Isometry3d X_WT = poseOf(in_target, layout, stamp);
    return {X_WT.inverse() * poseOf(in_source, layout, stamp), oldest};
  }
}

}  // namespace collision_pairs
