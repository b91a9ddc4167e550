#include "joint_transforms.h"

#include <algorithm>

#include "joint_state_positions.h"
#include "user_text.h"

namespace collision_pairs {

JointTransforms::JointTransforms(const std::map<std::string, std::set<std::string>>& joints,
                                 const RobotModel& robot, const std::string& prefix)
    : robot_(robot),
      is_named_(robot.joints().size(), 0),
      positions_(robot.zeroPositions()),
      moved_(robot.joints().size()) {
  robot.applyMimics(positions_);
  for (const auto& [topic, names] : joints) {
    const auto offer = [&, &topic = topic, &names = names](const std::string& joint_prefix) {
      std::map<std::string, int> found;
      for (std::size_t i = 0; i < robot.joints().size(); ++i) {
        const std::string name = joint_prefix + robot.joints()[i].name;
        if (names.count(name) > 0) found[name] = static_cast<int>(i);
      }
      if (found.size() <= joints_.size()) return;
      joints_ = std::move(found);
      topic_ = topic;
    };
    const bool is_own =
        topic == "/" + prefix + "/joint_states" || topic == prefix + "/joint_states";
    const bool is_common = topic == "/joint_states" || topic == "joint_states";
    // Without a prefix, a namespace tells one robot from another: only the one without is plain.
    if (prefix.empty() ? is_common || joints.size() == 1 : is_own) offer("");
    if (prefix.empty()) continue;
    offer(withPrefix(prefix, ""));
    offer(prefix);
  }
  for (std::size_t i = 0; i < robot.joints().size(); ++i) {
    if (robot.joints()[i].mimic) followers_.push_back(static_cast<int>(i));
  }
  std::sort(followers_.begin(), followers_.end(),
            [&robot](int a, int b) { return robot.joints()[a].name < robot.joints()[b].name; });
  for (const auto& entry : joints_) is_named_[entry.second] = 1;
  for (const int follower : followers_) {
    is_named_[follower] |= is_named_[robot.joints()[follower].mimic->joint];
  }
  for (std::size_t b = 0; b < robot.bodies().size(); ++b) {
    const int joint = robot.bodies()[b].joint;
    if (joint >= 0) moved_[joint].push_back(b);
  }
}

bool JointTransforms::isNamed(std::size_t body) const {
  const int joint = robot_.bodies()[body].joint;
  return is_named_[joint] && robot_.joints()[joint].hasPosition();
}

const std::string& JointTransforms::frameOf(int body) const {
  return robot_.links()[robot_.bodies()[body].link].name;
}

std::size_t JointTransforms::nbMoved(const std::vector<SceneBody>& bodies) const {
  return static_cast<std::size_t>(
      std::count_if(bodies.begin(), bodies.end(), [this](const SceneBody& scene_body) {
        const auto& all = robot_.bodies();
        int body = scene_body.body;
        while (all[body].joint >= 0) {
          if (isNamed(body)) return true;
          body = all[body].parent;
        }
        return false;
      }));
}

std::vector<std::string> JointTransforms::unnamedJoints(
    const std::vector<SceneBody>& bodies) const {
  std::set<std::string> names;
  for (const SceneBody& scene_body : bodies) {
    const auto& all = robot_.bodies();
    for (int body = scene_body.body; all[body].joint >= 0; body = all[body].parent) {
      if (isNamed(body)) continue;
      const auto* joint = &robot_.joints()[all[body].joint];
      while (joint->mimic && !is_named_[joint->mimic->joint]) {
        joint = &robot_.joints()[joint->mimic->joint];
      }
      names.insert(joint->name);
    }
  }
  return {names.begin(), names.end()};
}

geometry_msgs::TransformStamped JointTransforms::transformOf(
    std::size_t number, const std::vector<double>& positions) const {
  const Body& body = robot_.bodies()[number];
  const Eigen::Isometry3d X_PC =
      body.X_PJ * robot_.joints()[body.joint].motion(positions[body.joint]);
  const Eigen::Quaterniond R_PC(X_PC.linear());
  geometry_msgs::TransformStamped transform;
  transform.header.frame_id = frameOf(body.parent);
  transform.child_frame_id = frameOf(static_cast<int>(number));
  transform.transform.translation.x = X_PC.translation().x();
  transform.transform.translation.y = X_PC.translation().y();
  transform.transform.translation.z = X_PC.translation().z();
  transform.transform.rotation.x = R_PC.x();
  transform.transform.rotation.y = R_PC.y();
  transform.transform.rotation.z = R_PC.z();
  transform.transform.rotation.w = R_PC.w();
  return transform;
}

tf2_msgs::TFMessage JointTransforms::take(const sensor_msgs::JointState& state) {
  std::map<int, double> received;
  for (const auto& [name, position] : finitePositionsIn(state)) {
    const auto joint = joints_.find(name);
    if (joint != joints_.end()) received.emplace(joint->second, position);
  }
  // As robot_state_publisher: in the order of their names, and what is named counts.
  for (const int follower : followers_) {
    const Joint::Mimic& mimic = *robot_.joints()[follower].mimic;
    const auto leader = received.find(mimic.joint);
    if (leader == received.end()) continue;
    received.emplace(follower, mimic.multiplier * leader->second + mimic.offset);
  }
  tf2_msgs::TFMessage message;
  for (const auto& [joint, position] : received) {
    positions_[joint] = position;
    if (!robot_.joints()[joint].hasPosition()) continue;
    for (const std::size_t body : moved_[joint]) {
      message.transforms.push_back(transformOf(body, positions_));
      message.transforms.back().header.stamp = state.header.stamp;
    }
  }
  return message;
}

tf2_msgs::TFMessage JointTransforms::atZero() const {
  std::vector<double> zero = robot_.zeroPositions();
  robot_.applyMimics(zero);
  tf2_msgs::TFMessage message;
  for (std::size_t b = 0; b < robot_.bodies().size(); ++b) {
    if (robot_.bodies()[b].joint < 0 || isNamed(b)) continue;
    message.transforms.push_back(transformOf(b, zero));
  }
  return message;
}

std::set<std::string> JointTransforms::frames() const {
  std::set<std::string> frames;
  for (std::size_t b = 0; b < robot_.bodies().size(); ++b) {
    if (robot_.bodies()[b].joint >= 0) frames.insert(frameOf(static_cast<int>(b)));
  }
  return frames;
}

}  // namespace collision_pairs
