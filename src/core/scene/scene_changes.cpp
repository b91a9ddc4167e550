#include <algorithm>
#include <cmath>
#include <map>
#include <stdexcept>

#include "collision_pairs/collision_scene.h"
#include "collision_pairs/input_error.h"
#include "scene_element.h"
#include "scene_members.h"
#include "static_classes.h"
#include "user_text.h"

// Scenes that change by difference.
namespace collision_pairs {
namespace {

using ObjectPtr = std::shared_ptr<const RigidObject>;
using Objects = std::vector<ObjectPtr>;
using Edits = std::map<std::string, ObjectPtr>;  // null: removed

ObjectPtr findObject(const Objects& objects, const std::string& name) {
  const auto found =
      std::lower_bound(objects.begin(), objects.end(), name,
                       [](const ObjectPtr& object, const std::string& n) { return object->name < n; });
  return found != objects.end() && (*found)->name == name ? *found : nullptr;
}

Edits editsOf(const SceneChanges& changes, const Objects& objects) {
  Edits edits;
  for (const std::string& name : changes.removed) {
    if (!findObject(objects, name)) {
      std::vector<std::string> names;
      for (const ObjectPtr& object : objects) names.push_back(object->name);
      throw InputError("there is no object '" + name + "' to remove" +
                       (names.empty() ? "; the scene has none"
                                      : "; did you mean '" + nearestName(name, names) + "'?"));
    }
    edits[name] = nullptr;
  }
  for (const RigidObject& object : changes.objects) {
    edits[object.name] = std::make_shared<const RigidObject>(object);
  }
  return edits;
}

/// Calls keep(begin, end) for ranges of the sorted list that no edit concerns, and take(object) for
/// each object of an edit, in the order of names.
template <class NameOf, class Keep, class Take>
void merge(std::size_t size, const NameOf& name_of, const Edits& edits, const Keep& keep,
           const Take& take) {
  std::size_t next = 0;
  for (const auto& [name, object] : edits) {
    std::size_t end = next, beyond = size;  // the first whose name is not less
    while (end < beyond) {
      const std::size_t middle = end + (beyond - end) / 2;
      name_of(middle) < name ? end = middle + 1 : beyond = middle;
    }
    if (next < end) keep(next, end);
    next = end + (end < size && name_of(end) == name);
    if (object) take(object);
  }
  if (next < size) keep(next, size);
}

Objects merged(const Objects& objects, const Edits& edits) {
  Objects all;
  all.reserve(objects.size() + edits.size());
  const auto at = [&](std::size_t i) { return objects.begin() + static_cast<std::ptrdiff_t>(i); };
  merge(
      objects.size(), [&](std::size_t i) -> const std::string& { return objects[i]->name; }, edits,
      [&](std::size_t begin, std::size_t end) { all.insert(all.end(), at(begin), at(end)); },
      [&](const ObjectPtr& object) { all.push_back(object); });
  return all;
}

}  // namespace

/// Makes a scene from another one whose static objects are treated as those of the new one.
class SceneEditor {
 public:
  SceneEditor(const CollisionScene& before, const Edits& edits)
      : before_(before), edits_(edits), classes_(*before.static_classes_) {}

  /// Null if it would take a build.
  std::shared_ptr<const CollisionScene> run(SceneCache& cache) {
    for (const auto& [name, object] : edits_) {
      if (!isAlike(name, object.get())) return nullptr;
    }
    try {
      prepare(*cache.maker_);
    } catch (const std::invalid_argument&) {
      return nullptr;  // build() says which
    }
    std::shared_ptr<CollisionScene> made(new CollisionScene(shared()));
    after_ = made.get();
    mergeModels();
    if (!hasAllClasses() || !addBoxes()) return nullptr;
    after_->objects_ = merged(before_.objects_, edits_);
    return made;
  }

 private:
  struct NewObject {
    StaticClasses::Class its_class;
    std::vector<SceneElement> elements;  ///< without model
  };

