#include "transform_buffer.h"

#include <cmath>

#include "frame_names.h"
#include "user_text.h"

namespace collision_pairs {
namespace {

using Eigen::Isometry3d;

constexpr std::size_t MOST_NAMES = 10000;  // frames or publishers: names are external input
constexpr std::size_t MOST_STATICS = 100;  // of one frame that are kept
constexpr double SAME_PLACE = 1e-4;        // m and rad; two that agree may round differently
const std::string BOTH_KINDS =
    "it is published both on /tf and on /tf_static, so its pose is ambiguous; stop one of the two "
    "publishers";

double distance(const FramePose& a, const FramePose& b) { return (a.p_PC - b.p_PC).norm(); }
double angle(const FramePose& a, const FramePose& b) { return a.R_PC.angularDistance(b.R_PC); }

bool differ(const FramePose& a, const FramePose& b) {
  return a.parent != b.parent || distance(a, b) > SAME_PLACE || angle(a, b) > SAME_PLACE;
}

Isometry3d toPose(const Eigen::Vector3d& p, const Eigen::Quaterniond& R) {
  Isometry3d X = Isometry3d::Identity();
  X.linear() = R.toRotationMatrix();
  X.translation() = p;
  return X;
}

}  // namespace

bool isPose(const Eigen::Vector3d& p, const Eigen::Quaterniond& R) {
  return p.allFinite() && std::abs(R.norm() - 1.0) < 1e-3;
}

bool contradicts(const FramePose& sample, const FramePose& earlier, const FramePose& before,
                 const FramePose& after, std::string& how) {
  if (sample.parent != before.parent && sample.parent != after.parent) {
    how = "they name different parents";
    return true;
  }
  if (before.parent != after.parent) return false;
  const bool has_earlier = earlier.parent == before.parent;
  const auto far = [&](double (*measure)(const FramePose&, const FramePose&), double& off) {
    const double step =
        std::max(measure(before, after), has_earlier ? measure(earlier, before) : 0.0);
    off = std::min(measure(sample, before), measure(sample, after));
    return off > step + SAME_PLACE;
  };
  double metres = 0.0, radians = 0.0;
  const bool is_far = far(distance, metres), is_turned = far(angle, radians);
  if (!is_far && !is_turned) return false;
  how = formatted("by %.4g m and %.4g rad", metres, radians);
  return true;
}

/// -1 if there are too many.
int TransformBuffer::numberOf(const std::string& name, std::vector<std::string>& names,
                              std::unordered_map<std::string, int>& ids) {
  const auto known = ids.find(name);
  if (known != ids.end()) return known->second;
  if (names.size() == MOST_NAMES) return -1;
  ids.emplace(name, static_cast<int>(names.size()));
  names.push_back(name);
  return static_cast<int>(names.size()) - 1;
}

int TransformBuffer::findFrame(const std::string& name) const {
  const auto found = ids_.find(name);
  return found == ids_.end() ? -1 : found->second;
}

std::string TransformBuffer::take(const ReceivedTransform& transform, bool is_static,
                                  const std::string& publisher, StampNs now) {
  if (!isPose(transform.p_PC, transform.R_PC)) return "it is not finite, or not a rotation";
  const std::string why = is_static ? "" : whyRefused(transform.stamp, now, limits_);
  if (!why.empty()) return why;
  const std::string child = withoutLeadingSlash(transform.child);
  const std::string parent = withoutLeadingSlash(transform.parent);
  if (child.empty() || parent.empty()) return "a frame has no name";
  if (child == parent) return "it is its own parent";
  const int frame = numberOf(child, names_, ids_);
  const int parent_frame = frame < 0 ? -1 : numberOf(parent, names_, ids_);
  frames_.resize(names_.size());
  int by = numberOf(publisher, publishers_, publisher_ids_);
  if (parent_frame < 0 || by < 0) {
    return "more than " + std::to_string(MOST_NAMES) + " frames or publishers are named on TF";
  }
  Frame& state = frames_[frame];
  const FramePose pose{parent_frame, transform.p_PC, transform.R_PC.normalized()};
  std::string doubt;
  if (is_static) {
    doubt = takeStatic(state, pose, by, now);
  } else {
    state.kind.noteMoving(now, limits_.max_age);
    doubt =
        state.moving.add({by, transform.stamp, now, reached(now)}, pose, limits_, publishers_,
                         [&](StampNs t) { return state.kind.at(t) == TransformKind::AMBIGUOUS; });
    newest_ = std::max(newest_, transform.stamp);
  }
  return state.kind.at(now) == TransformKind::AMBIGUOUS ? BOTH_KINDS : doubt;
}

/// Around a change of its pose it is in doubt. Two publishers that contradict each other are both
/// silent from then on: it is settled when one of them sends its transform again, or a third the
/// last one.
std::string TransformBuffer::takeStatic(Frame& frame, const FramePose& pose, int publisher,
                                        StampNs now) {
  const bool changes = !frame.statics.empty() && differ(frame.statics.back().pose, pose);
  const bool again = (!frame.statics.empty() && !changes) ||
                     std::any_of(frame.statics.begin(), frame.statics.end(),
                                 [&](const Static& sent) { return sent.publisher == publisher; });
  frame.kind.noteStatic(now, limits_.max_age, again);
  if (frame.statics.empty()) frame.static_since = reached(now);
  const StampNs lasting = limits_.max_age == NEVER ? limits_.max_gap : limits_.max_age;
  if (again && !frame.doubts.empty() && frame.doubts.back().span.end == NEVER) {
    frame.doubts.back().span.end = now + lasting;
  }
  std::string why;
  if (changes) {
    const int other = frame.statics.back().publisher;
    if (!again) {
      why = "'" + publishers_[other] + "' and '" + publishers_[publisher] +
            "' contradict each other on /tf_static; stop one of them, and start the other again";
    }
    frame.doubts.push_back({{now - lasting, again ? reached(now) : NEVER},
                            other,
                            publisher,
                            again ? "its static transform changed" : why});
  }
  if (frame.statics.size() == MOST_STATICS) frame.statics.erase(frame.statics.begin() + 1);
  frame.statics.push_back({now, publisher, pose});
  return why;
}

void TransformBuffer::restart(StampNs now) {
  newest_ = EVER_SINCE;
  for (Frame& frame : frames_) {
    frame.moving.clear();
    frame.kind.restart(now, limits_.max_age);
    if (frame.statics.size() > 1)
      frame.statics.erase(frame.statics.begin(), frame.statics.end() - 1);
    for (Static& only : frame.statics) only.received = EVER_SINCE;
    frame.static_since = EVER_SINCE;
    for (Doubt& doubt : frame.doubts) doubt.span.begin = EVER_SINCE;
    if (!frame.doubts.empty() && frame.doubts.back().span.end != NEVER) frame.doubts.clear();
  }
}

const FramePose& TransformBuffer::staticAt(const Frame& frame, StampNs stamp) const {
  auto newest = frame.statics.rbegin();
  while (newest->received > stamp && std::next(newest) != frame.statics.rend()) ++newest;
  return newest->pose;
}

const std::string* TransformBuffer::doubtAt(const Frame& frame, TransformKind::Kind kind,
                                            StampNs stamp) const {
  if (kind == TransformKind::AMBIGUOUS) return &BOTH_KINDS;
  if (kind == TransformKind::MOVES) {
    const Doubt* doubt = frame.moving.doubtAt(stamp);
    return doubt ? &doubt->why : nullptr;
  }
  for (const Doubt& doubt : frame.doubts) {
    if (doubt.span.contains(stamp)) return &doubt.why;
  }
  return nullptr;
}

bool TransformBuffer::poseAt(int number, StampNs stamp, bool as_it_arrived, int& parent,
                             Isometry3d& X_PC) const {
  const Frame& frame = frames_[number];
  const TransformKind::Kind kind = frame.kind.at(stamp);
  if (kind == TransformKind::UNHEARD || doubtAt(frame, kind, stamp)) return false;
  if (kind == TransformKind::STATIC) {
    if (as_it_arrived && frame.static_since > stamp && limits_.max_age != NEVER) return false;
    const FramePose& pose = staticAt(frame, stamp);
    parent = pose.parent;
    X_PC = toPose(pose.p_PC, pose.R_PC);
    return true;
  }
  Track<FramePose>::Neighbours found;
  if (!frame.moving.find(stamp, limits_.max_gap, found)) return false;
  if (doubtAt(frame, frame.kind.at(found.since), found.since)) return false;
  if (as_it_arrived && frame.moving.wasSilentAt(stamp)) return false;
  const FramePose &before = *found.before, &after = *found.after;
  parent = before.parent;
  // If its parent changed in between, the first one is kept.
  const double share = before.parent == after.parent ? found.share : 0.0;
  X_PC = share == 0.0 ? toPose(before.p_PC, before.R_PC)
                      : toPose(before.p_PC + share * (after.p_PC - before.p_PC),
                               before.R_PC.slerp(share, after.R_PC));
  return true;
}

bool TransformBuffer::newestPose(int number, StampNs now, StampNs& stamp, int& parent,
                                 Isometry3d& X_PC) const {
  const Frame& frame = frames_[number];
  if (frame.kind.at(now) == TransformKind::STATIC) {
    stamp = NEVER;
    return poseAt(number, now, false, parent, X_PC);
  }
  if (frame.moving.empty()) return false;
  stamp = frame.moving.newestAt(now, limits_.max_age);
  return now - stamp <= limits_.max_age && poseAt(number, stamp, false, parent, X_PC);
}

bool TransformBuffer::isStaticAt(int number, StampNs stamp, int& parent) const {
  const Frame& frame = frames_[number];
  if (frame.kind.at(stamp) != TransformKind::STATIC) return false;
  parent = staticAt(frame, stamp).parent;
  return true;
}

std::string TransformBuffer::whyUnknown(int number, StampNs stamp, bool as_it_arrived) const {
  const Frame& frame = frames_[number];
  const TransformKind::Kind kind = frame.kind.at(stamp);
  if (kind == TransformKind::UNHEARD) return "TF does not say where it is";
  if (const std::string* doubt = doubtAt(frame, kind, stamp)) return *doubt;
  if (kind == TransformKind::STATIC || frame.moving.empty()) return "it had not arrived yet";
  if (stamp > frame.moving.newest()) {
    return "its newest transform is " + inWords(inSeconds(stamp - frame.moving.newest())) +
           " older than that stamp (no extrapolation)";
  }
  Track<FramePose>::Neighbours found;
  if (as_it_arrived && frame.moving.find(stamp, limits_.max_gap, found)) {
    return "at that stamp, its newest transform that had arrived was too old or in doubt";
  }
  return "no two of its transforms around that stamp are within " +
         inWords(inSeconds(limits_.max_gap)) + " of each other";
}

std::string TransformBuffer::whyNoNewest(int number, StampNs now) const {
  const Frame& frame = frames_[number];
  const TransformKind::Kind kind = frame.kind.at(now);
  if (kind == TransformKind::UNHEARD) return "TF does not say where it is";
  if (kind == TransformKind::STATIC) return whyUnknown(number, now, false);
  if (frame.moving.empty()) return "no transform of it was received since the clock went back";
  const StampNs stamp = frame.moving.newestAt(now, limits_.max_age);
  if (now - stamp <= limits_.max_age) return whyUnknown(number, stamp, false);
  return "its newest transform is " + inWords(inSeconds(now - stamp)) +
         " old, and max_pose_age is " + inWords(inSeconds(limits_.max_age));
}

}  // namespace collision_pairs
