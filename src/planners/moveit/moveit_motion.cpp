#include "moveit_motion.h"

#include <algorithm>
#include <map>

#include <moveit/robot_model/prismatic_joint_model.h>
#include <moveit/robot_model/revolute_joint_model.h>

#include "collision_pairs/motion_check.h"

namespace collision_pairs {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;
using moveit::core::JointModel;
using moveit::core::LinkModel;
using moveit::core::RobotState;

constexpr char LINK[] = "link of the robot: ";

constexpr double SAME_POSE = 1e-9;  // metres, and for entries of a rotation

// Links and joints are called by MoveIt's index; mimic joints are joints like others, whose ends
// turnAsMoveit() sets.
std::shared_ptr<const RobotModel> modelOf(const moveit::core::RobotModel& robot,
                                          const std::vector<MovingBody>& moving) {
  std::vector<Link> links;
  std::vector<Joint> joints;
  for (const LinkModel* link : robot.getLinkModels()) {
    links.emplace_back();
    links.back().name = LINK + std::to_string(link->getLinkIndex());
    const LinkModel* parent = link->getParentLinkModel();
    if (!parent) continue;
    Joint joint;
    joint.name = links.back().name;
    joint.parent_link = parent->getLinkIndex();
    joint.child_link = link->getLinkIndex();
    joint.X_PJ = link->getJointOriginTransform();
    joint.type = JointType::FLOATING;
    const JointModel* joint_model = link->getParentJointModel();
    if (joint_model->getType() == JointModel::FIXED) joint.type = JointType::FIXED;
    if (joint_model->getType() == JointModel::REVOLUTE) {
      joint.type = JointType::CONTINUOUS;
      joint.axis = static_cast<const moveit::core::RevoluteJointModel*>(joint_model)->getAxis();
    }
    if (joint_model->getType() == JointModel::PRISMATIC) {
      joint.type = JointType::PRISMATIC;
      joint.axis = static_cast<const moveit::core::PrismaticJointModel*>(joint_model)->getAxis();
    }
    joints.push_back(std::move(joint));
  }
  for (const MovingBody& one : moving) {
    if (!one.body.is_attached)
      links[static_cast<std::size_t>(one.body.link)].elements = one.elements;
  }
  return RobotModel::fromParts("MoveIt's", std::move(links), std::move(joints));
}

bool areSame(const Isometry3d& a, const Isometry3d& b) {
  return (a.matrix() - b.matrix()).cwiseAbs().maxCoeff() <= SAME_POSE;  // false for NaN
}

}  // namespace

MoveitMotions::MoveitMotions(const moveit::core::RobotModel& robot,
                             const std::vector<MovingBody>& moving,
                             const std::vector<Isometry3d>& X_LO,
                             std::shared_ptr<const MoveitScene> world, SceneCache& cache)
    : world_(std::move(world)), X_LO_(X_LO), cache_(cache) {
  description_.check_self = false;
  description_.settings.allow_empty_scene = true;
  std::vector<std::string> names;
  for (const MovingBody& one : moving) {
    bodies_.push_back({one.body.is_attached ? "attached body: " + one.body.name
                                            : LINK + std::to_string(one.body.link),
                       one.body});
    names.push_back(bodies_.back().first);
  }
  for (std::size_t i = 0; i < moving.size(); ++i) {
    const std::string link = LINK + std::to_string(moving[i].body.link);
    if (!moving[i].body.is_attached) {
      if (moving[i].padding > 0.0) description_.settings.link_padding[link] = moving[i].padding;
      continue;
    }
    RigidObject object;
    object.name = names[i];
    object.elements = moving[i].elements;
    object.attached_link = link;
    object.X_PO = X_LO[description_.objects.size()];
    object.padding = moving[i].padding;
    object.touch_links = names;  // bodies of the robot against each other are not in question
    description_.objects.push_back(std::move(object));
  }
  for (const auto& object : world_->scene().objects()) {
    if (MoveitScene::isOfWorld(*object)) objects_.push_back(*object);
  }
  for (const auto& octree : world_->octrees()) addLeaves(*octree->octree());
  description_.robots.push_back({modelOf(robot, moving), Srdf{}, ""});
  for (const Link& link : description_.robots[0].model->links()) {
    const int index = std::stoi(link.name.substr(sizeof LINK - 1));
    links_.push_back(robot.getLinkModels()[static_cast<std::size_t>(index)]);
  }
}

