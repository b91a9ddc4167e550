#include "collision_pairs/collision_scene.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <set>
#include <stdexcept>

#include "collision_pairs/input_error.h"
#include "pair_policy.h"
#include "scene_element.h"
#include "scene_members.h"
#include "static_classes.h"

namespace collision_pairs {
namespace {

// Share of a mesh's surface that is missing. What is closed in effect lacks 0, see MeshSolid; the
// rest is for loose triangles.
constexpr double TOLD_ABOVE = 0.01;

/// Members that are treated alike. Each moving member is a class of its own, while all objects of a
/// large world may share one, which keeps the tables of pairs small.
struct MemberClass {
  std::size_t example;                        // one of its members
  bool needed = false;                        // in some allowed pair
  Fidelity needed_fidelity = Fidelity::AABB;  // the finest in its allowed pairs
  double half_padding = 0.0;                  // half of the largest padding set for a single pair
};

}  // namespace

/// Builds a scene step by step; its members are needed only while building.
class SceneBuilder {
 public:
  SceneBuilder(const SceneDescription& description)
      : scene_(new CollisionScene), description_(description) {
    scene_->robot_ = mergedRobot(description);
    members_ = sceneMembers(description, *scene_->robot_);
    static_classes_ = std::make_shared<StaticClasses>(
        StaticClasses{StaticSignature(description, members_), {}, {}});
    classify();
  }

  std::unique_ptr<CollisionScene> build(SceneCache& cache) {
    maker_ = cache.maker_.get();
    static_classes_->named = namesIn(description_);
    scene_->static_classes_ = static_classes_;
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
      if (classes_[class_of_[i]].needed) names.insert(members_[i].name);
    }
    // Whichever pairs are checked, SelfFilter has to tell the robot's own points from obstacles.
    if (!description_.clouds.empty()) {
      for (const Link& link : scene_->robot_->links()) names.insert(link.name);
    }
    return names;
  }

 private:
  void classify() {
    const StaticSignature& signature = static_classes_->signature;
    const PairPolicy policy(description_, members_, signature.restricted());
    auto& class_of_static = static_classes_->by_signature;
    for (std::size_t i = 0; i < members_.size(); ++i) {
      auto next = static_cast<std::uint32_t>(classes_.size());
      if (members_[i].isStatic() && !members_[i].is_cloud) {
        const StaticClasses::Class its_class{next, false, Fidelity::AABB, 0.0};
        next = class_of_static.try_emplace(signature.of(members_[i]), its_class).first->second.id;
      }
      if (next == classes_.size()) classes_.push_back({i});
      class_of_.push_back(next);
    }
    std::vector<std::size_t> examples;
    for (const MemberClass& its_class : classes_) examples.push_back(its_class.example);
    scene_->filter_ = policy.filter(class_of_, examples);
    noteNeeds();
    scene_->pair_padding_ = policy.paddings(scene_->filter_, examples);
    for (const auto& [pair, metres] : scene_->pair_padding_) {
      for (MemberClass* one : {&classes_[pair.first], &classes_[pair.second]}) {
        one->half_padding = std::max(one->half_padding, 0.5 * metres);
      }
    }
    for (auto& [text, of_static] : class_of_static) {
      const MemberClass& known = classes_[of_static.id];
      of_static = {of_static.id, known.needed, known.needed_fidelity, known.half_padding};
    }
  }

  // A pair is checked at the coarser geometry of its two members.
  void noteNeeds() {
    const std::size_t nb_words = (classes_.size() + 63) / 64;
    for (const Fidelity fidelity :
         {Fidelity::AABB, Fidelity::SPHERES, Fidelity::OBB, Fidelity::CONVEX, Fidelity::MESH}) {
      std::vector<std::uint64_t> as_fine(nb_words, 0);
      const auto isAsFine = [&](std::size_t c) {
        return members_[classes_[c].example].finest >= fidelity;
      };
      for (std::size_t c = 0; c < classes_.size(); ++c) {
        if (isAsFine(c)) as_fine[c >> 6] |= std::uint64_t{1} << (c & 63);
      }
      for (std::uint32_t c = 0; c < classes_.size(); ++c) {
        const std::uint64_t* row = scene_->filter_.row(c);
        bool meets = false;
        for (std::size_t w = 0; isAsFine(c) && !meets && w < nb_words; ++w) {
          meets = row[w] & as_fine[w];
        }
        if (!meets) continue;
        classes_[c].needed = true;
        classes_[c].needed_fidelity = fidelity;
      }
    }
  }

