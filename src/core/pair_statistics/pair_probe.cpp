#include "pair_probe.h"

#include <algorithm>
#include <set>

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
      boxes_(scene_->elements().size()) {
  scene_->robot().forwardKinematics(scene_->robot().zeroPositions(), X_RB_);  // the roots stay
  ladder_.begin(*scene_, X_WE_, boxes_);
}

void PairProbe::place(const std::vector<double>& positions) {
  scene_->robot().forwardKinematics(positions, X_RB_);
  for (std::size_t i = 0; i < boxes_.size(); ++i) placeElement(i);
}

void PairProbe::placePair(std::uint32_t first, std::uint32_t second,
                          const std::vector<double>& positions) {
  const std::pair<std::uint32_t, std::uint32_t> pair(first, second);
  if (pair != pair_) {
    chain_ = movingBodiesAbove(first, second);
    pair_ = pair;
  }
  const RobotModel& robot = scene_->robot();
  for (const int i : chain_) {
    const Body& body = robot.bodies()[i];
    robot.placeBody(i, X_RB_[body.parent], positions[body.joint], X_RB_[i]);
  }
  for (const std::uint32_t model : {first, second}) {
    const CollisionModel& placed = scene_->models()[model];
    for (std::uint32_t i = 0; i < placed.nb_elements; ++i) placeElement(placed.first_element + i);
  }
}

void PairProbe::placeElement(std::size_t i) {
  const SceneElement& element = scene_->elements()[i];
  X_WE_[i] =
      element.body < 0 ? element.X_BE : X_RB_[scene_->bodies()[element.body].body] * element.X_BE;
  boxes_[i] = element.boxAt(X_WE_[i]);
  if (boxes_[i].valid()) return;
  throw InputError("link " + whyNoBox(scene_->models()[element.model].name));
}

/// Ascending: a parent is before its children.
std::vector<int> PairProbe::movingBodiesAbove(std::uint32_t first, std::uint32_t second) const {
  const auto& bodies = scene_->robot().bodies();
  std::set<int> above;
  for (const std::uint32_t model : {first, second}) {
    int i = scene_->robotBody(scene_->models()[model]);
    for (; i >= 0 && bodies[i].joint >= 0; i = bodies[i].parent) above.insert(i);
  }
  return {above.begin(), above.end()};
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
    const PairDistance found = ladder_.refine(pair, Fidelity::MESH, limit).found;
    if (found.certainty != Certainty::BEYOND) limit = std::clamp(found.distance, 0.0, limit);
    return limit == 0.0;
  });
  return limit;
}

}  // namespace collision_pairs