  bool isAlike(const std::string& name, const RigidObject* object) {
    const ObjectPtr known = findObject(before_.objects_, name);
    if (known && !known->attached_link.empty()) return false;
    if (!known && isTaken(name)) return false;
    if (!object) return classes_.named.count(name) == 0;
    const auto isKnown = [&](const std::string& link) {
      return classes_.named.count(link) > 0 || before_.robot_->findLink(link) >= 0;
    };
    const bool is_sound = !name.empty() && !object->elements.empty() && object->padding >= 0.0 &&
                          std::isfinite(object->padding);
    if (!is_sound || !object->attached_link.empty() ||
        !std::all_of(object->touch_links.begin(), object->touch_links.end(), isKnown)) {
      return false;
    }
    const SceneMember member = staticMember(*object, before_.description_->settings);
    const auto its_class = classes_.by_signature.find(classes_.signature.of(member));
    if (its_class == classes_.by_signature.end()) return false;
    if (its_class->second.is_needed) new_[object].its_class = its_class->second;
    return true;
  }

  bool isTaken(const std::string& name) const {
    const SceneDescription& description = *before_.description_;
    const auto isNamedSo = [&](const RigidObject& cloud) { return cloud.name == name; };
    return before_.robot_->findLink(name) >= 0 ||
           (description.world && description.world->findLink(name) >= 0) ||
           std::any_of(description.clouds.begin(), description.clouds.end(), isNamedSo);
  }

  void prepare(ElementMaker& maker) {
    std::vector<std::pair<const Shape*, Fidelity>> wanted;
    for (const auto& [object, made] : new_) {
      for (const Element& element : object->elements) {
        wanted.emplace_back(&element.shape, made.its_class.needed_fidelity);
      }
    }
    const SceneSettings& settings = before_.description_->settings;
    const PreparedElements prepared = maker.prepare(wanted, settings);
    for (auto& [object, made] : new_) {
      const SceneMember member = staticMember(*object, settings);
      for (const Element& element : object->elements) {
        made.elements.push_back(
            prepared.make(element.shape, made.its_class.needed_fidelity));
        setPlace(member, element, made.its_class.half_padding, made.elements.back());
      }
    }
  }

  /// What no edit changes.
  CollisionScene shared() const {
    CollisionScene scene;
    scene.description_ = before_.description_;
    scene.static_classes_ = before_.static_classes_;
    scene.robot_ = before_.robot_;
    scene.bodies_ = before_.bodies_;
    scene.unchecked_ = before_.unchecked_;
    scene.narrow_phase_ = before_.narrow_phase_;
    scene.pair_padding_ = before_.pair_padding_;
    return scene;
  }

  void mergeModels() {
    const auto& models = before_.models_;
    after_->models_.reserve(models.size() + new_.size());
    after_->elements_.reserve(before_.elements_.size() + new_.size());
    new_id_.reserve(models.size());
    class_of_.reserve(models.size() + new_.size());
    new_box_.assign(before_.nbStaticElements(), StaticBoxes::GONE);
    boxes_.reserve(before_.nbStaticElements() + new_.size());
    merge(
        models.size(), [&](std::size_t i) -> const std::string& { return models[i].name; }, edits_,
        [&](std::size_t begin, std::size_t end) {
          new_id_.resize(begin, 0);  // those before are gone
          for (std::size_t i = begin; i < end; ++i) keepModel(static_cast<std::uint32_t>(i));
        },
        [&](const ObjectPtr& object) { addModel(*object); });
    addMovingElements();
    after_->filter_ = before_.filter_;
    after_->filter_.setModels(class_of_);
  }

  std::uint32_t nbElements() const { return static_cast<std::uint32_t>(after_->elements_.size()); }

