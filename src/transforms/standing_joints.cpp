// Joints that are not fixed, but that static transforms hold.
#include "robot_poses.h"

namespace collision_pairs {
namespace {

/// The last frame that static transforms lead up to. `tops`: those found so far, by frame; or -1.
int topOf(const TransformBuffer& buffer, int frame, std::vector<int>& tops) {
  int top = frame;
  for (std::size_t i = 0; i < buffer.frames().size() && tops[top] < 0; ++i) {  // a cycle ends, too
    if (!buffer.gate().isStatic(top)) break;
    top = buffer.parentAt(top, NEVER);
  }
  if (tops[top] >= 0) top = tops[top];
  return tops[frame] = top;
}

}  // namespace

int RobotPoses::bodyUnder(int frame, StampNs stamp) const {
  for (std::size_t i = 0; i < links_.nbFrames() && frame >= 0; ++i) {  // a cycle ends, too
    const int body = links_.bodyOf(frame);
    if (body >= 0) return body;
    frame = buffer_.gate().isKnown(frame, stamp) ? buffer_.parentAt(frame, stamp) : -1;
  }
  return -1;
}

/// They lie between links of one robot that static transforms place relative to each other.
const RobotPoses::Standing& RobotPoses::standing() const {
  const std::pair<std::size_t, std::size_t> version{buffer_.nbStaticChanges(), links().nbFrames()};
  if (standing_.version == version) return standing_;
  standing_ = {
      version, std::vector<char>(joints_.size(), 0), std::vector<int>(version.second, -1), {}};
  for (int root = 0; root < static_cast<int>(joints_.size()); ++root) {
    if (roots_[root] != root) continue;
    std::vector<int>& first_below = standing_.first_below[root];
    first_below.assign(links_.nbFrames(), -1);
    for (int b = root; b < static_cast<int>(joints_.size()); ++b) {
      if (roots_[b] != root) continue;
      for (const int link : links_.ofBody(b)) {
        int& first = first_below[topOf(buffer_, link, standing_.tops)];
        if (first < 0) first = b;
        noteStanding(first, b, standing_.joints);
      }
    }
  }
  return standing_;
}

void RobotPoses::noteStanding(int body, int other, std::vector<char>& stands) const {
  robot_->visitBetween(body, other,
                       [&](int below, bool) { stands[below] |= !joints_[below].may_be_static; });
}

std::vector<char> RobotPoses::standingJoints(int frame, int under) const {
  standing();
  std::vector<char> stands = standing_.joints;
  if (frame < 0 || links_.bodyOf(frame) >= 0) return stands;
  const int top = topOf(buffer_, frame, standing_.tops);
  for (const auto& [root, first_below] : standing_.first_below) {
    const bool is_on_it = under >= 0 && roots_[under] == root;
    if (first_below[top] >= 0) noteStanding(is_on_it ? under : root, first_below[top], stands);
  }
  return stands;
}

int RobotPoses::firstStanding(const std::vector<char>& stands, int body, int other) const {
  int first = -1;
  robot_->visitBetween(body, other, [&](int below, bool) {
    if (stands[below] && first < 0) first = below;
  });
  return first;
}

std::string RobotPoses::whyHeld(int below) const {
  return "only /tf_static places it, but joint '" + joints_[below].name +
         "' is not fixed: publish it on /tf, or list the joint in static_joints";
}

}  // namespace collision_pairs
