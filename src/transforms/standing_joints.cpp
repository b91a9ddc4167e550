// Joints that are not fixed, but that static transforms hold.
#include <algorithm>

#include "robot_poses.h"

namespace collision_pairs {
namespace {

/// The last frame that static transforms lead up to. `tops`: those found so far, by frame; or -1.
int topOf(const TransformBuffer& buffer, int frame, StampNs stamp, std::vector<int>& tops) {
  int top = frame;
  for (std::size_t i = 0; i < buffer.frames().size() && tops[top] < 0; ++i) {
    const int parent = buffer.gate().isStaticAt(top, stamp) ? buffer.parentAt(top, stamp) : -1;
    if (parent < 0) break;
    top = parent;
  }
  if (tops[top] >= 0) top = tops[top];
  return tops[frame] = top;
}

}  // namespace

/// visit(body) for the joint above each body on the way between two; -1: from or to beyond a root.
template <class Visit>
void RobotPoses::visitBetween(int a, int b, const Visit& visit) const {
  while (a != b) {
    int& lower = a > b ? a : b;  // a parent comes before its children
    visit(lower);
    lower = bodies_[lower].parent;
  }
}

int RobotPoses::bodyUnderFrame(StampNs stamp) const {
  if (body_of_frame_ >= 0) return body_of_frame_;
  int frame = frames().frame;
  for (std::size_t i = 0; i < buffer_.frames().size() && frame >= 0; ++i) {  // a cycle ends, too
    const int body = bodyOf(frame);
    if (body >= 0) return body;
    frame = buffer_.isKnown(frame, stamp) ? buffer_.parentAt(frame, stamp) : -1;
  }
  return -1;
}

/// Joints stand that lie between bodies of one robot which static transforms place relative to each
/// other. W counts as on the body that it hangs on, or else on the root.
std::vector<char> RobotPoses::standingJoints(int under_frame, StampNs stamp) const {
  const Frames& ids = frames();
  std::vector<char> stands(bodies_.size(), 0);
  std::vector<int> tops(ids.nb_known, -1);
  for (int root = 0; root < static_cast<int>(bodies_.size()); ++root) {
    if (bodies_[root].parent >= 0) continue;
    std::vector<int> first_below(ids.nb_known, -1);  // by top frame, the first body
    if (ids.frame >= 0) {
      const bool is_on_it = under_frame >= 0 && bodies_[under_frame].root == root;
      first_below[topOf(buffer_, ids.frame, stamp, tops)] = is_on_it ? under_frame : root;
    }
    for (int b = root; b < static_cast<int>(bodies_.size()); ++b) {
      if (bodies_[b].root != root) continue;
      for (const int id : ids.of_links[b]) {
        if (id < 0) continue;
        int& first = first_below[topOf(buffer_, id, stamp, tops)];
        if (first < 0) first = b;
        visitBetween(first, b, [&](int below) { stands[below] |= !bodies_[below].may_be_static; });
      }
    }
  }
  return stands;
}

/// What a joint that stands lies between it and W.
std::vector<int> RobotPoses::heldBy(StampNs stamp) const {
  const int under_frame = bodyUnderFrame(stamp);
  const std::vector<char> stands = standingJoints(under_frame, stamp);
  std::vector<int> held_by(bodies_.size(), -1);
  if (std::find(stands.begin(), stands.end(), 1) == stands.end()) return held_by;
  for (int b = 0; b < static_cast<int>(bodies_.size()); ++b) {
    visitBetween(b, under_frame, [&](int below) {
      if (stands[below] && held_by[b] < 0) held_by[b] = below;
    });
  }
  return held_by;
}

std::vector<char> RobotPoses::heldAt(StampNs stamp) const {
  std::vector<char> held;
  for (const int by : heldBy(stamp)) held.push_back(by >= 0);
  return held;
}

}  // namespace collision_pairs