  // Members in no allowed pair get no box, no tree and no transform.
  void dropUnneeded() {
    std::size_t kept = 0;
    for (std::size_t i = 0; i < members_.size(); ++i) {
      if (!classes_[class_of_[i]].needed) continue;
      members_[kept] = members_[i];
      class_of_[kept++] = class_of_[i];
    }
    members_.resize(kept);
    class_of_.resize(kept);
  }

  std::string whatIsUnchecked() const {
    std::string bare;
    for (const SceneRobot& robot : description_.robots) {
      const auto& links = robot.model->links();
      if (std::any_of(links.begin(), links.end(), [](const Link& l) { return l.has_geometry; })) {
        continue;
      }
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

  [[noreturn]] static void refuseVast(const std::string& name) { throw InputError(whyNoBox(name)); }

  void refuseVastShapes() const {
    for (const SceneMember& member : members_) {
      for (const Element& element : *member.elements) {
        if (std::holds_alternative<HalfSpace>(element.shape)) continue;
        const Aabb box = computeAabb(element.shape, Eigen::Isometry3d::Identity());
        const Eigen::Vector3d size = box.max - box.min;
        const bool has_square = std::isfinite(size.squaredNorm());  // OBBs of meshes need it
        const bool is_mesh = std::holds_alternative<Mesh>(element.shape);
        if (!size.allFinite() || (is_mesh && !has_square)) refuseVast(member.name);
      }
    }
  }

  void prepareElements() {
    std::vector<std::pair<const Shape*, Fidelity>> wanted;
    for (std::size_t m = 0; m < members_.size(); ++m) {
      for (const Element& element : *members_[m].elements) {
        wanted.emplace_back(&element.shape, classes_[class_of_[m]].needed_fidelity);
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
      if (!boxes.back().valid()) refuseVast(scene_->models_[element.model].name);
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
        scene_->elements_.push_back(makeElement(member, element, classes_[class_of_[m]]));
        scene_->elements_.back().model = m;
        scene_->elements_.back().body = model.body;
      }
    }
  }

  SceneElement makeElement(const SceneMember& member, const Element& element,
                           const MemberClass& its_class) {
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
  std::shared_ptr<StaticClasses> static_classes_;
  std::vector<SceneMember> members_;
  std::vector<std::uint32_t> class_of_;  // by member
  std::vector<MemberClass> classes_;
};

SceneCache::SceneCache() : maker_(std::make_unique<ElementMaker>()) {}
SceneCache::~SceneCache() = default;

std::shared_ptr<const CollisionScene> CollisionScene::build(SceneDescription description,
                                                            SceneCache* cache) {
  SceneCache of_this_scene;
  const auto kept = std::make_shared<SceneDescription>(std::move(description));
  auto scene = SceneBuilder(*kept).build(cache ? *cache : of_this_scene);
  kept->settings.progress = nullptr;  // may refer to what ends with this call
  for (RigidObject& object : kept->objects) {
    scene->objects_.push_back(std::make_shared<const RigidObject>(std::move(object)));
  }
  kept->objects.clear();
  std::sort(scene->objects_.begin(), scene->objects_.end(),
            [](const auto& a, const auto& b) { return a->name < b->name; });
  scene->description_ = kept;
  return scene;
}

std::set<std::string> CollisionScene::neededModels(const SceneDescription& description) {
  return SceneBuilder(description).neededNames();
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
  std::set<std::string> sentences;
  for (const SceneElement& element : elements_) {
    const auto& prepared = element.rung(Fidelity::MESH).shape;
    const double share = prepared ? prepared->missingShare() : 0.0;
    if (!(share > TOLD_ABOVE)) continue;
    char percent[16];
    std::snprintf(percent, sizeof percent, "%.0f %%", 100.0 * share);
    sentences.insert("'" + models_[element.model].name + "': about " + percent +
                     " of the surface of mesh " + std::get<Mesh>(element.shape).mesh->name +
                     " is missing: a body wholly inside it is not found");
  }
  return {sentences.begin(), sentences.end()};
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