void MoveitMotions::addLeaves(const MoveitOctree& octree) {
  leaves_.push_back(occupiedLeaves(*octree.tree));
  if (leaves_.back().empty()) return;
  auto object = std::find_if(objects_.begin(), objects_.end(),
                             [&](const RigidObject& known) { return known.name == octree.object; });
  if (object == objects_.end()) {
    objects_.emplace_back();
    objects_.back().name = octree.object;
    object = objects_.end() - 1;
  }
  appendBoxes(octree.tree->getResolution(), leaves_.back(), octree.X_WO, object->elements);
}

bool MoveitMotions::areFor(const MoveitScene* world, const std::vector<Isometry3d>& X_LO) const {
  if (world_.get() != world) return false;
  for (std::size_t i = 0; i < leaves_.size(); ++i) {
    if (leaves_[i] != occupiedLeaves(*world->octrees()[i]->octree()->tree)) return false;
  }
  return std::equal(X_LO.begin(), X_LO.end(), X_LO_.begin(), X_LO_.end(),
                    [](const auto& a, const auto& b) { return a.matrix() == b.matrix(); });
}

std::shared_ptr<const CollisionScene> MoveitMotions::sceneFor(const MoveitLimits& limits) const {
  std::vector<std::vector<std::string>> left_out;  // by object
  for (const auto& object : objects_) {
    left_out.emplace_back();
    for (const auto& [name, body] : bodies_) {
      const bool is_out =
          allowedBy(limits, &body, body.name, nullptr, object.name) == AllowedContact::ALWAYS;
      if (is_out) left_out.back().push_back(name);
    }
  }
  const std::lock_guard<std::mutex> lock(mutex_);
  if (scene_ && left_out == left_out_) return scene_;
  SceneDescription description = description_;
  for (std::size_t i = 0; i < objects_.size(); ++i) {
    description.objects.push_back(objects_[i]);
    description.objects.back().touch_links = left_out[i];
  }
  scene_ = CollisionScene::build(std::move(description), &cache_);
  left_out_ = std::move(left_out);
  return scene_;
}

bool MoveitMotions::follow(const RobotState& state, std::vector<double>& positions,
                           PlacedBodies& placed) const {
  const RobotModel& robot = *description_.robots[0].model;
  const auto& joints = robot.joints();
  positions.assign(joints.size(), 0.0);
  for (std::size_t j = 0; j < joints.size(); ++j) {
    const LinkModel* child = links_[static_cast<std::size_t>(joints[j].child_link)];
    const LinkModel* parent = links_[static_cast<std::size_t>(joints[j].parent_link)];
    if (joints[j].hasPosition()) {
      positions[j] = *state.getJointPositions(child->getParentJointModel());
    } else if (joints[j].type != JointType::FIXED) {
      continue;  // placed
    }
    const Isometry3d X_PC =
        state.getGlobalLinkTransform(parent).inverse() * state.getGlobalLinkTransform(child);
    if (!areSame(X_PC, joints[j].X_PJ * joints[j].motion(positions[j]))) return false;
  }
  placed.assign(robot.bodies().size(), std::nullopt);
  const auto poseOf = [&](int link) -> const Isometry3d& {
    return state.getGlobalLinkTransform(links_[static_cast<std::size_t>(link)]);
  };
  for (std::size_t b = 0; b < robot.bodies().size(); ++b) {
    const Body& body = robot.bodies()[b];
    if (body.joint >= 0 && joints[static_cast<std::size_t>(body.joint)].hasPosition()) continue;
    placed[b] = poseOf(body.link);
    if (body.parent < 0) continue;
    const Body& parent = robot.bodies()[static_cast<std::size_t>(body.parent)];
    placed[b] = poseOf(parent.link).inverse() * *placed[b];
  }
  return true;
}

