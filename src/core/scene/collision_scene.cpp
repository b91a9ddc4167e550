#include "collision_pairs/collision_scene.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <stdexcept>

#include "collision_pairs/input_error.h"
#include "pair_policy.h"
#include "scene_element.h"
#include "scene_members.h"
#include "user_text.h"

namespace collision_pairs {
namespace {

// Share of a mesh's surface that is missing. What is closed in effect lacks 0, see MeshSolid; the
// rest is for loose triangles.
constexpr double TOLD_ABOVE = 0.01;

}  // namespace

/// Builds a scene step by step; its members are needed only while building.
class SceneBuilder {
 public:
  /// `objects`: instead of those of the description. `before`: null, or a scene of the same robots.
  SceneBuilder(const SceneDescription& description, const Objects& objects,
               const CollisionScene* before)
      : scene_(new CollisionScene),
        description_(description),
        classes_(std::make_shared<SceneClasses>()) {
    scene_->robot_ = before ? before->robot_ : mergedRobot(description);
    members_ = sceneMembers(description, objects, *scene_->robot_);
    SceneRules rules{StaticSignature(description, members_), namesIn(description, objects),
                     nullptr};
    rules.switched_off =
        before ? before->classes_->rules->switched_off
               : std::make_shared<const SwitchedOff>(switchedOffLinks(description.robots));
    classes_->rules = std::make_shared<const SceneRules>(std::move(rules));
    classify();
  }

  std::unique_ptr<CollisionScene> build(SceneCache& cache) {
    maker_ = cache.maker_.get();
    scene_->classes_ = classes_;
    dropUnneeded();
    scene_->unchecked_ = whatIsUnchecked();
    scene_->filter_.setModels(class_of_);
    addModels();
    try {
      prepareElements();
      addElements();
    } catch (const std::invalid_argument& problem) {  // from a shape, which does not know its owner
      refuseVastShapes();
      throw InputError(std::string("a shape of the scene: ") + problem.what());
    }
    return std::move(scene_);
  }

  std::set<std::string> neededNames() const {
    std::set<std::string> names;
    for (std::size_t i = 0; i < members_.size(); ++i) {
      if (classOf(i).is_needed) names.insert(members_[i].name);
    }
    // Whichever pairs are checked, SelfFilter has to tell the robot's own points from obstacles.
    if (!description_.clouds.empty()) {
      for (const Link& link : scene_->robot_->links()) names.insert(link.name);
    }
    return names;
  }

 private:
  void classify() {
    for (const SceneMember& member : members_) {
      auto next = static_cast<std::uint32_t>(classes_->all.size());
      if (member.isStatic() && !member.is_cloud) {
        const std::string signature = classes_->rules->signature.of(member);
        next = classes_->of_static.try_emplace(signature, next).first->second;
      }
      if (next == classes_->all.size()) classes_->all.push_back({member});
      class_of_.push_back(next);
    }
    PairPolicy policy = PairPolicy::of(description_, *classes_);
    scene_->filter_ = std::move(policy.filter);
    scene_->pair_padding_ = std::move(policy.paddings);
  }

  const SceneClasses::Class& classOf(std::size_t member) const {
    return classes_->all[class_of_[member]];
  }

  // Members in no allowed pair get no box, no tree and no transform.
  void dropUnneeded() {
    std::size_t kept = 0;
    for (std::size_t i = 0; i < members_.size(); ++i) {
      if (!classOf(i).is_needed) continue;
      const auto* const missing = members_[i].missing;
      const bool is_bare = members_[i].elements->empty();
      if (missing && (is_bare || !missing->empty())) scene_->missing_[members_[i].name] = *missing;
      if (is_bare) continue;
      members_[kept] = members_[i];
      class_of_[kept++] = class_of_[i];
    }
    members_.resize(kept);
    class_of_.resize(kept);
  }

  std::string whatIsUnchecked() const {
    std::string bare;
    const auto hasGeometry = [](const RobotModel& model) {
      const auto& links = model.links();
      return std::any_of(links.begin(), links.end(), [](const Link& l) { return l.has_geometry; });
    };
    if (description_.world && !hasGeometry(*description_.world)) {
      bare = "the environment has no collision geometry";
    }
    for (const SceneRobot& robot : description_.robots) {
      if (hasGeometry(*robot.model)) continue;
      if (description_.robots.size() == 1) return "the robot has no collision geometry";
      bare += (bare.empty() ? "" : "; ") + std::string("robot '") +
              withPrefix(robot.prefix, robot.model->name()) + "' has no collision geometry";
    }
    if (!bare.empty() || !members_.empty()) return bare;
    return description_.restriction.empty() ? "there is no pair to check"
                                            : "group and links leave no pair to check";
  }

