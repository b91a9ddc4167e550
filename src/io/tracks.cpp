#include "tracks.h"

#include <algorithm>
#include <cmath>

#include "frame_names.h"

namespace collision_pairs {
namespace {

using Eigen::Isometry3d;
using Eigen::Quaterniond;
using Eigen::Vector3d;

constexpr int DEEPEST_TREE = 1000;  // steps; tf2's limit, for cycles of frames

Isometry3d toPose(const Vector3d& p, const Quaterniond& R) {
  Isometry3d X = Isometry3d::Identity();
  X.linear() = R.toRotationMatrix();
  X.translation() = p;
  return X;
}

/// Sorts by stamp; of equal stamps the first one added is kept.
template <class Sample>
void sortByStamp(std::vector<Sample>& samples) {
  std::stable_sort(samples.begin(), samples.end(),
                   [](const Sample& a, const Sample& b) { return a.stamp < b.stamp; });
  const auto same = [](const Sample& a, const Sample& b) { return a.stamp == b.stamp; };
  samples.erase(std::unique(samples.begin(), samples.end(), same), samples.end());
}

/// The samples on either side of an instant, or the one at this instant twice.
template <class Sample>
struct Neighbours {
  const Sample* before = nullptr;
  const Sample* after = nullptr;
  double passed = 0.0, between = 1.0;  // nanoseconds since `before`, and from it to `after`
};

/// False outside the recording, and between two samples further apart than max_gap.
template <class Sample>
bool findNeighbours(const std::vector<Sample>& samples, StampNs stamp, StampNs max_gap,
                    Neighbours<Sample>& found) {
  const auto after = std::lower_bound(samples.begin(), samples.end(), stamp,
                                      [](const Sample& s, StampNs t) { return s.stamp < t; });
  if (after == samples.end()) return false;
  found.before = found.after = &*after;
  if (after->stamp == stamp) return true;
  if (after == samples.begin()) return false;
  found.before = &*std::prev(after);
  found.passed = static_cast<double>(stamp - found.before->stamp);
  found.between = static_cast<double>(after->stamp - found.before->stamp);
  return after->stamp - found.before->stamp <= max_gap;
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
    track.samples.clear();  // the latest one applies, as on a latched topic
  } else if (track.is_static) {
    return true;
  }
  track.samples.push_back({stamp, parent_frame, p_PC, R_PC.normalized()});
  return true;
}

void TransformTracks::finish() {
  for (Track& track : tracks_) sortByStamp(track.samples);
}

bool TransformTracks::lookUp(int frame, StampNs stamp, StampNs max_gap, int& parent,
                             Isometry3d& X_PC) const {
  const Track& track = tracks_[frame];
  if (track.is_static) {
    const Sample& always = track.samples.front();
    parent = always.parent;
    X_PC = toPose(always.p_PC, always.R_PC);
    return true;
  }
  Neighbours<Sample> found;
  if (!findNeighbours(track.samples, stamp, max_gap, found)) return false;
  const Sample &before = *found.before, &after = *found.after;
  parent = before.parent;
  // If its parent changed in between, the first one is kept.
  const double share = before.parent == after.parent ? found.passed / found.between : 0.0;
  X_PC = toPose(before.p_PC + share * (after.p_PC - before.p_PC),
                before.R_PC.slerp(share, after.R_PC));
  return true;
}

void FramePoses::climbFrom(int frame) {
  Isometry3d X_RF = known_.at(frame), X_PF;
  for (int parent; tracks_.lookUp(frame, stamp_, max_gap_, parent, X_PF); frame = parent) {
    X_RF = X_RF * X_PF.inverse();
    if (!known_.emplace(parent, X_RF).second) return;  // known, or a cycle of frames
  }
}

bool FramePoses::find(int frame, Isometry3d& X_RF) {
  std::vector<std::pair<int, Isometry3d>> way;  // from the frame up to the first known ancestor
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

bool JointTracks::add(const std::string& joint, StampNs stamp, double position) {
  if (!std::isfinite(position)) return false;
  tracks_[joint].push_back({stamp, position});
  return true;
}

void JointTracks::finish() {
  for (auto& [joint, samples] : tracks_) sortByStamp(samples);
}

bool JointTracks::lookUp(const std::vector<Sample>& samples, StampNs stamp, StampNs max_gap,
                         bool continuous, double& position) {
  Neighbours<Sample> found;
  if (!findNeighbours(samples, stamp, max_gap, found)) return false;
  double way = found.after->position - found.before->position;
  if (continuous) way = std::remainder(way, 2.0 * M_PI);
  position = found.before->position + way * found.passed / found.between;
  return true;
}

}  // namespace collision_pairs