// Sets the ends of continuous joints and of those that mimic others to where MoveIt's interpolation
// leads them.
bool MoveitMotions::turnAsMoveit(JointMotion& motion) const {
  const auto& joints = description_.robots[0].model->joints();
  std::map<const JointModel*, std::size_t> positions;
  for (std::size_t j = 0; j < joints.size(); ++j) {
    const LinkModel* child = links_[static_cast<std::size_t>(joints[j].child_link)];
    const JointModel* joint = child->getParentJointModel();
    positions[joint] = j;
    if (joint->getMimic() || joint->getType() != JointModel::REVOLUTE) continue;
    const auto* revolute = static_cast<const moveit::core::RevoluteJointModel*>(joint);
    if (revolute->isContinuous()) motion.to[j] = endOfTurn(motion.from[j], motion.to[j]);
  }
  for (const auto& [joint, j] : positions) {
    const JointModel* leader = joint->getMimic();
    if (!leader || joints[j].type == JointType::FIXED) continue;
    if (!joints[j].hasPosition()) return false;  // planar: of several variables MoveIt sets one
    const std::size_t l = positions.at(leader);
    for (std::vector<double>* end : {&motion.from, &motion.to}) {
      const std::optional<double> position =
          endOfMimic((*end)[l], joint->getMimicFactor(), joint->getMimicOffset(), (*end)[j],
                     joint->getType() == JointModel::REVOLUTE);
      if (!position) return false;
      (*end)[j] = *position;
    }
  }
  return true;
}

void MoveitMotions::check(const RobotState& from, const RobotState& to, const MoveitLimits& limits,
                          const collision_detection::CollisionRequest& request,
                          collision_detection::CollisionResult& result) const {
  if (objects_.empty() || bodies_.empty()) return;
  JointMotion motion;
  PlacedBodies placed, placed_after;
  const auto refuse = [&](const char* why) {
    warnRarely(std::string("a motion cannot be checked, and so is taken for a collision: ") + why);
    result.collision = true;
  };
  if (from.dirtyLinkTransforms() || to.dirtyLinkTransforms()) return refuse("update() its states");
  if (!follow(from, motion.from, placed) || !follow(to, motion.to, placed_after)) {
    return refuse("links are not where their joints put them");
  }
  for (std::size_t b = 0; b < placed.size(); ++b) {
    if (placed[b] && !areSame(*placed[b], *placed_after[b])) {
      return refuse("a floating or planar joint moves");
    }
  }
  if (!turnAsMoveit(motion)) {
    return refuse("a joint that mimics another is not where that puts it, jumps or is planar");
  }
  MotionCheck check(sceneFor(limits));
  const MotionReport& report = check.check(motion, MotionSettings(), placed);
  if (report.verdict == Verdict::FREE) return;
  result.collision = true;
  if (report.verdict == Verdict::UNKNOWN) {
    return warnRarely("a motion is not certain, and so taken for a collision, from fraction " +
                      std::to_string(report.free_until) + " on");
  }
  RobotState there(from);
  from.interpolate(to, report.contact_at, there);
  there.update();
  collision_detection::CollisionResult found;
  addCollisions(*world_, there, limits, request, found);
  for (auto& [names, contacts] : found.contacts) {
    for (collision_detection::Contact& contact : contacts) {
      if (result.contact_count == request.max_contacts) return;
      contact.percent_interpolation = report.contact_at;
      result.contacts[names].push_back(contact);
      ++result.contact_count;
    }
  }
}

}  // namespace collision_pairs
