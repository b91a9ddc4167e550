#include "collision_pairs/collision_scene.h"

#include <algorithm>
#include <numeric>
#include <set>

#include "collision_pairs/input_error.h"
#include "nearest_name.h"
#include "scene_element.h"

namespace collision_pairs {
namespace {

/// A link on its way into the scene.
struct Candidate {
  const RobotModel* source;
  int link;
  bool is_static;
  bool needed = false;  // in some allowed pair
  Fidelity dearest = Fidelity::MESH;
  Fidelity needed_fidelity = Fidelity::AABB;  // the dearest of its allowed pairs
};

Fidelity cheaper(Fidelity a, Fidelity b) { return std::min(a, b); }

}  // namespace

/// Fills a scene step by step; what it holds besides is needed only while building.
class SceneBuilder {
 public:
  SceneBuilder(std::shared_ptr<const RobotModel> robot, const SceneSettings& settings)
      : scene_(new CollisionScene), settings_(settings), maker_(settings.max_hull_vertices) {
    if (settings.max_hull_vertices != 0 && settings.max_hull_vertices < 4) {
      throw InputError("max_hull_vertices is " + std::to_string(settings.max_hull_vertices) +
                       ", but must be 4 or more, or 0 for exact hulls");
    }
    scene_->robot_ = std::move(robot);
  }

  std::shared_ptr<const CollisionScene> build(const std::optional<Srdf>& srdf,
                                              const RobotModel* world, bool check_self) {
    check_self_ = check_self;
    collect(*scene_->robot_, false);
    if (world) collect(*world, true);
    std::sort(candidates_.begin(), candidates_.end(),
              [](const Candidate& a, const Candidate& b) { return nameOf(a) < nameOf(b); });
    refuseEqualNames();
    refuseUnknownLinks(world);
    switched_off_ = srdf ? srdf->switchedOff(robotLinkNames()) : adjacentNames();
    dropUnneeded();
    addModels();
    scene_->filter_ = makeFilter();
    addElements(world);
    return std::move(scene_);
  }

 private:
  static const std::string& nameOf(const Candidate& c) { return c.source->links()[c.link].name; }

  void collect(const RobotModel& source, bool is_static) {
    for (std::size_t i = 0; i < source.links().size(); ++i) {
      if (source.links()[i].elements.empty()) continue;
      candidates_.push_back({&source, static_cast<int>(i), is_static});
      const auto own = settings_.link_fidelity.find(nameOf(candidates_.back()));
      candidates_.back().dearest = own == settings_.link_fidelity.end()
                                       ? settings_.fidelity
                                       : cheaper(own->second, settings_.fidelity);
    }
  }

  void refuseEqualNames() const {
    for (std::size_t i = 1; i < candidates_.size(); ++i) {
      if (nameOf(candidates_[i - 1]) == nameOf(candidates_[i])) {
        throw InputError("link '" + nameOf(candidates_[i]) +
                         "' is in the robot and in the world; rename one of them");
      }
    }
  }

  void refuseUnknownLinks(const RobotModel* world) const {
    std::vector<std::string> names = robotLinkNames();
    if (world) {
      for (const Link& link : world->links()) names.push_back(link.name);
    }
    for (const auto& [name, fidelity] : settings_.link_fidelity) {
      if (std::find(names.begin(), names.end(), name) != names.end()) continue;
      throw InputError("link_fidelity names '" + name + "', which is no link of robot '" +
                       scene_->robot_->name() + "'; is '" + nearestName(name, names) + "' meant?");
    }
  }

  std::vector<std::string> robotLinkNames() const {
    std::vector<std::string> names;
    for (const Link& link : scene_->robot_->links()) names.push_back(link.name);
    return names;
  }

  std::set<Srdf::LinkPair> adjacentNames() const {
    std::set<Srdf::LinkPair> names;
    const auto& links = scene_->robot_->links();
    for (const auto& [a, b] : scene_->robot_->adjacentLinks()) {
      names.insert(std::minmax(links[a].name, links[b].name));
    }
    return names;
  }

  bool switchedOff(const Candidate& a, const Candidate& b) const {
    if (!check_self_) return true;
    return switched_off_.count({nameOf(a), nameOf(b)}) > 0;  // candidates are sorted by name
  }

  // A link in no allowed pair gets no box, no tree and no transform. The robot against a world is
  // always allowed.
  void dropUnneeded() {
    for (std::size_t i = 0; i < candidates_.size(); ++i) {
      for (std::size_t j = i + 1; j < candidates_.size(); ++j) {
        Candidate &a = candidates_[i], &b = candidates_[j];
        const Fidelity fidelity = cheaper(a.dearest, b.dearest);
        const bool nothing_new =
            a.needed && b.needed && fidelity <= a.needed_fidelity && fidelity <= b.needed_fidelity;
        if (nothing_new || (a.is_static && b.is_static)) continue;
        if (a.is_static == b.is_static && switchedOff(a, b)) continue;
        a.needed = b.needed = true;
        a.needed_fidelity = std::max(a.needed_fidelity, fidelity);
        b.needed_fidelity = std::max(b.needed_fidelity, fidelity);
      }
    }
    candidates_.erase(std::remove_if(candidates_.begin(), candidates_.end(),
                                     [](const Candidate& c) { return !c.needed; }),
                      candidates_.end());
  }

