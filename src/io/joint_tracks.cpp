#include "joint_tracks.h"

#include <cmath>

#include "user_text.h"

namespace collision_pairs {
namespace {

constexpr double SAME_PLACE = 1e-4;  // rad or m

double distance(const JointPosition& a, const JointPosition& b) {
  const double way = b.position - a.position;
  return std::min(std::abs(way), std::abs(std::remainder(way, 2.0 * M_PI)));
}

}  // namespace

bool contradicts(const JointPosition& sample, const JointPosition& earlier,
                 const JointPosition& before, const JointPosition& after, std::string& how) {
  const double step = std::max(distance(before, after), distance(earlier, before));
  const double off = std::min(distance(sample, before), distance(sample, after));
  if (off <= step + SAME_PLACE) return false;
  how = "by " + std::to_string(off);
  return true;
}

std::string JointTracks::take(const std::string& joint, double position, StampNs stamp,
                              const std::string& publisher, StampNs now,
                              const TrackLimits& limits) {
  OfJoint& found = joints_[joint];
  found.stamps.push_back(stamp);
  const std::string why = whyRefused(stamp, now, limits);
  if (!why.empty()) return why;
  auto by = std::find(publishers_.begin(), publishers_.end(), publisher);
  if (by == publishers_.end()) by = publishers_.insert(by, publisher);
  const int number = static_cast<int>(by - publishers_.begin());
  return found.track.add({number, stamp, now, now}, {position}, limits, publishers_);
}

bool JointTracks::lookUp(const OfJoint& joint, StampNs stamp, const TrackLimits& limits,
                         bool continuous, double& position, std::string& why) {
  if (const Doubt* doubt = joint.track.doubtAt(stamp)) {
    why = doubt->why;
    return false;
  }
  Track<JointPosition>::Neighbours found;
  if (!joint.track.find(stamp, limits.max_gap, found)) {
    why = "no two of its positions around that stamp are within " +
          inWords(inSeconds(limits.max_gap)) + " of each other";
    return false;
  }
  if (joint.track.wasSilentAt(stamp)) {
    why = "at that stamp, its newest position that had arrived was too old";
    return false;
  }
  double way = found.after->position - found.before->position;
  if (continuous) way = std::remainder(way, 2.0 * M_PI);
  position = found.before->position + way * found.share;
  return true;
}

}  // namespace collision_pairs
