#include "frame_ways.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "user_text.h"

namespace collision_pairs {
namespace {

using Eigen::Isometry3d;

bool isAmong(const std::vector<int>& frames, int frame) {
  return std::find(frames.begin(), frames.end(), frame) != frames.end();
}

}  // namespace

LinkFrames::LinkFrames(const TransformBuffer& buffer, std::vector<Link> links)
    : buffer_(&buffer), links_(std::move(links)) {}

void LinkFrames::update() {
  const std::size_t nb_named = buffer_->frames().size();
  if (nb_named == nb_named_ && !by_frame_.empty()) return;
  nb_named_ = nb_named;
  by_frame_.assign(nbFrames(), -1);
  of_bodies_.clear();
  for (std::size_t i = 0; i < links_.size(); ++i) {
    const int named = buffer_->findFrame(links_[i].name);
    const int frame = named >= 0 ? named : static_cast<int>(nb_named_ + i);
    by_frame_[frame] = static_cast<int>(i);
    const auto body = static_cast<std::size_t>(links_[i].body);
    of_bodies_.resize(std::max(of_bodies_.size(), body + 1));
    of_bodies_[body].push_back(frame);
  }
}

int LinkFrames::find(const std::string& name) const {
  const int named = buffer_->findFrame(name);
  if (named >= 0) return named;
  const auto link = std::find_if(links_.begin(), links_.end(),
                                 [&](const Link& candidate) { return candidate.name == name; });
  return link == links_.end()
             ? -1
             : static_cast<int>(nb_named_) + static_cast<int>(link - links_.begin());
}

FrameWays::FrameWays(const TransformBuffer& buffer, int target, const Instant& instant,
                     const LinkFrames* links)
    : buffer_(buffer), links_(links), target_(target), instant_(instant) {
  if (target < 0) return;  // no transform names it
  noted_.reserve(64);
  anchors_.push_back({target, target, -1, target});
  Way way;
  way.is_known = true;
  std::vector<int> path, done;
  if (goUp(target, way, path, done)) return;
  is_in_cycle_ = true;  // what hangs on the target would be what the target hangs on
  noted_.clear();
}

const std::vector<int>& FrameWays::linksFixedTo(int frame) const {
  static const std::vector<int> none;
  const int body = links_ ? links_->bodyOf(frame) : -1;
  return body < 0 ? none : links_->ofBody(body);
}

/// To the same frame, or to a body from another one. Links of one body that hang on each other in
/// another order than in the URDF are no cycle.
bool FrameWays::isBack(int frame, const std::vector<int>& path) const {
  if (isAmong(path, frame)) return true;
  const int body = links_ ? links_->bodyOf(frame) : -1;
  bool is_left = false;
  for (auto below = path.rbegin(); body >= 0 && below != path.rend(); ++below) {
    const int other = links_->bodyOf(*below);
    if (other == body && is_left) return true;
    is_left = is_left || (other >= 0 && other != body);
  }
  return false;
}

bool FrameWays::goUp(int frame, Way way, std::vector<int>& path, std::vector<int>& done) const {
  if (isBack(frame, path)) return false;
  const bool is_done = isAmong(done, frame) && (!way.is_known || noted_.count(frame) > 0);
  if (is_done || path.size() > TransformBuffer::DEEPEST_TREE) return true;
  way.top = frame;
  if (way.is_known) noted_.emplace(frame, way);
  path.push_back(frame);
  bool has_end = true;
  StampNs stamp;
  int parent;
  if (way.is_known && step(frame, stamp, parent)) {
    pass(frame, stamp, way);
    has_end = goUp(parent, way, path, done);
  } else {
    parent = lastParent(frame);
    if (parent >= 0) has_end = goUp(parent, {}, path, done);
    for (const int fixed : linksFixedTo(frame)) {
      if (!has_end || lastParent(fixed) < 0 || isBelow(fixed, path)) continue;
      Way by_urdf = way;
      passFixedJoint(frame, fixed, by_urdf);
      has_end = goUp(fixed, by_urdf, path, done);
    }
  }
  path.pop_back();
  done.push_back(frame);
  return has_end;
}

/// On the path, or by transforms of its body alone on a frame of it: on its last one, or on one
/// from which the path leads by links of that body, whose transforms have another order than its
/// joints.
bool FrameWays::isBelow(int link, const std::vector<int>& path) const {
  const int met = firstAbove(link, path);
  if (met < 0 || met == link) return met >= 0;
  const auto isOfOther = [&](int frame) {
    const int body = links_->bodyOf(frame);
    return body >= 0 && body != links_->bodyOf(link);
  };
  for (int frame = link; frame != met; frame = lastParent(frame)) {
    if (isOfOther(frame)) return false;
  }
  return met == path.back() ||
         std::none_of(std::find(path.begin(), path.end(), met), path.end(), isOfOther);
}

int FrameWays::firstAbove(int frame, const std::vector<int>& frames) const {
  for (std::size_t i = 0; i <= TransformBuffer::DEEPEST_TREE && frame >= 0; ++i) {
    if (isAmong(frames, frame)) return frame;
    frame = lastParent(frame);
  }
  return -1;
}

int FrameWays::lastParent(int frame) const {
  const TransformGate& gate = buffer_.gate();
  if (!gate.isHeard(frame)) return -1;
  const StampNs at = gate.newestAt(frame, instant_.stamp);
  if (at == NEVER) return buffer_.parentAt(frame, instant_.stamp);
  const bool is_old = at == EVER_SINCE || instant_.stamp - at > buffer_.limits().max_age;
  return is_old ? -1 : buffer_.parentAt(frame, at);
}

bool FrameWays::step(int frame, StampNs& stamp, int& parent) const {
  const TransformGate& gate = buffer_.gate();
  if (!gate.isHeard(frame)) return false;
  StampNs at = instant_.stamp;
  if (instant_.kind == Instant::NEWEST) {
    at = gate.newestAt(frame, instant_.stamp);
    if (at == EVER_SINCE) return false;
    stamp = at;
    if (at == NEVER) at = instant_.stamp;
    if (stamp != NEVER && instant_.stamp - at > buffer_.limits().max_age) return false;
  } else {
    stamp = gate.isStatic(frame) ? NEVER : at;
  }
  if (!gate.isKnown(frame, at)) {
    if (instant_.kind == Instant::NEWEST && stamp != NEVER) {
      newest_unknown_ = std::max(newest_unknown_, stamp);
    }
    return false;
  }
  parent = buffer_.parentAt(frame, at);
  return parent >= 0;
}

void FrameWays::pass(int frame, StampNs stamp, Way& way) const {
  way.oldest = std::min(way.oldest, stamp);
  if (stamp != NEVER) {
    way.newest = std::max(way.newest, stamp);
  } else {
    way.is_settled = way.is_settled && buffer_.gate().isSettled(frame);
  }
}

void FrameWays::passFixedJoint(int from, int to, Way& way) const {
  anchors_.push_back({to, from, way.anchor, way.top});
  way.anchor = static_cast<int>(anchors_.size()) - 1;
  way.top = to;
  way.is_settled = false;
}

FrameWays::Way FrameWays::to(int source) const {
  if (source != target_) return climb(source, 0);
  Way way;
  way.is_known = true;
  way.top = target_;
  return way;
}

FrameWays::Way FrameWays::climb(int frame, std::size_t nb_steps) const {
  const auto [entry, is_new] = noted_.try_emplace(frame);
  Way& way = entry->second;
  if (!is_new) return way;  // what hangs on itself meets its own, which is not known
  way = stepUp(frame, nb_steps);
  if (way.is_known) return way;
  const std::vector<int>& links = linksFixedTo(frame);
  for (const int fixed : links) {
    const auto seen = noted_.find(fixed);
    if (seen == noted_.end() && firstAbove(fixed, {frame}) >= 0) continue;
    Way up = seen == noted_.end() ? stepUp(fixed, nb_steps) : seen->second;
    if (!up.is_known) continue;
    passFixedJoint(fixed, frame, up);
    return way = up;
  }
  for (const int fixed : links) noted_.try_emplace(fixed, stepUp(fixed, nb_steps));
  return way;
}

FrameWays::Way FrameWays::stepUp(int frame, std::size_t nb_steps) const {
  StampNs stamp;
  int parent;
  if (nb_steps >= TransformBuffer::DEEPEST_TREE || !step(frame, stamp, parent)) return {};
  Way way = climb(parent, nb_steps + 1);
  pass(frame, stamp, way);
  return way;
}

Isometry3d FrameWays::poseOf(int source, int number, int top, StampNs stamp) const {
  const Anchor& anchor = anchors_[static_cast<std::size_t>(number)];
  Isometry3d X_AS = poseBelow(top, source, stamp);
  if (anchor.frame != top) X_AS = poseBelow(top, anchor.frame, stamp).inverse() * X_AS;
  if (anchor.before < 0) return X_AS;
  return poseOf(anchor.via, anchor.before, anchor.top, stamp) * links_->X_BL(anchor.via).inverse() *
         links_->X_BL(anchor.frame) * X_AS;
}

/// tf2 walks from the frame up each time: no further than to one that was placed before.
Isometry3d FrameWays::poseBelow(int top, int frame, StampNs stamp) const {
  if (stamp != placed_at_) placed_.clear();
  placed_at_ = stamp;
  const Isometry3d* X_TA = nullptr;
  int above = frame;
  for (std::size_t i = 0; i < TransformBuffer::DEEPEST_TREE && above >= 0 && above != top; ++i) {
    above = buffer_.parentAt(above, stamp);
    const auto placed = placed_.find(above);
    if (placed == placed_.end() || placed->second.top != top) continue;
    X_TA = &placed->second.X_TF;
    break;
  }
  const Isometry3d X_TF =
      X_TA ? *X_TA * buffer_.poseBelow(above, frame, stamp) : buffer_.poseBelow(top, frame, stamp);
  placed_.insert_or_assign(frame, Placed{top, X_TF});
  return X_TF;
}

int FrameWays::lastAncestor(int frame) const {
  StampNs stamp;
  std::size_t nb_steps = 0;
  for (int parent; step(frame, stamp, parent); frame = parent) {
    if (++nb_steps > TransformBuffer::DEEPEST_TREE) return -1;
  }
  return frame;
}

bool FrameWays::isPlaced(int frame) const {
  const int last = lastAncestor(frame);
  return last >= 0 && buffer_.gate().isHeard(last);
}

std::string FrameWays::whyNot(int source) const {
  const int last = lastAncestor(source);
  if (is_in_cycle_ || last < 0) return "its ancestors form a cycle";
  const TransformGate& gate = buffer_.gate();
  const StampLimits& limits = buffer_.limits();
  const bool is_newest = instant_.kind == Instant::NEWEST && gate.isHeard(last);
  const StampNs newest = is_newest ? gate.newestAt(last, instant_.stamp) : NEVER;
  const bool is_dated = newest != NEVER && newest != EVER_SINCE;
  const StampNs age = is_dated ? instant_.stamp - newest : 0;
  const std::string why =
      age > limits.max_age ? "its newest transform is " + inWords(inSeconds(age)) +
                                 " old, and max_pose_age is " + inWords(inSeconds(limits.max_age))
                           : gate.whyUnknown(last, is_dated ? newest : instant_.stamp);
  return last == source ? why : "transform of '" + buffer_.frames()[last] + "': " + why;
}

FoundPose poseBetween(const TransformBuffer& buffer, const std::string& target,
                      const std::string& source, Instant instant, const LinkFrames* links) {
  const auto numberOf = [&](const std::string& name) {
    const std::string plain = withoutLeadingSlash(name);
    return links ? links->find(plain) : buffer.findFrame(plain);
  };
  const int from = numberOf(target), to = numberOf(source);
  if (from >= 0 && from == to) return {};
  if (from < 0 || to < 0) {
    throw NotConnected("TF has no frame '" + (from < 0 ? target : source) + "'");
  }
  std::optional<FrameWays> ways;
  const auto find = [&] {
    ways.emplace(buffer, from, instant, links);
    const FrameWays::Way way = ways->to(to);
    if (way.is_known) return way;
    const std::pair<int, const std::string&> ends[] = {{to, source}, {from, target}};
    for (const auto& [frame, name] : ends) {
      if (ways->isPlaced(frame)) throw InputError(ways->whyNot(frame));
      const int body = links ? links->bodyOf(frame) : -1;  // or its body, by another link
      for (std::size_t i = 0; body >= 0 && i < links->ofBody(body).size(); ++i) {
        const int link = links->ofBody(body)[i];
        if (ways->isPlaced(link)) throw InputError("'" + name + "': " + ways->whyNot(link));
      }
    }
    for (const auto& [frame, name] : ends) {
      if (ways->isInCycle(frame)) throw NotConnected("'" + name + "': " + ways->whyNot(frame));
      if (links && !links->isNamed(frame)) throw NotConnected("TF has no frame '" + name + "'");
    }
    throw NotConnected("TF does not connect '" + target + "' and '" + source + "'");
  };
  FrameWays::Way way = find();
  if (instant.kind == Instant::NEWEST && way.oldest != NEVER) {
    instant = {Instant::AT, way.oldest};
    way = find();
  }
  return {ways->poseOf(to, way, instant.stamp), way.oldest};
}

}  // namespace collision_pairs
