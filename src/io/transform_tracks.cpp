#include "transform_tracks.h"

#include <algorithm>
#include <cmath>

#include "frame_names.h"

namespace collision_pairs {
namespace {

using Eigen::Isometry3d;
using Eigen::Quaterniond;
using Eigen::Vector3d;

constexpr int DEEPEST_TREE = 1000;  // steps; tf2's limit, for frames in a ring

Isometry3d toPose(const Vector3d& p, const Quaterniond& R) {
  Isometry3d X = Isometry3d::Identity();
  X.linear() = R.toRotationMatrix();
  X.translation() = p;
  return X;
}

}  // namespace

int TransformTracks::frameNumbered(std::string name) {
  const auto [entry, is_new] = ids_.try_emplace(name, static_cast<int>(names_.size()));
  if (is_new) {
    names_.push_back(std::move(name));
    tracks_.emplace_back();
  }
  return entry->second;
}

int TransformTracks::findFrame(const std::string& name) const {
  const auto found = ids_.find(name);
  return found == ids_.end() ? -1 : found->second;
}

bool TransformTracks::add(const std::string& parent, const std::string& child, StampNs stamp,
                          const Vector3d& p_PC, const Quaterniond& R_PC, bool is_static) {
  if (!p_PC.allFinite() || !(std::abs(R_PC.norm() - 1.0) < 1e-3)) return false;
  const int parent_frame = frameNumbered(withoutLeadingSlash(parent));
  const int frame = frameNumbered(withoutLeadingSlash(child));
  if (frame == parent_frame) return false;
  Track& track = tracks_[frame];
  if (is_static) {
    track.is_static = true;
    track.samples.clear();  // the last word counts, as in a latched topic
  } else if (track.is_static) {
    return true;
  }
  track.samples.push_back({stamp, parent_frame, p_PC, R_PC.normalized()});
  return true;
}

void TransformTracks::finish() {
  for (Track& track : tracks_) {
    auto& samples = track.samples;
    std::stable_sort(samples.begin(), samples.end(),
                     [](const Sample& a, const Sample& b) { return a.stamp < b.stamp; });
    const auto same = [](const Sample& a, const Sample& b) { return a.stamp == b.stamp; };
    samples.erase(std::unique(samples.begin(), samples.end(), same), samples.end());
  }
}

bool TransformTracks::lookUp(int frame, StampNs stamp, StampNs max_gap, int& parent,
                             Isometry3d& X_PC) const {
  const auto& samples = tracks_[frame].samples;
  auto after = std::lower_bound(samples.begin(), samples.end(), stamp,
                                [](const Sample& s, StampNs t) { return s.stamp < t; });
  if (tracks_[frame].is_static) after = samples.begin();
  if (after == samples.end()) return false;
  parent = after->parent;
  if (tracks_[frame].is_static || after->stamp == stamp) {
    X_PC = toPose(after->p_PC, after->R_PC);
    return true;
  }
  if (after == samples.begin()) return false;
  const Sample& before = *std::prev(after);
  if (after->stamp - before.stamp > max_gap) return false;
  parent = before.parent;
  const double share = before.parent != after->parent
                           ? 0.0  // it was hung elsewhere in between
                           : static_cast<double>(stamp - before.stamp) /
                                 static_cast<double>(after->stamp - before.stamp);
  X_PC = toPose(before.p_PC + share * (after->p_PC - before.p_PC),
                before.R_PC.slerp(share, after->R_PC));
  return true;
}

void FramePoses::climbFrom(int frame) {
  Isometry3d X_RF = known_.at(frame), X_PF;
  for (int parent; tracks_.lookUp(frame, stamp_, max_gap_, parent, X_PF); frame = parent) {
    X_RF = X_RF * X_PF.inverse();
    if (!known_.emplace(parent, X_RF).second) return;  // known, or frames in a ring
  }
}

bool FramePoses::find(int frame, Isometry3d& X_RF) {
  std::vector<std::pair<int, Isometry3d>> way;  // from the frame up to the first that is known
  auto known = known_.find(frame);
  while (known == known_.end()) {
    int parent;
    Isometry3d X_PF;
    if (way.size() > DEEPEST_TREE || !tracks_.lookUp(frame, stamp_, max_gap_, parent, X_PF)) {
      return false;
    }
    way.emplace_back(frame, X_PF);
    frame = parent;
    known = known_.find(frame);
  }
  X_RF = known->second;
  for (auto step = way.rbegin(); step != way.rend(); ++step) {
    X_RF = X_RF * step->second;
    known_.emplace(step->first, X_RF);
  }
  return true;
}

}  // namespace collision_pairs
