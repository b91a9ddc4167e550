#include "collision_pairs/sweep_and_prune.h"

#include <algorithm>
#include <numeric>
#include <stdexcept>

namespace collision_pairs {
namespace {

// The axis on which the boxes' centres vary most. Two passes: the textbook E[x^2] - E[x]^2
// cancels far from the origin.
int axisOfGreatestVariance(const std::vector<Aabb>& boxes) {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const Aabb& box : boxes) mean += box.center() / static_cast<double>(boxes.size());
  Eigen::Vector3d variance = Eigen::Vector3d::Zero();
  for (const Aabb& box : boxes) variance += (box.center() - mean).cwiseAbs2();
  int axis = 0;
  variance.maxCoeff(&axis);
  return axis;
}

}  // namespace

StaticBoxes::StaticBoxes(std::vector<Aabb> boxes, std::vector<std::uint32_t> models)
    : boxes_(std::move(boxes)), models_(std::move(models)) {
  for (std::size_t i = 0; i < boxes_.size(); ++i) {
    if (!boxes_[i].valid()) {
      throw std::invalid_argument("static box " + std::to_string(i) + " is inverted or not finite");
    }
  }
}

void SweepAndPrune::begin(double alarm_distance, const StaticBoxes* static_boxes,
                          const PairFilter* filter) {
  alarm_distance_ = alarm_distance;
  static_boxes_ = static_boxes;
  filter_ = filter;
  boxes_.clear();
  models_.clear();
  pairs_.clear();
  refused_.clear();
  if (static_boxes == nullptr) return;
  for (std::uint32_t i = 0; i < static_boxes->size(); ++i)
    add(static_boxes->box(i), static_boxes->model(i));
}

std::uint32_t SweepAndPrune::add(const Aabb& box, std::uint32_t model) {
  const auto id = static_cast<std::uint32_t>(boxes_.size());
  boxes_.push_back(box);
  models_.push_back(model);
  if (!box.valid()) refused_.push_back(id);
  return id;
}

const std::vector<BoxPair>& SweepAndPrune::end() {
  order_.clear();
  for (std::uint32_t i = 0; i < boxes_.size(); ++i) {
    if (boxes_[i].valid()) order_.push_back(i);
  }
  axis_ = axisOfGreatestVariance(boxes_);
  std::sort(order_.begin(), order_.end(), [&](std::uint32_t a, std::uint32_t b) {
    return boxes_[a].min[axis_] < boxes_[b].min[axis_];
  });
  const std::uint32_t nb_static = static_boxes_ ? static_boxes_->size() : 0;
  const double squared_alarm = alarm_distance_ * alarm_distance_;
  for (std::size_t i = 0; i < order_.size(); ++i) {
    const std::uint32_t a = order_[i];
    for (std::size_t j = i + 1; j < order_.size(); ++j) {
      const std::uint32_t b = order_[j];
      if (boxes_[b].min[axis_] - boxes_[a].max[axis_] > alarm_distance_) break;
      if (a < nb_static && b < nb_static) continue;
      if (models_[a] == models_[b]) continue;
      if (filter_ && !filter_->allowed(models_[a], models_[b])) continue;
      if (squaredGap(boxes_[a], boxes_[b]) <= squared_alarm) {
        pairs_.push_back({std::min(a, b), std::max(a, b)});
      }
    }
  }
  std::sort(pairs_.begin(), pairs_.end());
  return pairs_;
}

}  // namespace collision_pairs
