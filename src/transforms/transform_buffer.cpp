#include "transform_buffer.h"

#include <algorithm>
#include <cmath>

#include <geometry_msgs/TransformStamped.h>
#include <tf2/buffer_core.h>
#include <tf2/exceptions.h>

#include "frame_names.h"
#include "user_text.h"

namespace collision_pairs {
namespace {

using Eigen::Isometry3d;

constexpr std::size_t DEEPEST_TREE = tf2::BufferCore::MAX_GRAPH_DEPTH;
constexpr std::size_t MOST_EPOCHS = 1000;
constexpr StampNs SECOND = 1000000000;

ros::Time toTime(StampNs stamp) {
  const StampNs positive = std::clamp<StampNs>(stamp, 1, LAST_STAMP);
  return ros::Time(static_cast<std::uint32_t>(positive / SECOND),
                   static_cast<std::uint32_t>(positive % SECOND));
}

}  // namespace

bool isPose(const Eigen::Vector3d& p, const Eigen::Quaterniond& R) {
  return p.allFinite() && std::abs(R.norm() - 1.0) < 1e-3;
}

TransformBuffer::TransformBuffer(const PoseLimits& limits) : gate_(limits) {
  beginEpoch(EVER_SINCE);
}

TransformBuffer::TransformBuffer(TransformBuffer&&) noexcept = default;
TransformBuffer::~TransformBuffer() = default;

std::string TransformBuffer::take(const ReceivedTransform& transform, bool is_static,
                                  const std::string& publisher, StampNs now) {
  if (!isPose(transform.p_PC, transform.R_PC)) return "it is not finite, or not a rotation";
  const std::string child = withoutLeadingSlash(transform.child);
  const std::string parent = withoutLeadingSlash(transform.parent);
  if (child.empty() || parent.empty()) return "a frame has no name";
  if (child == parent) return "it is its own parent";
  if (child.front() == '/' || parent.front() == '/') return "a name begins with two slashes";
  const int frame = gate_.names().add(child);
  const int parent_frame = frame < 0 ? -1 : gate_.names().add(parent);
  if (parent_frame < 0) return "more than 10000 frames are named on TF";
  const FramePose pose{parent_frame, transform.p_PC, transform.R_PC.normalized()};
  const auto [what, why] = gate_.admit(frame, pose, is_static, publisher, transform.stamp, now);
  using Store = TransformGate::Store;
  if (what == Store::NOTHING) return why;
  // All stamps of an epoch that is as young as a doubt are in doubt where a static pose changes.
  const bool is_young = epochs_.back().since > before(now, limits().lasting);
  if (what == Store::KIND || (what == Store::POSE && !is_young)) {
    beginEpoch(now);
    return why;
  }
  for (std::size_t i = 0; i < epochs_.size(); ++i) {
    const bool is_last = i + 1 == epochs_.size();
    const bool is_over =
        !is_last && epochs_[i + 1].since < before(transform.stamp, limits().max_gap);
    const bool takes = is_static ? is_last || what == Store::FIRST
                                 : !is_over && !gate_.isStaticAt(frame, epochs_[i].since);
    if (takes) store(epochs_[i], frame, pose, transform.stamp, is_static);
  }
  return why;
}

void TransformBuffer::store(Epoch& epoch, int frame, const FramePose& pose, StampNs stamp,
                            bool is_static) const {
  geometry_msgs::TransformStamped message;
  message.header.stamp = toTime(stamp);
  message.header.frame_id = frames()[pose.parent];
  message.child_frame_id = frames()[frame];
  message.transform.translation.x = pose.p_PC.x();
  message.transform.translation.y = pose.p_PC.y();
  message.transform.translation.z = pose.p_PC.z();
  message.transform.rotation.x = pose.R_PC.x();
  message.transform.rotation.y = pose.R_PC.y();
  message.transform.rotation.z = pose.R_PC.z();
  message.transform.rotation.w = pose.R_PC.w();
  epoch.tf->setTransform(message, "", is_static);
}

/// With the static poses that count now, and the samples between which a pose may be asked for.
void TransformBuffer::beginEpoch(StampNs now) {
  epochs_.push_back(
      {now, std::make_unique<tf2::BufferCore>(ros::Duration().fromNSec(limits().kept))});
  for (std::size_t i = 0; i < frames().size(); ++i) {
    const int frame = static_cast<int>(i);
    gate_.forEachSince(frame, before(now, limits().max_gap),
                       [&](const FramePose& pose, StampNs stamp) {
                         store(epochs_.back(), frame, pose, stamp, stamp == NEVER);
                       });
  }
  while (epochs_.size() > MOST_EPOCHS ||
         (epochs_.size() > 1 && epochs_[1].since < before(now, limits().kept))) {
    epochs_.pop_front();
  }
}

void TransformBuffer::restart(StampNs now) {
  gate_.restart(now);
  epochs_.clear();
  beginEpoch(EVER_SINCE);
}

const TransformBuffer::Epoch& TransformBuffer::epochAt(StampNs stamp) const {
  auto epoch = epochs_.rbegin();
  while (epoch->since > stamp && std::next(epoch) != epochs_.rend()) ++epoch;
  return *epoch;
}

int TransformBuffer::parentAt(int frame, StampNs stamp) const {
  const int parent = gate_.parentAt(frame, stamp);
  if (parent >= 0) return parent;
  std::string name;
  const bool has = epochAt(stamp).tf->_getParent(frames()[frame], toTime(stamp), name);
  return has ? findFrame(name) : -1;
}

Isometry3d TransformBuffer::poseAt(int target, int source, StampNs stamp) const {
  try {
    const auto X = epochAt(stamp)
                       .tf->lookupTransform(frames()[target], frames()[source], toTime(stamp))
                       .transform;
    Isometry3d X_TS = Isometry3d::Identity();
    X_TS.linear() = Eigen::Quaterniond(X.rotation.w, X.rotation.x, X.rotation.y, X.rotation.z)
                        .normalized()
                        .toRotationMatrix();
    X_TS.translation() = Eigen::Vector3d(X.translation.x, X.translation.y, X.translation.z);
    return X_TS;
  } catch (const tf2::TransformException& error) {
    throw InputError(error.what());
  }
}

void FrameWays::Way::join(const Way& other) {
  oldest = std::min(oldest, other.oldest);
  newest = std::max(newest, other.newest);
  is_settled = is_settled && other.is_settled;
}

FrameWays::FrameWays(const TransformBuffer& buffer, int target, const Instant& instant)
    : buffer_(buffer), target_(target), instant_(instant) {
  makeRoom(64);
  Way way;
  way.is_known = true;
  StampNs stamp;
  bool is_known = true;
  for (int frame = target, parent = -1, i = 0; i <= static_cast<int>(DEEPEST_TREE); ++i) {
    if (is_known ? !note(frame, way).second : slots_[slotOf(frame)] >= 0) {
      breakCycle();
      return;
    }
    is_known = is_known && step(frame, stamp, parent);
    if (is_known) {
      pass(frame, stamp, way);
    } else {
      parent = lastParent(frame);
    }
    if (parent < 0) return;
    frame = parent;
  }
}

void FrameWays::breakCycle() {
  is_in_cycle_ = true;
  noted_.clear();
  makeRoom(slots_.size());
}

std::size_t FrameWays::slotOf(int frame) const {
  const std::size_t last = slots_.size() - 1;  // their number is a power of two
  std::size_t slot = static_cast<std::size_t>(frame) & last;
  while (slots_[slot] >= 0 && noted_[static_cast<std::size_t>(slots_[slot])].frame != frame) {
    slot = (slot + 1) & last;
  }
  return slot;
}

void FrameWays::makeRoom(std::size_t nb_slots) const {
  slots_.assign(nb_slots, -1);
  for (std::size_t i = 0; i < noted_.size(); ++i) {
    slots_[slotOf(noted_[i].frame)] = static_cast<int>(i);
  }
}

std::pair<std::size_t, bool> FrameWays::note(int frame, const Way& way) const {
  const std::size_t slot = slotOf(frame), index = noted_.size();
  if (slots_[slot] >= 0) return {static_cast<std::size_t>(slots_[slot]), false};
  slots_[slot] = static_cast<int>(index);
  noted_.push_back({frame, way});
  if (2 * noted_.size() > slots_.size()) makeRoom(2 * slots_.size());
  return {index, true};
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
    stamp = gate.isStaticAt(frame, at) ? NEVER : at;
  }
  if (!buffer_.isKnown(frame, at)) return false;
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

FrameWays::Way FrameWays::to(int source) const {
  if (source != target_) return climb(source, 0);
  Way way;
  way.is_known = true;
  return way;
}

FrameWays::Way FrameWays::climb(int frame, std::size_t nb_steps) const {
  Way way;
  if (nb_steps > DEEPEST_TREE) return way;
  const auto [at, is_new] = note(frame, way);
  if (!is_new) return noted_[at].way;
  StampNs stamp;
  int parent;
  if (!step(frame, stamp, parent)) return way;
  way = climb(parent, nb_steps + 1);  // what hangs on itself meets its own, which is not known
  pass(frame, stamp, way);
  return noted_[at].way = way;
}

int FrameWays::lastAncestor(int frame) const {
  StampNs stamp;
  std::size_t nb_steps = 0;
  for (int parent; step(frame, stamp, parent); frame = parent) {
    if (++nb_steps > DEEPEST_TREE) return -1;
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
                      const std::string& source, Instant instant, const WaysFrom& waysFrom) {
  const int from = buffer.findFrame(withoutLeadingSlash(target));
  const int to = buffer.findFrame(withoutLeadingSlash(source));
  if (from >= 0 && from == to) return {};
  if (from < 0 || to < 0) {
    throw NotConnected("TF has no frame '" + (from < 0 ? target : source) + "'");
  }
  const auto find = [&] {
    const FrameWays ways = waysFrom(from, instant);
    const FrameWays::Way way = ways.to(to);
    if (way.is_known) return way;
    for (const int frame : {to, from}) {
      if (ways.isPlaced(frame)) throw InputError(ways.whyNot(frame));
    }
    for (const int frame : {to, from}) {
      if (!ways.isInCycle(frame)) continue;
      throw NotConnected("'" + buffer.frames()[frame] + "': " + ways.whyNot(frame));
    }
    throw NotConnected("TF does not connect '" + target + "' and '" + source + "'");
  };
  FrameWays::Way way = find();
  if (instant.kind == Instant::NEWEST && way.oldest != NEVER) {
    instant = {Instant::AT, way.oldest};
    way = find();
  }
  return {buffer.poseAt(from, to, instant.stamp), way.oldest};
}

}  // namespace collision_pairs
