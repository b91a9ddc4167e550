#include <stdexcept>
#include <string>

#include "collision_pairs/sweep_and_prune.h"
#include "static_tree.h"

namespace collision_pairs {

StaticBoxes::StaticBoxes(std::vector<Aabb> boxes, std::vector<std::uint32_t> models)
    : nb_boxes_(boxes.size()) {
  if (models.size() != boxes.size()) {
    throw std::invalid_argument(std::to_string(boxes.size()) + " static boxes with " +
                                std::to_string(models.size()) + " models: give one for each");
  }
  if (boxes.size() > ID_MASK) throw std::length_error("more than 2^29 static boxes");
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    if (!boxes[i].valid()) {
      throw std::invalid_argument("static box " + std::to_string(i) + " is inverted or not finite");
    }
    bounds_ = enclosing(bounds_, boxes[i]);
  }
  tree_ = std::make_shared<const StaticTree>(std::move(boxes), std::move(models));
}

const Aabb& StaticBoxes::box(std::uint32_t id) const { return tree_->box(id); }
std::uint32_t StaticBoxes::model(std::uint32_t id) const { return tree_->model(id); }

}  // namespace collision_pairs
