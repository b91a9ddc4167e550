#include "joint_query.h"

#include <algorithm>

#include "collision_pairs/input_error.h"
#include "user_text.h"

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

/// Pose of the child in the parent from TF; as it was last, if TF does not have it (`problem`);
/// false if it was never known. `stamp`: set if it is not static.
bool askTf(const JointQueryTf& tf, const std::string& parent, const std::string& child,
           Isometry3d& X_PC, std::string& problem, ros::Time& stamp) {
  try {
    const auto found = tf.poses != nullptr ? tf.poses->lookUp(parent, child, tf.stamp)
                                           : tf.transforms.lookUp(parent, child, tf.stamp);
    X_PC = found.X_TS;
    stamp = found.stamp;
    return true;
  } catch (const InputError& error) {
    problem = "link '" + child + "': " + error.what();
  }
  try {
    const TransformBuffer& buffer = tf.transforms.buffer();
    const int frame = buffer.findFrame(child);
    const StampNs last = frame < 0 ? EVER_SINCE : buffer.gate().newestStamp(frame);
    const Instant newest{Instant::NEWEST, toNs(tf.transforms.now().stamp)};  // of static ones
    X_PC =
        poseBetween(buffer, parent, child, last == EVER_SINCE ? newest : Instant{Instant::AT, last})
            .X_TS;
    return true;
  } catch (const InputError&) {
    return false;
  }
}

}  // namespace

JointQuery::JointQuery(const std::vector<std::string>& names, const CollisionScene& scene,
                       const JointQueryTf& tf)
    : scene_(scene), columns_(names, scene.robot()), zeros_(scene.robot().zeroPositions()) {
  const ros::Time common = place(tf);
  if (!tf.is_of_one_instant || common.isZero()) return;
  JointQueryTf then = tf;
  then.stamp = common;
  place(then);
}

ros::Time JointQuery::place(const JointQueryTf& tf) {
  stamp_ = tf.stamp;
  placed_.clear();
  joints_from_tf_.clear();
  joints_at_zero_.clear();
  unknown_because_.clear();
  const std::vector<char> are_needed = bodiesNeeded(scene_);
  std::vector<std::pair<std::string, ros::Time>> newest;  // by link
  bool can_age = !scene_.clouds().empty();
  for (const Body& body : scene_.robot().bodies()) {
    std::string problem;
    ros::Time stamp;
    const bool is_needed = are_needed[placed_.size()];
    placed_.push_back(poseOf(body, is_needed, tf, problem, stamp));
    if (problem.empty() && placed_.back() && is_needed) {
      problem = whyCarried(static_cast<int>(placed_.size()) - 1, tf);
    }
    if (!problem.empty() && is_needed) unknown_because_.push_back(std::move(problem));
    if (stamp.isZero()) continue;
    can_age = can_age || body.joint < 0;
    if (is_needed) newest.emplace_back(scene_.robot().links()[body.link].name, stamp);
  }
  const std::string clock = tf.transforms.clockProblem();
  if ((can_age || !joints_from_tf_.empty()) && !clock.empty()) unknown_because_.push_back(clock);
  if (!tf.stamp.isZero()) return ros::Time();
  ros::Time heard = tf.heard, common;
  for (const auto& [link, stamp] : newest) heard = std::max(heard, stamp);
  for (const auto& [link, stamp] : newest) {
    const std::string why = whyBehind(toNs(heard) - toNs(stamp), tf.transforms.buffer().limits());
    if (!why.empty()) {
      unknown_because_.push_back("link '" + link + "': " + why);
    } else {
      common = common.isZero() ? stamp : std::min(common, stamp);
    }
  }
  return common;
}

