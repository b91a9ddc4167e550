#include "open_pairs.h"

namespace collision_pairs {

OpenPairs::OpenPairs(std::shared_ptr<const CollisionScene> scene, Fidelity fidelity,
                     const SolidPairs& solids)
    : scene_(std::move(scene)),
      fidelity_(fidelity),
      solids_(solids),
      X_WE_(scene_->elements().size()),
      boxes_(scene_->elements().size()),
      placed_(scene_->elements().size(), 0) {
  for (std::uint32_t i = 0; i < scene_->nbStaticElements(); ++i) {
    X_WE_[i] = scene_->elements()[i].X_BE;
    boxes_[i] = scene_->staticBoxes().box(i);
  }
}

OpenPairs::Outcome OpenPairs::check(const std::vector<Eigen::Isometry3d>& X_RB,
                                    const std::vector<BoxPair>& pairs,
                                    const std::vector<std::uint32_t>& beside_static) {
  ++state_;
  is_doubtful_ = false;
  open_.clear();
  ladder_.begin(*scene_, X_WE_, boxes_);
  for (const BoxPair& pair : pairs) {
    if (!place(pair.first, X_RB) || !place(pair.second, X_RB)) return Outcome::NOT_SETTLED;
    if (squaredGap(boxes_[pair.first], boxes_[pair.second]) > squaredReach(0.0)) continue;
    const SolidPairs::Outcome outcome =
        solids_.settle(pair, X_WE_[pair.first].inverse(Eigen::Isometry) * X_WE_[pair.second]);
    if (outcome == SolidPairs::Outcome::CONTACT) {
      contact_ = ladder_.byModel(pair);
      return Outcome::CONTACT;
    }
    // Spheres of Fidelity::SPHERES may meet where the elements do not.
    const bool is_free = outcome == SolidPairs::Outcome::FREE && fidelity_ == Fidelity::MESH;
    if (!is_free) open_.push_back(pair);
  }
  for (const BoxPair& pair : open_) {
    if (touches(pair)) return Outcome::CONTACT;
  }
  if (!beside_static.empty()) {
    sweep_.begin(0.0, &scene_->staticBoxes(), &scene_->filter());
    for (const std::uint32_t element : beside_static) {
      if (!place(element, X_RB)) return Outcome::NOT_SETTLED;
      sweep_.add(boxes_[element], scene_->elements()[element].model);
    }
    const std::uint32_t nb_static = scene_->nbStaticElements();
    for (const BoxPair& boxes : sweep_.end()) {
      if (boxes.first >= nb_static) continue;  // both move: settled, or among the pairs
      if (touches({boxes.first, beside_static[boxes.second - nb_static]})) return Outcome::CONTACT;
    }
  }
  return is_doubtful_ ? Outcome::NOT_SETTLED : Outcome::FREE;
}

bool OpenPairs::place(std::uint32_t id, const std::vector<Eigen::Isometry3d>& X_RB) {
  if (placed_[id] == state_) return true;
  placed_[id] = state_;
  const SceneElement& element = scene_->elements()[id];
  X_WE_[id] = X_RB[scene_->bodies()[element.body].body] * element.X_BE;
  boxes_[id] = element.boxAt(X_WE_[id]);
  return boxes_[id].valid();
}

bool OpenPairs::touches(const BoxPair& pair) {
  contact_ = ladder_.byModel(pair);
  const PairDistance found = ladder_.touches(contact_, fidelity_).found;
  is_doubtful_ |= found.certainty == Certainty::DEGRADED;
  return found.certainty == Certainty::BOUND;
}

}  // namespace collision_pairs
