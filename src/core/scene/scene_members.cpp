#include "scene_members.h"

#include <algorithm>
#include <stdexcept>

#include "collision_pairs/input_error.h"
#include "pose_repair.h"

namespace collision_pairs {
namespace {

using Eigen::Isometry3d;

bool matchesAny(const std::vector<NamePattern>& patterns, const std::string& name) {
  return std::any_of(patterns.begin(), patterns.end(),
                     [&](const NamePattern& pattern) { return matches(pattern, name); });
}

SceneMember memberWith(const std::string& name, const std::vector<Element>& elements,
                       const SceneSettings& settings) {
  SceneMember member;
  member.name = name;
  member.elements = &elements;
  const auto own = settings.link_fidelity.find(name);
  member.finest = own == settings.link_fidelity.end() ? settings.fidelity
                                                      : std::min(own->second, settings.fidelity);
  return member;
}

class MemberCollector {
 public:
  MemberCollector(const SceneDescription& description, const Objects& objects,
                  const RobotModel& merged)
      : description_(description),
        objects_(objects),
        settings_(description.settings),
        merged_(merged) {}

  std::vector<SceneMember> collect() {
    addRobots();
    if (description_.world) addWorld(*description_.world);
    for (const ObjectPtr& object : objects_) addObject(object);
    for (const RigidObject& cloud : description_.clouds) {
      addObject(ObjectPtr(ObjectPtr(), &cloud)).is_cloud = true;
    }
    std::sort(members_.begin(), members_.end(),
              [](const SceneMember& a, const SceneMember& b) { return a.name < b.name; });
    return std::move(members_);
  }

 private:
  // The links of the merged model are ordered by robot.
  void addRobots() {
    std::size_t i = 0;
    for (std::size_t robot = 0; robot < description_.robots.size(); ++robot) {
      const std::size_t end = i + description_.robots[robot].model->links().size();
      for (; i < end; ++i) {
        const Link& link = merged_.links()[i];
        if (SceneMember* member = addLink(link)) {
          member->robot = static_cast<int>(robot);
          member->link = static_cast<int>(i);
          member->body = link.body;
          member->X_BM = link.X_BL;
          const auto own = settings_.link_padding.find(link.name);
          member->padding = own == settings_.link_padding.end() ? settings_.padding : own->second;
        }
      }
    }
  }

  void addWorld(const RobotModel& world) {
    for (const Joint& joint : world.joints()) {
      if (!joint.leader_missing) continue;
      throw InputError("environment: joint '" + joint.name +
                       "' follows one that is not there (<mimic>): nobody knows its position");
    }
    std::vector<Isometry3d> X_WB;
    world.forwardKinematics(world.zeroPositions(), X_WB);
    for (const Link& link : world.links()) {
      if (SceneMember* member = addLink(link)) {
        member->X_BM = X_WB[link.body] * link.X_BL;
        const auto own = settings_.link_padding.find(link.name);
        if (own != settings_.link_padding.end()) member->padding = own->second;
      }
    }
  }

  /// Null if the link cannot be in a pair. One whose geometry was left out can: see neededModels().
  SceneMember* addLink(const Link& link) {
    const bool is_bare = link.elements.empty() && !link.has_geometry && link.missing.empty();
    if (is_bare || matchesAny(settings_.ignored_links, link.name)) return nullptr;
    members_.push_back(memberWith(link.name, link.elements, settings_));
    members_.back().missing = &link.missing;
    members_.back().cylinder_as_capsule = matchesAny(settings_.cylinder_as_capsule, link.name);
    return &members_.back();
  }

  SceneMember& addObject(const ObjectPtr& object) {
    members_.push_back(objectMember(object, settings_, merged_));
    return members_.back();
  }

  const SceneDescription& description_;
  const Objects& objects_;
  const SceneSettings& settings_;
  const RobotModel& merged_;
  std::vector<SceneMember> members_;
};

}  // namespace

void setPlace(const SceneMember& member, const Element& element, double half_padding,
              SceneElement& made) {
  const bool is_mesh = std::holds_alternative<Mesh>(element.shape);
  if (is_mesh && made.box_half.maxCoeff() > 0.5 * LARGEST_MESH) {
    throw std::invalid_argument("mesh: it is too large");
  }
  made.X_BE = member.X_BM * element.X_LE;
  made.finest = member.finest;
  made.padding = member.padding;
  made.box_padding = std::max(member.padding, half_padding);
}

bool areRotations(const RigidObject& object) {
  const auto passes = [](const Isometry3d& X) {
    return !X.linear().allFinite() || isRotation(X.linear());
  };
  return passes(object.X_PO) &&
         std::all_of(object.elements.begin(), object.elements.end(),
                     [&](const Element& element) { return passes(element.X_LE); });
}

bool hasItsMeshes(const RigidObject& object) {
  return std::none_of(object.elements.begin(), object.elements.end(), [](const Element& element) {
    const auto* mesh = std::get_if<Mesh>(&element.shape);
    const auto* convex = std::get_if<Convex>(&element.shape);
    return (mesh && !mesh->mesh) || (convex && !convex->mesh);
  });
}

SceneMember objectMember(const ObjectPtr& object, const SceneSettings& settings,
                         const RobotModel& merged) {
  SceneMember member = memberWith(object->name, object->elements, settings);
  member.object = object;
  member.padding = object->padding;
  member.X_BM = object->X_PO;
  if (object->attached_link.empty()) return member;
  const Link& link = merged.links()[merged.findLink(object->attached_link)];
  member.body = link.body;
  member.X_BM = link.X_BL * object->X_PO;
  return member;
}

Objects objectsOf(const SceneDescription& description) {
  Objects objects;
  for (const RigidObject& object : description.objects) {
    objects.push_back(ObjectPtr(ObjectPtr(), &object));
  }
  return objects;
}

std::shared_ptr<const RobotModel> mergedRobot(const SceneDescription& description) {
  const auto& robots = description.robots;
  for (std::size_t i = 0; i < robots.size(); ++i) {
    if (!robots[i].model) throw InputError("robots[" + std::to_string(i) + "] has no model");
  }
  const bool is_as_it_is = robots.size() == 1 && robots[0].prefix.empty() &&
                           robots[0].X_WR.isApprox(Isometry3d::Identity(), 0.0);
  if (is_as_it_is) return robots[0].model;
  std::vector<RobotModel::Placed> placed;
  for (const SceneRobot& robot : robots) placed.push_back({robot.model, robot.prefix, robot.X_WR});
  return RobotModel::merge(placed);
}

std::vector<SceneMember> sceneMembers(const SceneDescription& description, const Objects& objects,
                                      const RobotModel& merged) {
  checkDescription(description, objects, merged);
  return MemberCollector(description, objects, merged).collect();
}

}  // namespace collision_pairs
