#include "collision_pairs/scene_description.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "collision_pairs/input_error.h"
#include "scene_members.h"
#include "user_text.h"

namespace collision_pairs {
namespace {

const Eigen::Isometry3d IDENTITY = Eigen::Isometry3d::Identity();

class NameCheck {
 public:
  NameCheck(const SceneDescription& description, const Objects& objects, const RobotModel& merged)
      : description_(description), objects_(objects), merged_(merged) {
    for (const Link& link : merged.links()) add(link.name);
    if (description.world) {
      // A root "world" without geometry in both is harmless: it is in no report.
      for (const Link& link : description.world->links()) {
        link.has_geometry ? add(link.name) : void(names_.insert(link.name));
      }
    }
    links_ = names_;
    for (const ObjectPtr& object : objects) add(object->name);
    for (const RigidObject& cloud : description.clouds) add(cloud.name);
  }

  void run() const {
    const SceneSettings& settings = description_.settings;
    for (const auto& entry : settings.link_fidelity) require(entry.first, "link_fidelity");
    for (const auto& entry : settings.link_padding) requireLink(entry.first, "link_padding");
    for (const PairRule& rule : settings.pair_rules) requireBoth(rule, "pair_rules");
    for (const PairPadding& padding : settings.pair_padding) requireBoth(padding, "pair_padding");
    for (const auto& name : settings.ignored_links) requireLinkIfNoPattern(name, "ignored_links");
    for (const auto& name : settings.cylinder_as_capsule) {
      requireLinkIfNoPattern(name, "cylinder_as_capsule");
    }
    for (const auto& name : description_.restriction.names) {
      requireIfNoPattern(name, "the restriction");
    }
    for (const ObjectPtr& object : objects_) checkObject(*object);
    for (const RigidObject& cloud : description_.clouds) checkCloud(cloud);
  }

 private:
  void add(const std::string& name) {
    if (names_.insert(name).second) return;
    const auto isNamedSo = [&](const RigidObject& object) { return object.name == name; };
    const auto& clouds = description_.clouds;
    if (std::any_of(clouds.begin(), clouds.end(), isNamedSo)) {
      throw InputError("cloud '" + name + "' has the name of a link, an object or another cloud");
    }
    const bool of_object = std::any_of(objects_.begin(), objects_.end(),
                                       [&](const ObjectPtr& object) { return isNamedSo(*object); });
    throw InputError(of_object ? "object '" + name + "' has the name of a link or another object"
                               : "link '" + name +
                                     "' is in the robot and in the world; rename one of them");
  }

  template <class NamesTwo>
  void requireBoth(const NamesTwo& pair, const std::string& where) const {
    requireIfNoPattern(pair.first, where);
    requireIfNoPattern(pair.second, where);
  }

  void requireIfNoPattern(const std::string& name, const std::string& where) const {
    if (!isPattern(name)) require(name, where);
  }

  void requireLinkIfNoPattern(const std::string& name, const std::string& where) const {
    if (!isPattern(name)) requireLink(name, where);
  }

  /// Of anything else the setting would be read, and not applied.
  void requireLink(const std::string& name, const std::string& where) const {
    if (links_.count(name) > 0) return;
    if (names_.count(name) == 0) refuse(name, where, links_);
    throw InputError(where + " names '" + name +
                     "', which is not a link: what is an object or a cloud has a padding of its "
                     "own, and pair_padding and pair_rules apply to it");
  }

  void require(const std::string& name, const std::string& where) const {
    if (names_.count(name) == 0) refuse(name, where, names_);
  }

  [[noreturn]] void refuse(const std::string& name, const std::string& where,
                           const std::set<std::string>& known) const {
    throw InputError(where + " names '" + name + "', which is not a link of robot '" +
                     merged_.name() + "'" + didYouMean(name, {known.begin(), known.end()}));
  }

