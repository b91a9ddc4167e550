#include "collision_pairs/pair_selection.h"

#include <map>

#include "collision_pairs/input_error.h"
#include "scene_classes.h"
#include "user_text.h"

namespace collision_pairs {
namespace {

void requireNames(const CollisionScene& scene, const std::vector<NamePattern>& names) {
  for (const NamePattern& name : names) {
    if (isPattern(name) || scene.findModel(name) >= 0 || scene.robot().findLink(name) >= 0) {
      continue;
    }
    throw InputError("the selection names '" + name + "', which is not in the scene" +
                     didYouMean(name, namesOf(scene.models())));
  }
}

std::vector<char> restrictedModels(const CollisionScene& scene, const Restriction& restriction) {
  requireNames(scene, restriction.names);
  const RestrictedNames restricted(scene.description().robots, restriction);
  const auto& links = scene.robot().links();
  std::vector<char> is_in;
  for (const CollisionModel& model : scene.models()) {
    const bool attached = model.attached_link >= 0;
    const std::string& link = attached ? links[model.attached_link].name : std::string();
    is_in.push_back(restricted.have(model.name, link));
  }
  return is_in;
}

}  // namespace

PairSelection::PairSelection(std::shared_ptr<const CollisionScene> scene,
                             const Restriction& restriction, Among among)
    : scene_(std::move(scene)) {
  const auto& models = scene_->models();
  const PairFilter& allowed = scene_->filter();
  std::vector<char> is_in(models.size(), 1);
  if (!restriction.empty()) is_in = restrictedModels(*scene_, restriction);

  // Static models of one class may part ways.
  std::map<std::pair<std::uint32_t, char>, std::uint32_t> ids;
  std::vector<std::uint32_t> classes, examples;
  for (std::uint32_t m = 0; m < models.size(); ++m) {
    const auto next = static_cast<std::uint32_t>(examples.size());
    const auto [its_class, is_new] = ids.try_emplace({allowed.classOf(m), is_in[m]}, next);
    if (is_new) examples.push_back(m);
    classes.push_back(its_class->second);
  }
  filter_ = PairFilter(std::move(classes));
  uses_class_.assign(examples.size(), 0);
  for (std::uint32_t a = 0; a < examples.size(); ++a) {
    for (std::uint32_t b = a; b < examples.size(); ++b) {
      const std::uint32_t first = examples[a], second = examples[b];
      const bool both_move = models[first].body >= 0 && models[second].body >= 0;
      const bool selected =
          allowed.classPairAllowed(allowed.classOf(first), allowed.classOf(second)) &&
          (is_in[first] || is_in[second]) &&
          (among == Among::ALL || both_move == (among == Among::SELF));
      filter_.setClassPair(a, b, selected);
      if (!selected) continue;
      uses_class_[a] = uses_class_[b] = 1;
      is_empty_ = false;
    }
  }
}

}  // namespace collision_pairs
