#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <stdexcept>

#include "collision_pairs/collision_scene.h"
#include "collision_pairs/input_error.h"
#include "pair_policy.h"
#include "scene_element.h"
#include "scene_members.h"
#include "user_text.h"

// Scenes that change by difference.
namespace collision_pairs {
namespace {

using Edits = std::map<std::string, ObjectPtr>;  // null: removed

ObjectPtr findObject(const Objects& objects, const std::string& name) {
  const auto found = std::lower_bound(
      objects.begin(), objects.end(), name,
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
                       (names.empty() ? "; the scene has none" : didYouMean(name, names)));
    }
    edits[name] = nullptr;
  }
  for (const RigidObject& object : changes.objects) {
    ObjectPtr& edit = edits[object.name];
    if (edit) throw InputError("object '" + object.name + "' is given twice");
    edit = std::make_shared<const RigidObject>(object);
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

/// Makes a scene from another one whose members are treated as those of the new one.
class SceneEditor {
 public:
  SceneEditor(const CollisionScene& before, const Edits& edits)
      : before_(before), edits_(edits), classes_(before.classes_) {}

  /// Null if it would take a build.
  std::shared_ptr<const CollisionScene> run(SceneCache& cache) {
    for (const auto& [name, object] : edits_) {
      if (!isAlike(name, object)) return nullptr;
    }
    std::shared_ptr<CollisionScene> made(new CollisionScene(shared()));
    after_ = made.get();
    if (!changeClasses()) return nullptr;
    try {
      prepare(*cache.maker_);
    } catch (const std::invalid_argument&) {
      return nullptr;  // build() says which
    }
    mergeModels();
    const bool may_be_unchecked = after_->models_.empty() != before_.models_.empty();
    if (may_be_unchecked || !hasAllClasses() || !addBoxes()) return nullptr;
    after_->objects_ = merged(before_.objects_, edits_);
    return made;
  }

 private:
  struct NewObject {
    SceneMember member;
    std::uint32_t its_class;             ///< of the new scene, once changeClasses() is done
    std::vector<SceneElement> elements;  ///< without model
  };

  bool isAlike(const std::string& name, const ObjectPtr& object) {
    const ObjectPtr known = findObject(before_.objects_, name);
    if (!known && isTaken(name)) return false;
    const bool is_named = classes_->rules->named.count(name) > 0;
    // What moves is a class of its own, which other members must not know by its name.
    const auto mayMove = [&](const RigidObject& moving) {
      const auto isLink = [&](const std::string& link) {
        return before_.robot_->findLink(link) >= 0;
      };
      return !is_named && isLink(moving.attached_link) &&
             std::all_of(moving.touch_links.begin(), moving.touch_links.end(), isLink);
    };
    if (known && !known->attached_link.empty()) {
      if (!mayMove(*known)) return false;
      no_longer_moving_.insert(known.get());
    }
    if (!object) return !is_named;
    const auto isKnown = [&](const std::string& link) {
      return classes_->rules->named.count(link) > 0 || before_.robot_->findLink(link) >= 0;
    };
    const bool is_sound = !name.empty() && !object->elements.empty() && object->padding >= 0.0 &&
                          std::isfinite(object->padding) && hasItsMeshes(*object);
    if (!is_sound || !areRotations(*object) ||
        !std::all_of(object->touch_links.begin(), object->touch_links.end(), isKnown)) {
      return false;
    }
    if (!object->attached_link.empty() && !mayMove(*object)) return false;
    SceneMember member = objectMember(object, before_.description_->settings, *before_.robot_);
    std::uint32_t its_class = NONE;
    if (member.isStatic()) {
      const auto found = classes_->of_static.find(classes_->rules->signature.of(member));
      if (found == classes_->of_static.end()) return false;
      its_class = found->second;
    }
    new_.emplace(object.get(), NewObject{std::move(member), its_class, {}});
    return true;
  }

  /// A class for each object that moves now. False if other members then have other needs.
  bool changeClasses() {
    const auto isNewMover = [](const auto& entry) { return !entry.second.member.isStatic(); };
    const auto& known = classes_->all;
    new_class_.resize(known.size());
    for (std::uint32_t c = 0; c < known.size(); ++c) new_class_[c] = c;
    if (no_longer_moving_.empty() && std::none_of(new_.begin(), new_.end(), isNewMover))
      return true;

    const auto changed = std::make_shared<SceneClasses>();
    changed->rules = classes_->rules;
    for (std::uint32_t c = 0; c < known.size(); ++c) {
      const bool is_gone = no_longer_moving_.count(known[c].example.object.get()) > 0;
      new_class_[c] = is_gone ? NONE : static_cast<std::uint32_t>(changed->all.size());
      if (!is_gone) changed->all.push_back(known[c]);
    }
    for (const auto& [signature, c] : classes_->of_static) {
      changed->of_static.emplace(signature, new_class_[c]);
    }
    for (auto& [object, made] : new_) {
      made.its_class = made.member.isStatic() ? new_class_[made.its_class]
                                              : static_cast<std::uint32_t>(changed->all.size());
      if (!made.member.isStatic()) changed->all.push_back({made.member});
    }
    PairPolicy policy = PairPolicy::of(*before_.description_, *changed);
    for (std::uint32_t c = 0; c < known.size(); ++c) {
      if (new_class_[c] != NONE && !known[c].hasNeedsOf(changed->all[new_class_[c]])) return false;
    }
    classes_ = after_->classes_ = changed;
    after_->filter_ = std::move(policy.filter);
    after_->pair_padding_ = std::move(policy.paddings);
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
    for (auto made = new_.begin(); made != new_.end();) {
      const SceneClasses::Class& its_class = classes_->all[made->second.its_class];
      if (!its_class.is_needed) {
        made = new_.erase(made);
        continue;
      }
      for (const Element& element : *made->second.member.elements) {
        wanted.emplace_back(&element.shape, its_class.needed_fidelity);
      }
      ++made;
    }
    const PreparedElements prepared = maker.prepare(wanted, before_.description_->settings);
    for (auto& [object, made] : new_) {
      const SceneClasses::Class& its_class = classes_->all[made.its_class];
      for (const Element& element : *made.member.elements) {
        made.elements.push_back(prepared.make(element.shape, its_class.needed_fidelity));
        setPlace(made.member, element, its_class.half_padding, made.elements.back());
      }
    }
  }

  /// What edits of static objects do not change.
  CollisionScene shared() const {
    CollisionScene scene;
    scene.description_ = before_.description_;
    scene.classes_ = before_.classes_;
    scene.robot_ = before_.robot_;
    scene.filter_ = before_.filter_;
    scene.unchecked_ = before_.unchecked_;
    scene.missing_ = before_.missing_;
    scene.narrow_phase_ = before_.narrow_phase_;
    scene.pair_padding_ = before_.pair_padding_;
    return scene;
  }

  void mergeModels() {
    const auto& models = before_.models_;
    after_->models_.reserve(models.size() + new_.size());
    after_->elements_.reserve(before_.elements_.size() + new_.size());
    class_of_.reserve(models.size() + new_.size());
    new_box_.assign(before_.nbStaticElements(), StaticBoxes::GONE);
    boxes_.reserve(before_.nbStaticElements() + new_.size());
    merge(
        models.size(), [&](std::size_t i) -> const std::string& { return models[i].name; }, edits_,
        [&](std::size_t begin, std::size_t end) {
          for (std::size_t i = begin; i < end; ++i) keepModel(static_cast<std::uint32_t>(i));
        },
        [&](const ObjectPtr& object) { addModel(*object); });
    addMovingElements();
    addClouds();
    after_->filter_.setModels(class_of_);
  }

  std::uint32_t nbElements() const { return static_cast<std::uint32_t>(after_->elements_.size()); }

  void keepModel(std::uint32_t before) {
    const auto id = static_cast<std::uint32_t>(after_->models_.size());
    after_->models_.push_back(before_.models_[before]);
    class_of_.push_back(new_class_[before_.filter_.classOf(before)]);
    CollisionModel& model = after_->models_.back();
    const std::uint32_t first = model.first_element;
    if (first >= before_.nbStaticElements()) {
      const SceneElement* const elements = &before_.elements_[first];
      if (model.body < 0) {
        clouds_.push_back({id, elements, -1});
      } else {
        movers_.push_back(
            {id, elements, before_.bodies_[static_cast<std::size_t>(model.body)].body});
      }
      return;
    }
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
    const NewObject& made = found->second;
    const auto id = static_cast<std::uint32_t>(after_->models_.size());
    const auto nb_elements = static_cast<std::uint32_t>(made.elements.size());
    const int attached_link = before_.robot_->findLink(object.attached_link);
    after_->models_.push_back({object.name, -1, nbElements(), nb_elements, true, attached_link});
    class_of_.push_back(made.its_class);
    if (!made.member.isStatic()) {
      movers_.push_back({id, made.elements.data(), made.member.body});
      return;
    }
    for (const SceneElement& element : made.elements) {
      boxes_.push_back(element.boxAt(element.X_BE));
      addElement(element, id, -1);
    }
  }

  void addElement(const SceneElement& element, std::uint32_t model, int body) {
    after_->elements_.push_back(element);
    after_->elements_.back().model = model;
    after_->elements_.back().body = body;
  }

  /// In the order of their models, as build() has them; so have bodies().
  void addMovingElements() {
    std::vector<int> scene_body(before_.robot_->bodies().size(), -1);  // by body of the robot
    for (const Mover& mover : movers_) {
      CollisionModel& model = after_->models_[mover.model];
      int& body = scene_body[static_cast<std::size_t>(mover.body)];
      if (body < 0) {
        body = static_cast<int>(after_->bodies_.size());
        const Body& of_robot = before_.robot_->bodies()[static_cast<std::size_t>(mover.body)];
        const Link& link = before_.robot_->links()[static_cast<std::size_t>(of_robot.link)];
        after_->bodies_.push_back({mover.body, link.name});
      }
      model.body = body;
      model.first_element = nbElements();
      for (std::uint32_t i = 0; i < model.nb_elements; ++i) {
        addElement(mover.elements[i], mover.model, body);
      }
    }
  }

  void addClouds() {
    for (const Mover& cloud : clouds_) {
      after_->models_[cloud.model].first_element = nbElements();
      const auto voxel_size = before_.clouds_[after_->clouds_.size()].voxel_size;
      after_->clouds_.push_back({cloud.model, nbElements(), voxel_size});
      addElement(*cloud.elements, cloud.model, -1);
    }
  }

  /// A class without a member may have been the last that needs a link.
  bool hasAllClasses() const {
    const std::size_t nb_classes = classes_->all.size();
    std::vector<char> has(nb_classes, 0);
    for (const std::uint32_t c : class_of_) has[c] = 1;
    for (std::uint32_t m = 0; m < before_.models_.size(); ++m) {
      const std::uint32_t c = new_class_[before_.filter_.classOf(m)];
      if (c != NONE && !has[c]) return false;
    }
    return true;
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

  static constexpr std::uint32_t NONE = 0xffffffff;
  /// A model of the new scene whose elements are not static; `body` is one of the robot's.
  struct Mover {
    std::uint32_t model;
    const SceneElement* elements;
    int body;
  };

  const CollisionScene& before_;
  const Edits& edits_;
  std::shared_ptr<const SceneClasses> classes_;
  std::map<const RigidObject*, NewObject> new_;  // those in an allowed pair, once prepared
  std::set<const RigidObject*> no_longer_moving_;
  CollisionScene* after_ = nullptr;
  std::vector<std::uint32_t> new_class_;  // by class before; NONE: it is gone
  std::vector<std::uint32_t> class_of_;
  std::vector<std::uint32_t> new_box_;  // by static element of the scene before
  std::vector<Aabb> boxes_;
  std::vector<Mover> movers_, clouds_;  // by model
};

std::shared_ptr<const CollisionScene> CollisionScene::withAlike(const SceneChanges& changes,
                                                                SceneCache* cache) const {
  SceneCache of_this_scene;
  return SceneEditor(*this, editsOf(changes, objects_)).run(cache ? *cache : of_this_scene);
}

std::shared_ptr<const CollisionScene> CollisionScene::with(const SceneChanges& changes,
                                                           SceneCache* cache) const {
  if (auto alike = withAlike(changes, cache)) return alike;
  return buildOf(description_, merged(objects_, editsOf(changes, objects_)), cache, this);
}

}  // namespace collision_pairs
