// Joints that are not fixed, but that static transforms hold.
#include "robot_poses.h"

namespace collision_pairs {
namespace {

/// The last frame that static transforms lead up to. `tops`: those found so far, by frame; or -1.
int topOf(const TransformBuffer& buffer, int frame, StampNs stamp, std::vector<int>& tops) {
  int top = frame;
  for (std::size_t i = 0; i < buffer.frames().size() && tops[top] < 0; ++i) {
    const int parent = buffer.gate().isStatic(top) ? buffer.parentAt(top, stamp) : -1;
    if (parent < 0) break;
    top = parent;
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

/// They lie between bodies of one robot that static transforms place relative to each other.
std::vector<char> RobotPoses::standingJoints(int frame, int under, StampNs stamp) const {
  std::vector<char> stands(joints_.size(), 0);
  std::vector<int> tops(links_.nbFrames(), -1);
  for (int root = 0; root < static_cast<int>(joints_.size()); ++root) {
    if (roots_[root] != root) continue;
    std::vector<int> first_below(links_.nbFrames(), -1);  // by top frame, the first body
    const bool is_on_it = under >= 0 && roots_[under] == root;
    if (frame >= 0) first_below[topOf(buffer_, frame, stamp, tops)] = is_on_it ? under : root;
    for (int b = root; b < static_cast<int>(joints_.size()); ++b) {
      if (roots_[b] != root) continue;
      for (const int link : links_.ofBody(b)) {
        int& first = first_below[topOf(buffer_, link, stamp, tops)];
        if (first < 0) first = b;
        robot_->visitBetween(
            first, b, [&](int below, bool) { stands[below] |= !joints_[below].may_be_static; });
      }
    }
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