std::optional<Isometry3d> JointQuery::poseOf(const Body& body, bool is_needed,
                                             const JointQueryTf& tf, std::string& problem,
                                             ros::Time& stamp) {
  const RobotModel& robot = scene_.robot();
  const std::string& link = robot.links()[body.link].name;
  Isometry3d X_PB = Isometry3d::Identity();
  if (body.joint < 0) {
    if (tf.frame == link || askTf(tf, tf.frame, link, X_PB, problem, stamp)) return X_PB;
    if (!is_needed) return X_PB;  // the scene has none of its bodies
    throw InputError("TF does not know root link '" + link + "' in frame '" + tf.frame +
                     "' at stamp " + std::to_string(tf.stamp.toSec()) +
                     (tf.now.isZero() ? std::string(": ") + NO_CLOCK : ""));
  }
  if (columns_.sourceOf(body.joint).column >= 0) return std::nullopt;
  const Joint& joint = robot.joints()[body.joint];
  const std::string& parent = robot.links()[robot.bodies()[body.parent].link].name;
  if (askTf(tf, parent, link, X_PB, problem, stamp)) {
    joints_from_tf_.push_back(joint.name);
    return X_PB;
  }
  joints_at_zero_.push_back(joint.name);
  problem = "joint '" + joint.name + "' is neither named nor known to TF: it was taken as zero; " +
            (tf.now.isZero() ? NO_CLOCK : problem);
  return body.X_PJ * joint.motion(robot.zeroPositions()[body.joint]);
}

std::string JointQuery::whyCarried(int body, const JointQueryTf& tf) const {
  if (!tf.poses || columns_.size() == 0) return "";  // nothing is about to move
  const RobotModel& robot = scene_.robot();
  const auto moves = [&](int joint) {
    const int column = joint < 0 ? -1 : columns_.sourceOf(joint).column;
    if (column < 0 || !tf.moved) return column >= 0;
    const int named = columns_.jointOf(static_cast<std::size_t>(column));
    return contains(*tf.moved, robot.joints()[named].name);
  };
  const int parent = robot.bodies()[body].parent;
  if (parent < 0 && body == tf.poses->bodyOfFrame()) return "";  // TF was not asked
  const int other = parent >= 0 ? parent : tf.poses->bodyOfFrame();
  std::string why;
  int carried = body;
  for (std::size_t i = 0; i < robot.bodies().size() && why.empty(); ++i) {  // a cycle ends, too
    const int carrier = tf.poses->carrierOf(carried, tf.stamp);
    if (carrier < 0) break;
    const int common = robot.visitBetween(carrier, other, [&](int below, bool) {
      const int joint = robot.bodies()[below].joint;
      if (!why.empty() || !moves(joint)) return;
      why = "link '" + robot.links()[robot.bodies()[body].link].name + "': TF hangs it on '" +
            robot.links()[robot.bodies()[carrier].link].name + "', which joint '" +
            robot.joints()[joint].name +
            "' moves, and no URDF says so: where it is then is not known; make one URDF of both";
    });
    if (common >= 0) break;
    for (carried = carrier; robot.bodies()[carried].parent >= 0;) {  // may be carried, too
      carried = robot.bodies()[carried].parent;
    }
  }
  return why;
}

void JointQuery::refuseOtherCount(const std::vector<double>& positions) const {
  if (positions.size() == columns_.size()) return;
  throw InputError(std::to_string(columns_.size()) + " joints are named, but there are " +
                   std::to_string(positions.size()) + " positions");
}

void JointQuery::bodyPosesAt(const std::vector<double>& positions,
                             std::vector<Isometry3d>& X_WB) const {
  scene_.robot().forwardKinematics(jointPositionsAt(positions), placed_, X_WB);
}

void JointQuery::posesAt(const std::vector<double>& positions, BodyPoses& poses) const {
  thread_local std::vector<Isometry3d> X_WB;
  bodyPosesAt(positions, X_WB);
  scene_.gatherPoses(X_WB, poses);
}

std::vector<double> JointQuery::jointPositionsAt(const std::vector<double>& positions) const {
  refuseOtherCount(positions);
  std::vector<double> all = zeros_;
  columns_.apply(positions.data(), all);
  return all;
}

}  // namespace collision_pairs
