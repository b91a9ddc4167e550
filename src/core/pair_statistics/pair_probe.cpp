#include "pair_probe.h"

#include <algorithm>

#include "collision_pairs/input_error.h"

namespace collision_pairs {
namespace {

/// Calls ask({element of first, element of second}) for all pairs of elements until it returns
/// true.
template <class Ask>
void forEachElementPair(const CollisionModel& first, const CollisionModel& second, Ask&& ask) {
  for (std::uint32_t i = 0; i < first.nb_elements; ++i) {
    for (std::uint32_t j = 0; j < second.nb_elements; ++j) {
      if (ask(BoxPair{first.first_element + i, second.first_element + j})) return;
    }
  }
}

}  // namespace

PairProbe::PairProbe(std::shared_ptr<const CollisionScene> scene)
    : scene_(std::move(scene)),
      X_WE_(scene_->elements().size()),
      boxes_(scene_->elements().size()) {}

void PairProbe::place(const std::vector<double>& positions) {
  scene_->robot().forwardKinematics(positions, X_RB_);
  for (std::size_t i = 0; i < boxes_.size(); ++i) {
    const SceneElement& element = scene_->elements()[i];
    X_WE_[i] =
        element.body < 0 ? element.X_BE : X_RB_[scene_->bodies()[element.body].body] * element.X_BE;
    boxes_[i] = element.boxAt(X_WE_[i]);
    if (!boxes_[i].valid()) {
      throw InputError("link " + whyNoBox(scene_->models()[element.model].name));
    }
  }
  ladder_.begin(*scene_, X_WE_, boxes_);
}

bool PairProbe::touches(std::uint32_t first, std::uint32_t second) {
  bool found = false;
  const auto& models = scene_->models();
  forEachElementPair(models[first], models[second], [&](const BoxPair& pair) {
    found = squaredGap(boxes_[pair.first], boxes_[pair.second]) <= 0.0 &&
            ladder_.touches(pair, Fidelity::MESH).found.touches();
    return found;
  });
  return found;
}

double PairProbe::distance(std::uint32_t first, std::uint32_t second, double limit) {
  const auto& models = scene_->models();
  forEachElementPair(models[first], models[second], [&](const BoxPair& pair) {
    if (squaredGap(boxes_[pair.first], boxes_[pair.second]) > limit * limit) return false;
    const PairDistance found = ladder_.climb(pair, Fidelity::MESH, limit).found;
    if (found.certainty != Certainty::BEYOND) limit = std::clamp(found.distance, 0.0, limit);
    return limit == 0.0;
  });
  return limit;
}

}  // namespace collision_pairs