  void addModels() {
    const RobotModel& robot = *scene_->robot_;
    auto& bodies = scene_->bodies_;
    std::vector<int> scene_body(robot.bodies().size(), -1);  // by body of the robot
    for (const SceneMember& member : members_) {
      if (!member.isStatic() && scene_body[member.body] < 0) {
        scene_body[member.body] = static_cast<int>(bodies.size());
        bodies.push_back({member.body, robot.links()[robot.bodies()[member.body].link].name});
      }
      const int body = member.isStatic() ? -1 : scene_body[member.body];
      const bool is_object = member.object != nullptr;
      const int attached_link = is_object ? robot.findLink(member.object->attached_link) : -1;
      scene_->models_.push_back({member.name, body, 0, 0, is_object, attached_link});
    }
  }

  void refuseVastShapes() const {
    for (const SceneMember& member : members_) {
      for (const Element& element : *member.elements) {
        if (std::holds_alternative<HalfSpace>(element.shape)) continue;
        const Aabb box = computeAabb(element.shape, Eigen::Isometry3d::Identity());
        const Eigen::Vector3d size = box.max - box.min;
        const bool is_mesh = std::holds_alternative<Mesh>(element.shape);
        if (!size.allFinite() || (is_mesh && size.maxCoeff() > LARGEST_MESH)) {
          throw InputError(whyNoBox(member.name));
        }
      }
    }
  }

  void prepareElements() {
    std::vector<std::pair<const Shape*, Fidelity>> wanted;
    for (std::size_t m = 0; m < members_.size(); ++m) {
      for (const Element& element : *members_[m].elements) {
        wanted.emplace_back(&element.shape, classOf(m).needed_fidelity);
      }
    }
    prepared_ = maker_->prepare(wanted, description_.settings);
    scene_->narrow_phase_ = description_.settings.narrow_phase;
  }

  // Static ones first, so that their ids are those of StaticBoxes.
  void addElements() {
    addElementsOf([](const SceneMember& m) { return m.isStatic() && !m.is_cloud; });
    std::vector<Aabb> boxes;
    std::vector<std::uint32_t> models;
    for (const SceneElement& element : scene_->elements_) {
      boxes.push_back(element.boxAt(element.X_BE));
      models.push_back(element.model);
      if (!boxes.back().valid()) {
        throw InputError(whyNoBox(scene_->models_[element.model].name));
      }
    }
    scene_->static_boxes_ = StaticBoxes(std::move(boxes), std::move(models));
    addElementsOf([](const SceneMember& member) { return !member.isStatic(); });
    auto first_of_clouds = static_cast<std::uint32_t>(scene_->elements_.size());
    addElementsOf([](const SceneMember& member) { return member.is_cloud; });
    for (std::uint32_t i = first_of_clouds; i < scene_->elements_.size(); ++i) {
      const SceneElement& element = scene_->elements_[i];
      scene_->clouds_.push_back({element.model, i, std::get<Box>(element.shape).size[0]});
    }
  }

  template <class IsWanted>
  void addElementsOf(const IsWanted& is_wanted) {
    for (std::uint32_t m = 0; m < members_.size(); ++m) {
      const SceneMember& member = members_[m];
      if (!is_wanted(member)) continue;
      CollisionModel& model = scene_->models_[m];
      model.first_element = static_cast<std::uint32_t>(scene_->elements_.size());
      model.nb_elements = static_cast<std::uint32_t>(member.elements->size());
      for (const Element& element : *member.elements) {
        scene_->elements_.push_back(makeElement(member, element, classOf(m)));
        scene_->elements_.back().model = m;
        scene_->elements_.back().body = model.body;
      }
    }
  }

  SceneElement makeElement(const SceneMember& member, const Element& element,
                           const SceneClasses::Class& its_class) {
    Shape shape = element.shape;
    const auto* cylinder = std::get_if<Cylinder>(&shape);
    if (cylinder && member.cylinder_as_capsule) shape = Capsule{cylinder->radius, cylinder->length};
    SceneElement made = prepared_.make(shape, its_class.needed_fidelity);
    setPlace(member, element, its_class.half_padding, made);
    return made;
  }

