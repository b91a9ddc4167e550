#include "open_pairs.h"

namespace collision_pairs {

OpenPairs::OpenPairs(std::shared_ptr<const CollisionScene> scene, Fidelity fidelity,
                     const SolidPairs& solids)
    : scene_(std::move(scene)),
      fidelity_(fidelity),
      solids_(solids),
      X_WB_(scene_->robot().bodies().size()),
      placed_bodies_(X_WB_.size(), 0),
      X_WE_(scene_->elements().size()),
      boxes_(scene_->elements().size()),
      placed_(scene_->elements().size(), 0) {
  for (std::uint32_t i = 0; i < scene_->nbStaticElements(); ++i) {
    X_WE_[i] = scene_->elements()[i].X_BE;
    boxes_[i] = scene_->staticBoxes().box(i);
  }
}

OpenPairs::Outcome OpenPairs::check(const std::vector<double>& positions,
                                    const std::vector<BoxPair>& pairs,
                                    const std::vector<std::uint32_t>& beside_static) {
  ++state_;
  is_uncertain_ = false;
  open_.clear();
  ladder_.begin(*scene_, X_WE_, boxes_);
  for (const BoxPair& pair : pairs) {
    if (!place(pair.first, positions) || !place(pair.second, positions))
      return Outcome::NOT_SETTLED;
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
      if (!place(element, positions)) return Outcome::NOT_SETTLED;
      sweep_.add(boxes_[element], scene_->elements()[element].model);
    }
    const std::uint32_t nb_static = scene_->nbStaticElements();
    for (const BoxPair& boxes : sweep_.end()) {
      if (boxes.first >= nb_static) continue;  // both move: settled, or among the pairs
      if (touches({boxes.first, beside_static[boxes.second - nb_static]})) return Outcome::CONTACT;
    }
  }
  return is_uncertain_ ? Outcome::NOT_SETTLED : Outcome::FREE;
}

bool OpenPairs::place(std::uint32_t id, const std::vector<double>& positions) {
  if (placed_[id] == state_) return true;
  placed_[id] = state_;
  const SceneElement& element = scene_->elements()[id];
  X_WE_[id] = placeBody(scene_->bodies()[element.body].body, positions) * element.X_BE;
  boxes_[id] = element.boxAt(X_WE_[id]);
  return boxes_[id].valid();
}

const Eigen::Isometry3d& OpenPairs::placeBody(int id, const std::vector<double>& positions) {
  Eigen::Isometry3d& X_WB = X_WB_[static_cast<std::size_t>(id)];
  if (placed_bodies_[static_cast<std::size_t>(id)] == state_) return X_WB;
  placed_bodies_[static_cast<std::size_t>(id)] = state_;
  const RobotModel& robot = scene_->robot();
  const Body& body = robot.bodies()[id];
  if (body.joint < 0) return X_WB = body.X_PJ;
  const Eigen::Isometry3d& X_WP = placeBody(body.parent, positions);
  robot.placeBody(id, X_WP, positions[static_cast<std::size_t>(body.joint)], X_WB);
  return X_WB;
}

bool OpenPairs::touches(const BoxPair& pair) {
  contact_ = ladder_.byModel(pair);
  const PairDistance found = ladder_.touches(contact_, fidelity_).found;
  is_uncertain_ |= found.certainty == Certainty::DEGRADED;
  return found.certainty == Certainty::BOUND;
}

}  // namespace collision_pairs
