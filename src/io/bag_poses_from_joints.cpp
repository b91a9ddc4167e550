// bagPosesFromJoints()
#include <algorithm>
#include <map>
#include <set>

#include "bag_poses.h"
#include "frame_names.h"
#include "user_text.h"

namespace collision_pairs {
namespace {

using Positions = std::vector<RecordedPosition>;

/// By joint of the robot: the number of its name with `prefix`; -1: none of the positions is its.
std::vector<int> numbersOfJoints(const BagContents& bag, const Positions& positions,
                                 const RobotModel& robot, const std::string& prefix) {
  std::vector<char> is_named(bag.names.all().size(), 0);
  for (const RecordedPosition& position : positions) is_named[position.joint] = 1;
  std::vector<int> names;
  for (const Joint& joint : robot.joints()) {
    const int name = bag.names.find(prefix + joint.name);
    names.push_back(name >= 0 && is_named[name] ? name : -1);
  }
  return names;
}

/// The topic, and the names of the robot's joints in it.
struct Choice {
  const std::string* topic = nullptr;
  const Positions* positions = nullptr;
  std::vector<int> names;
  std::ptrdiff_t nb_named = 0;
};

Choice choose(const BagContents& bag, const RobotModel& robot, const std::string& prefix) {
  Choice best;
  for (const auto& entry : bag.joints) {
    const std::string& topic = entry.first;
    const Positions& positions = entry.second;
    const auto offer = [&](const std::string& joint_prefix) {
      std::vector<int> names = numbersOfJoints(bag, positions, robot, joint_prefix);
      const auto count =
          static_cast<std::ptrdiff_t>(names.size()) - std::count(names.begin(), names.end(), -1);
      if (count > best.nb_named) best = {&topic, &positions, std::move(names), count};
    };
    const bool is_own =
        topic == "/" + prefix + "/joint_states" || topic == prefix + "/joint_states";
    const bool is_common = topic == "/joint_states" || topic == "joint_states";
    // Without a prefix, a namespace tells one robot from another: only the one without is plain.
    if (prefix.empty() ? is_common || bag.joints.size() == 1 : is_own) offer("");
    if (prefix.empty()) continue;
    offer(withPrefix(prefix, ""));
    offer(prefix);
  }
  return best;
}

class BagPosesFromJoints : public BagPoses {
 public:
  BagPosesFromJoints(const BagContents& bag, const CollisionScene& scene,
                     const BagPosesOptions& options)
      : BagPoses(bag, scene, options), transforms_(bag.limits, true) {
    const RobotModel& robot = scene.robot();
    choice_ = choose(bag, robot, prefix_);
    if (!choice_.positions) return;
    source_ = "joint states of " + *choice_.topic;
    std::vector<std::string> static_joints = options.static_joints;
    for (std::size_t b = 0; b < robot.bodies().size(); ++b) {
      const int joint = robot.bodies()[b].joint;
      drivers_.push_back(joint < 0 ? -1 : driverOf(joint));
      if (joint >= 0 && !isNamed(drivers_[b])) static_joints.push_back(robot.joints()[joint].name);
    }
    countKnown();
    noteJointsAtZero();
    makeTransforms();
    place(transforms_, static_joints);
  }

 private:
  int driverOf(int joint) const {
    const auto& joints = scene_.robot().joints();
    while (joints[joint].mimic) joint = joints[joint].mimic->joint;
    return joint;
  }
  bool isNamed(int driver) const {
    return choice_.names[driver] >= 0 && scene_.robot().joints()[driver].hasPosition();
  }

  /// As the bag's transforms name it.
  std::string frameOf(int body) const {
    const std::string& link = scene_.robot().links()[scene_.robot().bodies()[body].link].name;
    const int frame = robot_->frameOf(link);
    return frame < 0 ? withPrefix(prefix_, link) : bag_.transforms.frames()[frame];
  }

  ReceivedTransform transformOf(int number, const std::vector<double>& positions,
                                StampNs stamp) const {
    const RobotModel& robot = scene_.robot();
    const Body& body = robot.bodies()[number];
    const Eigen::Isometry3d X_PC =
        body.X_PJ * robot.joints()[body.joint].motion(positions[body.joint]);
    return {frames_[body.parent], frames_[number], stamp, X_PC.translation(),
            Eigen::Quaterniond(X_PC.linear())};
  }