  void checkObject(const RigidObject& object) const {
    const std::string where = "object '" + object.name + "'";
    if (object.name.empty()) throw InputError("an object has no name");
    if (object.elements.empty()) throw InputError(where + " has no shape");
    if (!hasItsMeshes(object)) throw InputError(where + " has a mesh without data");
    if (!object.attached_link.empty() && merged_.findLink(object.attached_link) < 0) {
      throw InputError(where + " is attached to '" + object.attached_link +
                       "', which is not a link of robot '" + merged_.name() + "'" +
                       didYouMean(object.attached_link, namesOf(merged_.links())));
    }
    for (const std::string& name : object.touch_links) require(name, where + ", touch_links");
    if (!areRotations(object)) {
      throw InputError(where + ": its pose, or that of a shape, is no rotation and translation");
    }
  }

  void checkCloud(const RigidObject& cloud) const {
    if (cloud.name.empty()) throw InputError("a cloud has no name");
    const auto* box =
        cloud.elements.size() == 1 ? std::get_if<Box>(&cloud.elements[0].shape) : nullptr;
    const bool is_voxel = box && box->size == Eigen::Vector3d::Constant(box->size[0]) &&
                          cloud.attached_link.empty() && cloud.X_PO.isApprox(IDENTITY, 0.0) &&
                          cloud.elements[0].X_LE.isApprox(IDENTITY, 0.0);
    if (!is_voxel) throw InputError("cloud '" + cloud.name + "' was not made by cloudOf()");
    if (!(box->size[0] > 0.0) || !std::isfinite(box->size[0])) {
      throw InputError("cloud '" + cloud.name + "': its voxel size is " +
                       std::to_string(box->size[0]) +
                       ", but must be more than 0 metres, and finite");
    }
    for (const std::string& name : cloud.touch_links) {
      require(name, "cloud '" + cloud.name + "', touch_links");
    }
  }

  const SceneDescription& description_;
  const Objects& objects_;
  const RobotModel& merged_;
  std::set<std::string> names_, links_;  ///< of all, and of those of the robot and the world
};

void checkPadding(double metres, const std::string& where) {
  if (metres >= 0.0 && std::isfinite(metres)) return;
  throw InputError(where + " is " + std::to_string(metres) +
                   ", but must be 0 or more metres, and finite");
}

void checkSizes(const SceneDescription& description, const Objects& objects) {
  const SceneSettings& settings = description.settings;
  if (settings.max_hull_vertices != 0 && settings.max_hull_vertices < 4) {
    throw InputError("max_hull_vertices is " + std::to_string(settings.max_hull_vertices) +
                     ", but must be 4 or more, or 0 for exact hulls");
  }
  checkPadding(settings.padding, "padding");
  for (const auto& [link, metres] : settings.link_padding) {
    checkPadding(metres, "link_padding of '" + link + "'");
  }
  for (const PairPadding& pair : settings.pair_padding) {
    checkPadding(pair.metres, "pair_padding of '" + pair.first + "' and '" + pair.second + "'");
  }
  const auto check = [](const RigidObject& object) {
    checkPadding(object.padding, "the padding of object '" + object.name + "'");
  };
  for (const ObjectPtr& object : objects) check(*object);
  for (const RigidObject& cloud : description.clouds) check(cloud);
}

}  // namespace

RigidObject floorAt(double height, std::vector<std::string> touch_links) {
  RigidObject floor;
  floor.name = "floor";
  floor.elements.push_back({HalfSpace{}, Eigen::Isometry3d::Identity()});
  floor.X_PO.translation().z() = height;
  floor.touch_links = std::move(touch_links);
  return floor;
}

RigidObject cloudOf(std::string name, double voxel_size, std::vector<std::string> touch_links) {
  RigidObject cloud;
  cloud.name = std::move(name);
  cloud.elements.push_back({Box{Eigen::Vector3d::Constant(voxel_size)}, IDENTITY});
  cloud.touch_links = std::move(touch_links);
  return cloud;
}

void checkDescription(const SceneDescription& description, const Objects& objects,
                      const RobotModel& merged) {
  NameCheck(description, objects, merged).run();
  checkSizes(description, objects);
}

}  // namespace collision_pairs
