#include "joint_query.h"

#include "collision_pairs/input_error.h"
#include "tf_poses.h"

namespace collision_pairs {
namespace {

using Eigen::Isometry3d;

/// By body of the robot: true if the scene checks it, or a body that it carries.
std::vector<char> bodiesNeeded(const CollisionScene& scene) {
  const auto& bodies = scene.robot().bodies();
  std::vector<char> is_needed(bodies.size(), 0);
  for (const SceneBody& checked : scene.bodies()) {
    for (int body = checked.body; body >= 0 && !is_needed[body]; body = bodies[body].parent) {
      is_needed[body] = 1;
    }
  }
  return is_needed;
}

/// Pose of the child in the parent from TF; as it was last, if TF does not have it (`doubt`); false
/// if it was never known.
bool askTf(const JointQueryTf& tf, const std::string& parent, const std::string& child,
           Isometry3d& X_PC, std::string& doubt) {
  try {
    X_PC = tf.transforms.lookUp(parent, child, tf.stamp).X_TS;
    return true;
  } catch (const InputError& error) {
    doubt = "link '" + child + "': " + error.what();
  }
  try {
    X_PC = tf.transforms.with([&](const TransformBuffer& buffer) {
      const int frame = buffer.findFrame(child);
      const StampNs last = frame < 0 ? EVER_SINCE : buffer.newestStamp(frame);
      return poseBetween(buffer, parent, child, {Instant::AT, last}).X_RF;
    });
    return true;
  } catch (const InputError&) {
    return false;
  }
}

}  // namespace

JointQuery::JointQuery(const std::vector<std::string>& names, const CollisionScene& scene,
                       const JointQueryTf& tf)
    : scene_(scene), columns_(names, scene.robot()) {
  const std::vector<char> is_needed = bodiesNeeded(scene);
  for (const Body& body : scene.robot().bodies()) {
    std::string doubt;
    sources_.push_back(sourceOf(body, tf, doubt));
    if (!doubt.empty() && is_needed[sources_.size() - 1]) doubts_.push_back(std::move(doubt));
  }
  const std::string clock = tf.transforms.clockDoubt();
  if (!joints_from_tf_.empty() && !clock.empty()) doubts_.push_back(clock);
}

JointQuery::Source JointQuery::sourceOf(const Body& body, const JointQueryTf& tf,
                                        std::string& doubt) {
  const RobotModel& robot = scene_.robot();
  const std::string& link = robot.links()[body.link].name;
  if (body.joint < 0) {
    Source root;
    root.X_PB = Isometry3d::Identity();
    if (tf.frame == link || askTf(tf, tf.frame, link, root.X_PB, doubt)) return root;
    throw InputError("TF does not know root link '" + link + "' in frame '" + tf.frame +
                     "' at stamp " + std::to_string(tf.stamp.toSec()) +
                     (tf.now.isZero() ? std::string(": ") + NO_CLOCK : ""));
  }
  Source source;
  source.joint = columns_.sourceOf(body.joint);
  if (source.joint.column >= 0) return source;
  const Joint& joint = robot.joints()[body.joint];
  const std::string& parent = robot.links()[robot.bodies()[body.parent].link].name;
  if (askTf(tf, parent, link, source.X_PB, doubt)) {
    joints_from_tf_.push_back(joint.name);
    if (!tf.held.empty() && tf.held[sources_.size()]) {
      doubt = "joint '" + joint.name + "' is not named, and only /tf_static places its link";
    }
    return source;
  }
  joints_at_zero_.push_back(joint.name);
  doubt = "joint '" + joint.name + "' is neither named nor known to TF: it was taken as zero; " +
          (tf.now.isZero() ? NO_CLOCK : doubt);
  source.X_PB = body.X_PJ * joint.motion(robot.zeroPositions()[body.joint]);
  return source;
}

void JointQuery::refuseOtherCount(const std::vector<double>& positions) const {
  if (positions.size() == columns_.size()) return;
  throw InputError(std::to_string(columns_.size()) + " joints are named, but there are " +
                   std::to_string(positions.size()) + " positions");
}

void JointQuery::bodyPosesAt(const std::vector<double>& positions,
                             std::vector<Isometry3d>& X_WB) const {
  refuseOtherCount(positions);
  columns_.check(positions.data());
  const RobotModel& robot = scene_.robot();
  X_WB.resize(robot.bodies().size());
  for (std::size_t i = 0; i < robot.bodies().size(); ++i) {
    const Body& body = robot.bodies()[i];
    const auto& [joint, X_PB] = sources_[i];
    if (body.joint < 0) {
      X_WB[i] = X_PB;
    } else if (joint.column < 0) {
      X_WB[i] = X_WB[body.parent] * X_PB;
    } else {
      const double position = joint.multiplier * positions[joint.column] + joint.offset;
      X_WB[i] = X_WB[body.parent] * body.X_PJ * robot.joints()[body.joint].motion(position);
    }
  }
}

void JointQuery::posesAt(const std::vector<double>& positions, BodyPoses& poses) const {
  thread_local std::vector<Isometry3d> X_WB;
  bodyPosesAt(positions, X_WB);
  scene_.gatherPoses(X_WB, poses);
}

std::vector<double> JointQuery::jointPositionsAt(const std::vector<double>& positions) const {
  refuseOtherCount(positions);
  std::vector<double> all = scene_.robot().zeroPositions();
  columns_.apply(positions.data(), all);
  return all;
}

std::vector<std::optional<Isometry3d>> JointQuery::placedBodies() const {
  std::vector<std::optional<Isometry3d>> placed;
  for (const Source& source : sources_) {
    placed.emplace_back();
    if (source.joint.column < 0) placed.back() = source.X_PB;
  }
  return placed;
}

}  // namespace collision_pairs