  /// In the order of arrival, with the bag's transforms of frames that the joints do not move.
  void makeTransforms() {
    const RobotModel& robot = scene_.robot();
    std::set<std::string> made;
    std::map<int, std::vector<int>> bodies_by_name;  // of a driver
    std::map<int, int> joint_by_name;
    std::vector<double> positions = robot.zeroPositions();
    robot.applyMimics(positions);
    for (std::size_t i = 0; i < robot.bodies().size(); ++i) {
      const int b = static_cast<int>(i);
      frames_.push_back(frameOf(b));
      if (drivers_[i] < 0) continue;
      made.insert(frames_[i]);
      if (isNamed(drivers_[i])) {
        const int name = choice_.names[drivers_[i]];
        bodies_by_name[name].push_back(b);
        joint_by_name[name] = drivers_[i];
      } else {
        transforms_.take(transformOf(b, positions, 0), true, "", 0);
      }
    }
    auto next = choice_.positions->begin();
    const auto takeUntil = [&](StampNs received) {
      for (; next != choice_.positions->end() && next->received <= received; ++next) {
        const auto bodies = bodies_by_name.find(next->joint);
        if (bodies == bodies_by_name.end()) continue;
        stamps_.push_back(next->stamp);
        positions[joint_by_name[next->joint]] = next->position;
        robot.applyMimics(positions);
        for (const int body : bodies->second) {
          noteRefusal(transforms_.take(transformOf(body, positions, next->stamp), false,
                                       bag_.names.all()[next->publisher], next->received),
                      bag_.names.all()[next->joint]);
        }
      }
    };
    bag_.forEachTransform([&](const ReceivedTransform& transform, bool is_static,
                              const std::string& publisher, StampNs received) {
      if (made.count(withoutLeadingSlash(transform.child)) > 0) return;
      takeUntil(received);
      transforms_.take(transform, is_static, publisher, received);
    });
    takeUntil(NEVER);
    finishStamps(stamps_);
    if (nb_refused_ == 0) return;
    notes_.push_back(
        std::to_string(nb_refused_) +
        " joint positions are not used, or are in doubt; the first: " + first_refusal_);
  }

  void noteRefusal(const std::string& why, const std::string& joint) {
    if (!why.empty() && nb_refused_++ == 0) first_refusal_ = "joint '" + joint + "': " + why;
  }

  void countKnown() {
    const auto& bodies = scene_.robot().bodies();
    for (const SceneBody& scene_body : scene_.bodies()) {
      int body = scene_body.body;
      while (bodies[body].joint >= 0 &&
             (drivers_[body] != bodies[body].joint || !isNamed(drivers_[body]))) {
        body = bodies[body].parent;
      }
      if (bodies[body].joint >= 0) ++nb_known_;
    }
  }

  void noteJointsAtZero() {
    const auto& joints = scene_.robot().joints();
    const auto& bodies = scene_.robot().bodies();
    std::set<std::string> names;
    for (const SceneBody& scene_body : scene_.bodies()) {
      for (int body = scene_body.body; bodies[body].joint >= 0; body = bodies[body].parent) {
        const int driver = drivers_[body];
        if (!isNamed(driver)) names.insert(joints[driver].name);
      }
    }
    joints_at_zero_.assign(names.begin(), names.end());
    if (names.empty()) return;
    notes_.push_back("joints that it does not name are taken as zero: " + joined(joints_at_zero_));
  }

  Choice choice_;
  TransformBuffer transforms_;
  std::vector<int> drivers_;  ///< by body: the joint that moves it, or leads its joint; or -1
  std::vector<std::string> frames_;  ///< by body
  std::size_t nb_refused_ = 0;
  std::string first_refusal_;
};

}  // namespace

std::unique_ptr<const BagPoses> bagPosesFromJoints(const BagContents& bag,
                                                   const CollisionScene& scene,
                                                   const BagPosesOptions& options) {
  return std::make_unique<BagPosesFromJoints>(bag, scene, options);
}

}  // namespace collision_pairs