  std::unique_ptr<CollisionScene> scene_;
  const SceneDescription& description_;
  ElementMaker* maker_ = nullptr;
  PreparedElements prepared_;
  std::shared_ptr<SceneClasses> classes_;
  std::vector<SceneMember> members_;
  std::vector<std::uint32_t> class_of_;  // by member
};

SceneCache::SceneCache() : maker_(std::make_unique<ElementMaker>()) {}
SceneCache::~SceneCache() = default;

std::shared_ptr<const CollisionScene> CollisionScene::build(SceneDescription description,
                                                            SceneCache* cache) {
  Objects objects;
  for (RigidObject& object : description.objects) {
    objects.push_back(std::make_shared<const RigidObject>(std::move(object)));
  }
  std::sort(objects.begin(), objects.end(),
            [](const auto& a, const auto& b) { return a->name < b->name; });
  description.objects.clear();
  const auto kept = std::make_shared<SceneDescription>(std::move(description));
  auto scene = buildOf(kept, std::move(objects), cache, nullptr);
  kept->settings.progress = nullptr;  // may refer to what ends with this call
  return scene;
}

std::shared_ptr<const CollisionScene> CollisionScene::buildOf(
    const std::shared_ptr<const SceneDescription>& description, Objects objects, SceneCache* cache,
    const CollisionScene* before) {
  SceneCache of_this_scene;
  auto scene = SceneBuilder(*description, objects, before).build(cache ? *cache : of_this_scene);
  for (const auto& [link, why] : scene->missing_) {
    if (!before || !why.empty() || before->missing_.count(link) > 0) continue;
    throw InputError("link '" + link + "' is in a pair now, but its geometry was left out");
  }
  scene->objects_ = std::move(objects);
  scene->description_ = description;
  return scene;
}

std::set<std::string> CollisionScene::neededModels(const SceneDescription& description) {
  return SceneBuilder(description, objectsOf(description), nullptr).neededNames();
}

std::shared_ptr<const CollisionScene> CollisionScene::build(std::shared_ptr<const RobotModel> robot,
                                                            const std::optional<Srdf>& srdf,
                                                            std::shared_ptr<const RobotModel> world,
                                                            const SceneSettings& settings) {
  SceneDescription description;
  description.robots.push_back({std::move(robot), srdf, ""});
  description.world = std::move(world);
  description.settings = settings;
  return build(std::move(description));
}

std::vector<std::string> CollisionScene::openMeshes() const {
  std::map<std::string, std::set<std::string>> models_of;  // by what is said of the mesh
  for (const SceneElement& element : elements_) {
    const auto& prepared = element.rung(Fidelity::MESH).shape;
    const double share = prepared ? prepared->missingShare() : 0.0;
    if (!(share > TOLD_ABOVE)) continue;
    models_of[formatted("about %.0f %% of the surface of mesh ", 100.0 * share) +
              std::get<Mesh>(element.shape).mesh->name +
              " is missing: a body wholly inside it is not found"]
        .insert("'" + models_[element.model].name + "'");
  }
  std::vector<std::string> sentences;
  for (const auto& [what, models] : models_of) {
    sentences.push_back(joined({models.begin(), models.end()}) + ": " + what);
  }
  return sentences;
}

void CollisionScene::gatherPoses(const std::vector<Eigen::Isometry3d>& X_RB,
                                 BodyPoses& poses) const {
  poses.resize(bodies_.size());
  for (std::size_t i = 0; i < bodies_.size(); ++i) poses.X_WB[i] = X_RB[bodies_[i].body];
}

double CollisionScene::paddingOfPair(const SceneElement& a, const SceneElement& b) const {
  const auto found =
      pair_padding_.find(std::minmax(filter_.classOf(a.model), filter_.classOf(b.model)));
  return found == pair_padding_.end() ? a.padding + b.padding : found->second;
}

Eigen::Isometry3d CollisionScene::poseOfVoxel(std::uint32_t element,
                                              const Eigen::Vector3i& cell) const {
  const double voxel_size = clouds_[static_cast<std::size_t>(cloudOf(element))].voxel_size;
  Eigen::Isometry3d X_WV = Eigen::Isometry3d::Identity();
  X_WV.translation() = voxel_size * (cell.cast<double>().array() + 0.5);
  return X_WV;
}

int CollisionScene::carrierOf(std::uint32_t model,
                              const std::vector<std::optional<Eigen::Isometry3d>>& placed) const {
  if (models_[model].is_object || models_[model].body < 0) return -1;
  const auto& bodies = robot_->bodies();
  int first = -1;
  for (int body = bodies_[models_[model].body].body;
       bodies[body].parent >= 0 && robot_->joints()[bodies[body].joint].hasPosition();
       body = bodies[body].parent) {
    const auto number = static_cast<std::size_t>(body);
    if (number < placed.size() && placed[number]) return -1;
    first = body;
  }
  return first;
}

int CollisionScene::findModel(const std::string& name) const {
  const auto found = std::lower_bound(
      models_.begin(), models_.end(), name,
      [](const CollisionModel& model, const std::string& wanted) { return model.name < wanted; });
  return found != models_.end() && found->name == name ? static_cast<int>(found - models_.begin())
                                                       : -1;
}

std::string whyNoBox(const std::string& name) {
  return "'" + name + "' is too large or too far away for a finite box";
}

}  // namespace collision_pairs