  void keepModel(std::uint32_t before) {
    const auto id = static_cast<std::uint32_t>(after_->models_.size());
    after_->models_.push_back(before_.models_[before]);
    class_of_.push_back(before_.filter_.classOf(before));
    new_id_.push_back(id);
    CollisionModel& model = after_->models_.back();
    const std::uint32_t first = model.first_element;
    if (first >= before_.nbStaticElements()) return;
    model.first_element = nbElements();
    for (std::uint32_t e = first; e < first + model.nb_elements; ++e) {
      new_box_[e] = nbElements();
      boxes_.push_back(before_.static_boxes_.box(e));
      after_->elements_.push_back(before_.elements_[e]);
      after_->elements_.back().model = id;
    }
  }

  void addModel(const RigidObject& object) {
    const auto found = new_.find(&object);
    if (found == new_.end()) return;  // in no allowed pair
    const auto id = static_cast<std::uint32_t>(after_->models_.size());
    const auto nb_elements = static_cast<std::uint32_t>(object.elements.size());
    after_->models_.push_back({object.name, -1, nbElements(), nb_elements, true});
    class_of_.push_back(found->second.its_class.id);
    for (const SceneElement& element : found->second.elements) {
      boxes_.push_back(element.boxAt(element.X_BE));
      after_->elements_.push_back(element);
      after_->elements_.back().model = id;
      after_->elements_.back().body = -1;
    }
  }

  void addMovingElements() {
    const std::uint32_t nb_static = before_.nbStaticElements();
    const std::uint32_t shift = nbElements() - nb_static;  // modulo 2^32
    for (std::size_t e = nb_static; e < before_.elements_.size(); ++e) {
      const std::uint32_t model_before = before_.elements_[e].model;
      const std::uint32_t model = new_id_[model_before];
      after_->elements_.push_back(before_.elements_[e]);
      after_->elements_.back().model = model;
      after_->models_[model].first_element = before_.models_[model_before].first_element + shift;
    }
    for (const SceneCloud& cloud : before_.clouds_) {
      after_->clouds_.push_back({new_id_[cloud.model], cloud.element + shift, cloud.voxel_size});
    }
  }

  /// A class without a member may have been the last that needs a link.
  bool hasAllClasses() const {
    const std::size_t nb_classes = before_.filter_.nbClasses();
    std::vector<char> has(nb_classes, 0), had(nb_classes, 0);
    for (const std::uint32_t c : class_of_) has[c] = 1;
    for (std::uint32_t m = 0; m < before_.models_.size(); ++m) had[before_.filter_.classOf(m)] = 1;
    return has == had;
  }

  /// False if one is not finite.
  bool addBoxes() {
    const auto isNone = [](const Aabb& box) { return !box.valid(); };
    if (std::any_of(boxes_.begin(), boxes_.end(), isNone)) return false;
    std::vector<std::uint32_t> models;
    models.reserve(boxes_.size());
    for (std::size_t e = 0; e < boxes_.size(); ++e) models.push_back(after_->elements_[e].model);
    after_->static_boxes_ =
        StaticBoxes(std::move(boxes_), std::move(models), before_.static_boxes_, new_box_);
    return true;
  }

  const CollisionScene& before_;
  const Edits& edits_;
  const StaticClasses& classes_;
  std::map<const RigidObject*, NewObject> new_;  // those in an allowed pair
  CollisionScene* after_ = nullptr;
  std::vector<std::uint32_t> class_of_;
  std::vector<std::uint32_t> new_id_;   // by model of the scene before
  std::vector<std::uint32_t> new_box_;  // by static element of the scene before
  std::vector<Aabb> boxes_;
};

std::shared_ptr<const CollisionScene> CollisionScene::withAlike(const SceneChanges& changes,
                                                                SceneCache* cache) const {
  SceneCache of_this_scene;
  return SceneEditor(*this, editsOf(changes, objects_)).run(cache ? *cache : of_this_scene);
}

std::shared_ptr<const CollisionScene> CollisionScene::with(const SceneChanges& changes,
                                                           SceneCache* cache) const {
  if (auto alike = withAlike(changes, cache)) return alike;
  SceneDescription description = *description_;
  for (const ObjectPtr& object : merged(objects_, editsOf(changes, objects_))) {
    description.objects.push_back(*object);
  }
  return build(std::move(description), cache);
}

}  // namespace collision_pairs
