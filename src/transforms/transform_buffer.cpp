#include "transform_buffer.h"

#include <algorithm>
#include <cmath>

#include <geometry_msgs/TransformStamped.h>
#include <tf2/buffer_core.h>
#include <tf2/exceptions.h>

#include "collision_pairs/input_error.h"
#include "user_text.h"

namespace collision_pairs {
namespace {

using Eigen::Isometry3d;

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

const std::size_t TransformBuffer::DEEPEST_TREE = tf2::BufferCore::MAX_GRAPH_DEPTH;

TransformBuffer::TransformBuffer(const PoseLimits& limits) : gate_(limits) { begin(); }

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
  if (what == Store::KIND || (what == Store::IT && is_static)) ++nb_static_changes_;
  if (what == Store::KIND) {
    begin();
  } else if (what == Store::IT) {
    store(frame, pose, transform.stamp, is_static);
  }
  return why;
}

void TransformBuffer::store(int frame, const FramePose& pose, StampNs stamp, bool is_static) const {
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
  tf_->setTransform(message, "", is_static);
}

/// With the static poses that count now, and the samples that are kept.
void TransformBuffer::begin() {
  tf_ = std::make_unique<tf2::BufferCore>(ros::Duration().fromNSec(limits().kept));
  for (std::size_t i = 0; i < frames().size(); ++i) {
    const int frame = static_cast<int>(i);
    gate_.forEach(frame, [&](const FramePose& pose, StampNs stamp) {
      store(frame, pose, stamp, stamp == NEVER);
    });
  }
}

void TransformBuffer::restart(StampNs now) {
  gate_.restart(now);
  begin();
}

int TransformBuffer::parentAt(int frame, StampNs stamp) const {
  const int parent = gate_.parentAt(frame, stamp);
  if (parent >= 0) return parent;
  std::string name;
  const bool has = tf_->_getParent(frames()[frame], toTime(stamp), name);
  return has ? findFrame(name) : -1;
}

Isometry3d TransformBuffer::poseBelow(int top, int frame, StampNs stamp) const {
  if (top == frame) return Isometry3d::Identity();
  try {
    const auto X = tf_->lookupTransform(frames()[top], frames()[frame], toTime(stamp)).transform;
    Isometry3d X_TF = Isometry3d::Identity();
    X_TF.linear() = Eigen::Quaterniond(X.rotation.w, X.rotation.x, X.rotation.y, X.rotation.z)
                        .normalized()
                        .toRotationMatrix();
    X_TF.translation() = Eigen::Vector3d(X.translation.x, X.translation.y, X.translation.z);
    return X_TF;
  } catch (const tf2::TransformException& error) {
    throw InputError(error.what());
  }
}

}  // namespace collision_pairs