  int sceneBody(int body) {
    const auto& bodies = scene_->bodies_;
    const auto found = std::find_if(bodies.begin(), bodies.end(),
                                    [&](const SceneBody& b) { return b.body == body; });
    if (found != bodies.end()) return static_cast<int>(found - bodies.begin());
    const int link = scene_->robot_->bodies()[body].link;
    scene_->bodies_.push_back({body, scene_->robot_->links()[link].name});
    return static_cast<int>(bodies.size()) - 1;
  }

  void addModels() {
    for (const Candidate& c : candidates_) {
      const int body = c.is_static ? -1 : sceneBody(c.source->links()[c.link].body);
      scene_->models_.push_back({nameOf(c), body, 0, 0});
    }
  }

  // Every link of the robot is a class of its own; the world is one class.
  PairFilter makeFilter() const {
    std::vector<std::uint32_t> classes(candidates_.size());
    std::uint32_t next = 1;
    for (std::size_t i = 0; i < candidates_.size(); ++i) {
      classes[i] = candidates_[i].is_static ? 0 : next++;
    }
    PairFilter filter(classes);
    if (!candidates_.empty()) filter.setClassPair(0, 0, false);
    for (std::size_t i = 0; i < candidates_.size(); ++i) {
      if (candidates_[i].is_static) continue;
      for (std::size_t j = i + 1; j < candidates_.size(); ++j) {
        if (candidates_[j].is_static) continue;
        if (switchedOff(candidates_[i], candidates_[j])) {
          filter.setClassPair(classes[i], classes[j], false);
        }
      }
    }
    return filter;
  }

  // Static ones first, so that their ids are those of StaticBoxes.
  void addElements(const RobotModel* world) {
    std::vector<Eigen::Isometry3d> X_RB;
    if (world) world->forwardKinematics(world->zeroPositions(), X_RB);
    prepareElements();
    addElementsOf(true, X_RB);
    std::vector<Aabb> boxes;
    std::vector<std::uint32_t> models;
    for (const SceneElement& element : scene_->elements_) {
      boxes.push_back(element.boxAt(element.X_BE));
      models.push_back(element.model);
    }
    scene_->static_boxes_ = StaticBoxes(std::move(boxes), std::move(models));
    addElementsOf(false, {});
  }

  void prepareElements() {
    std::vector<std::pair<const Shape*, Fidelity>> wanted;
    for (const Candidate& c : candidates_) {
      for (const Element& element : c.source->links()[c.link].elements) {
        wanted.emplace_back(&element.shape, c.needed_fidelity);
      }
    }
    maker_.prepare(wanted, settings_.progress);
  }

  void addElementsOf(bool is_static, const std::vector<Eigen::Isometry3d>& X_RB) {
    for (std::uint32_t m = 0; m < candidates_.size(); ++m) {
      if (candidates_[m].is_static != is_static) continue;
      const Link& link = candidates_[m].source->links()[candidates_[m].link];
      const Eigen::Isometry3d X_BL = is_static ? X_RB[link.body] * link.X_BL : link.X_BL;
      CollisionModel& model = scene_->models_[m];
      model.first_element = static_cast<std::uint32_t>(scene_->elements_.size());
      model.nb_elements = static_cast<std::uint32_t>(link.elements.size());
      for (const Element& element : link.elements) {
        scene_->elements_.push_back(maker_.make(element.shape, candidates_[m].needed_fidelity));
        SceneElement& made = scene_->elements_.back();
        made.model = m;
        made.body = model.body;
        made.X_BE = X_BL * element.X_LE;
        made.dearest = candidates_[m].dearest;
      }
    }
  }

  std::unique_ptr<CollisionScene> scene_;
  const SceneSettings& settings_;
  ElementMaker maker_;
  std::vector<Candidate> candidates_;
  std::set<Srdf::LinkPair> switched_off_;
  bool check_self_ = true;
};

std::shared_ptr<const CollisionScene> CollisionScene::build(std::shared_ptr<const RobotModel> robot,
                                                            const std::optional<Srdf>& srdf,
                                                            std::shared_ptr<const RobotModel> world,
                                                            const SceneSettings& settings) {
  return SceneBuilder(std::move(robot), settings).build(srdf, world.get(), true);
}

std::shared_ptr<const CollisionScene> CollisionScene::buildAgainstWorldOnly(
    std::shared_ptr<const RobotModel> robot, std::shared_ptr<const RobotModel> world,
    const SceneSettings& settings) {
  return SceneBuilder(std::move(robot), settings).build(std::nullopt, world.get(), false);
}

void CollisionScene::gatherPoses(const std::vector<Eigen::Isometry3d>& X_RB,
                                 BodyPoses& poses) const {
  poses.resize(bodies_.size());
  for (std::size_t i = 0; i < bodies_.size(); ++i) poses.X_WB[i] = X_RB[bodies_[i].body];
}

int CollisionScene::findModel(const std::string& name) const {
  const auto found = std::lower_bound(
      models_.begin(), models_.end(), name,
      [](const CollisionModel& model, const std::string& wanted) { return model.name < wanted; });
  return found != models_.end() && found->name == name ? static_cast<int>(found - models_.begin())
                                                       : -1;
}

}  // namespace collision_pairs
