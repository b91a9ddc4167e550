#include "frame_poses.h"

#include "frame_names.h"

namespace collision_pairs {

using Eigen::Isometry3d;

FramePoses::FramePoses(const TransformBuffer& buffer, const Instant& instant)
    : buffer_(buffer), instant_(instant), index_(buffer.frames().size(), -1) {
  known_.reserve(index_.size());
}

bool FramePoses::step(int frame, StampNs& stamp, int& parent, Isometry3d& X_PF) const {
  if (instant_.kind == Instant::NEWEST) {
    return buffer_.newestPose(frame, instant_.stamp, stamp, parent, X_PF);
  }
  stamp = instant_.stamp;
  return buffer_.poseAt(frame, stamp, instant_.kind == Instant::AS_IT_ARRIVED, parent, X_PF);
}

void FramePoses::learn(int frame, const Known& known) {
  index_[frame] = static_cast<int>(known_.size());
  known_.push_back(known);
}

void FramePoses::forgetFrom(int first) {
  for (int& index : index_) {
    if (index >= first) index = -1;
  }
  known_.resize(static_cast<std::size_t>(first));
}

void FramePoses::anchor(int frame, const Known& known) {
  if (index_[frame] >= 0) return;
  const int first = static_cast<int>(known_.size());
  learn(frame, known);
  Known next = known;
  Isometry3d X_PF;
  StampNs stamp;
  for (int parent; step(frame, stamp, parent, X_PF); frame = parent) {
    // Round a cycle, what hangs on the frame was learned as what the frame hangs on.
    if (index_[parent] >= first) return forgetFrom(first);
    if (index_[parent] >= 0) return;
    next.X_RF = next.X_RF * X_PF.inverse();
    next.pass(stamp);
    learn(parent, next);
  }
}

bool FramePoses::find(int frame, Known& found) {
  way_.clear();
  found.oldest = NEVER;
  while (index_[frame] < 0) {
    int parent;
    Step up;
    if (way_.size() > DEEPEST_TREE || !step(frame, up.stamp, parent, up.X_PF)) return false;
    up.frame = frame;
    way_.push_back(up);
    found.oldest = std::min(found.oldest, up.stamp);
    frame = parent;
  }
  found = known_[index_[frame]];
  for (auto down = way_.rbegin(); down != way_.rend(); ++down) {
    found.X_RF = found.X_RF * down->X_PF;
    found.pass(down->stamp);
    learn(down->frame, found);
  }
  return true;
}

int FramePoses::lastAncestor(int frame) const {
  StampNs stamp;
  Isometry3d X_PF;
  std::size_t nb_steps = 0;
  for (int parent; step(frame, stamp, parent, X_PF); frame = parent) {
    if (++nb_steps > DEEPEST_TREE) return -1;
  }
  return frame;
}

bool FramePoses::isPlaced(int frame) const {
  const int last = lastAncestor(frame);
  return last >= 0 && buffer_.isHeard(last);
}

std::string FramePoses::whyUnknown(int frame) const {
  const int last = lastAncestor(frame);
  if (last < 0) return "its ancestors form a cycle";
  const std::string why =
      instant_.kind == Instant::NEWEST
          ? buffer_.whyNoNewest(last, instant_.stamp)
          : buffer_.whyUnknown(last, instant_.stamp, instant_.kind == Instant::AS_IT_ARRIVED);
  return frame == last ? why : "transform of '" + buffer_.frames()[last] + "': " + why;
}

FramePoses::Known poseBetween(const TransformBuffer& buffer, const std::string& target,
                              const std::string& source, Instant instant) {
  const int from = buffer.findFrame(withoutLeadingSlash(target));
  const int to = buffer.findFrame(withoutLeadingSlash(source));
  if (from >= 0 && from == to) return {Isometry3d::Identity()};
  if (from < 0 || to < 0) {
    throw NotConnected("TF has no frame '" + (from < 0 ? target : source) + "'");
  }
  FramePoses::Known found;
  const auto look = [&] {
    FramePoses frames(buffer, instant);
    frames.anchor(from, {Isometry3d::Identity()});
    if (frames.find(to, found)) return;
    for (const int frame : {to, from}) {
      if (frames.isPlaced(frame)) throw InputError(frames.whyUnknown(frame));
    }
    for (const int frame : {to, from}) {
      if (!frames.isInCycle(frame)) continue;
      throw NotConnected("'" + buffer.frames()[frame] + "': " + frames.whyUnknown(frame));
    }
    throw NotConnected("TF does not connect '" + target + "' and '" + source + "'");
  };
  look();
  if (instant.kind == Instant::NEWEST && found.oldest < found.newest) {
    instant = {Instant::AT, found.oldest};
    look();
  }
  return found;
}

}  // namespace collision_pairs
