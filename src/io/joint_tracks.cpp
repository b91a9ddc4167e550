#include "joint_tracks.h"

#include <algorithm>
#include <cmath>

namespace collision_pairs {

bool JointTracks::add(const std::string& joint, StampNs stamp, double position) {
  if (!std::isfinite(position)) return false;
  tracks_[joint].push_back({stamp, position});
  return true;
}

void JointTracks::finish() {
  for (auto& [joint, samples] : tracks_) {
    std::stable_sort(samples.begin(), samples.end(),
                     [](const Sample& a, const Sample& b) { return a.stamp < b.stamp; });
    const auto same = [](const Sample& a, const Sample& b) { return a.stamp == b.stamp; };
    samples.erase(std::unique(samples.begin(), samples.end(), same), samples.end());
  }
}

bool JointTracks::lookUp(const std::vector<Sample>& samples, StampNs stamp, StampNs max_gap,
                         bool continuous, double& position) {
  const auto after = std::lower_bound(samples.begin(), samples.end(), stamp,
                                      [](const Sample& s, StampNs t) { return s.stamp < t; });
  if (after == samples.end()) return false;
  position = after->position;
  if (after->stamp == stamp) return true;
  if (after == samples.begin()) return false;
  const Sample& before = *std::prev(after);
  if (after->stamp - before.stamp > max_gap) return false;
  double way = after->position - before.position;
  if (continuous) way = std::remainder(way, 2.0 * M_PI);
  position = before.position + way * static_cast<double>(stamp - before.stamp) /
                                   static_cast<double>(after->stamp - before.stamp);
  return true;
}

}  // namespace collision_pairs
