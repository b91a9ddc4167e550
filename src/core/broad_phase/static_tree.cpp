#include "static_tree.h"

#include <algorithm>
#include <limits>
#include <stdexcept>
#include <string>

#include "collision_pairs/sweep_and_prune.h"

namespace collision_pairs {
namespace {

constexpr std::size_t FEW_CHANGES = 16;  // at any number of boxes

int widestAxis(const Record* begin, const Record* end) {
  float low[3], high[3];
  std::fill(low, low + 3, std::numeric_limits<float>::infinity());
  std::fill(high, high + 3, -std::numeric_limits<float>::infinity());
  for (const Record* r = begin; r != end; ++r) {
    for (int k = 0; k < 3; ++k) {
      const float center = 0.5f * r->lo[k] + 0.5f * r->hi[k];
      low[k] = std::min(low[k], center);
      high[k] = std::max(high[k], center);
    }
  }
  int widest = 0;
  for (int k = 1; k < 3; ++k) {
    if (high[k] - low[k] > high[widest] - low[widest]) widest = k;
  }
  return widest;
}

struct AlongAxis {
  int k;
  float center(const Record& r) const { return 0.5f * r.lo[k] + 0.5f * r.hi[k]; }
  bool operator()(const Record& a, const Record& b) const { return center(a) < center(b); }
};

void orderAsTree(Record* begin, Record* end) {
  const std::ptrdiff_t size = end - begin;
  if (size <= static_cast<std::ptrdiff_t>(FAN_OUT)) return;
  std::ptrdiff_t half = FAN_OUT;
  while (2 * half < size) half *= 2;
  std::nth_element(begin, begin + half, end, AlongAxis{widestAxis(begin, end)});
  orderAsTree(begin, begin + half);
  orderAsTree(begin + half, end);
}

// The boxes that enclose each 16 of the given ones.
std::vector<Record> enclose(const std::vector<Record>& boxes) {
  std::vector<Record> nodes;
  for (std::size_t i = 0; i < boxes.size(); i += FAN_OUT) {
    Record node = boxes[i];
    for (std::size_t j = i; j < std::min<std::size_t>(i + FAN_OUT, boxes.size()); ++j) {
      for (int k = 0; k < 3; ++k) {
        node.lo[k] = std::min(node.lo[k], boxes[j].lo[k]);
        node.hi[k] = std::max(node.hi[k], boxes[j].hi[k]);
      }
    }
    nodes.push_back(node);
  }
  return nodes;
}

PackedStorage pack(const std::vector<Record>& records) {
  PackedStorage packed;
  packed.resize(records.size());
  for (std::size_t i = 0; i < records.size(); ++i) packed.writer()(i, records[i]);
  return packed;
}

}  // namespace

StaticTree::StaticTree(std::vector<Aabb> boxes, std::vector<std::uint32_t> models,
                       const std::vector<std::uint32_t>& order)
    : boxes_(std::move(boxes)), models_(std::move(models)), origin_(sceneOrigin(boxes_)) {
  std::vector<Record> records(boxes_.size());
  narrowBoxes(*sweepKernels().front(), makeNarrowMap(origin_, 0.0), boxes_, models_.data(),
              records.data());
  if (order.empty()) {
    orderAsTree(records.data(), records.data() + records.size());
  } else {
    std::vector<Record> ordered;
    ordered.reserve(records.size());
    for (const std::uint32_t id : order) ordered.push_back(records[id]);
    records.swap(ordered);
  }
  levels_.push_back(pack(records));
  while (records.size() > FAN_OUT) {
    records = enclose(records);
    levels_.push_back(pack(records));
  }
}

TreeView StaticTree::view() const {
  TreeView view;
  view.nb_boxes = static_cast<std::uint32_t>(boxes_.size());
  for (const PackedStorage& level : levels_) view.level[view.nb_levels++] = level.view();
  return view;
}

StaticBoxes::StaticBoxes(std::vector<Aabb> boxes, std::vector<std::uint32_t> models) {
  build(std::move(boxes), std::move(models), {});
}

StaticBoxes::StaticBoxes(std::vector<Aabb> boxes, std::vector<std::uint32_t> models,
                         const StaticBoxes& before, const std::vector<std::uint32_t>& new_ids) {
  std::vector<std::uint32_t> order;
  std::vector<char> is_known(boxes.size(), 0);
  order.reserve(boxes.size());
  for (std::size_t i = 0; i < before.nb_boxes_; ++i) {
    const std::uint32_t id = new_ids[before.tree_->order()[i]];
    if (id == GONE) continue;
    order.push_back(id);
    is_known[id] = 1;
  }
  const std::size_t nb_kept = order.size();
  for (std::uint32_t id = 0; id < boxes.size(); ++id) {
    if (!is_known[id]) order.push_back(id);
  }
  nb_changed_ = before.nb_changed_ + (boxes.size() - nb_kept) + (before.nb_boxes_ - nb_kept);
  if (nb_changed_ > FEW_CHANGES + boxes.size() / FAN_OUT) {
    nb_changed_ = 0;
    order.clear();
  }
  build(std::move(boxes), std::move(models), order);
}

void StaticBoxes::build(std::vector<Aabb> boxes, std::vector<std::uint32_t> models,
                        const std::vector<std::uint32_t>& order) {
  nb_boxes_ = boxes.size();
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
  tree_ = std::make_shared<const StaticTree>(std::move(boxes), std::move(models), order);
}

const Aabb& StaticBoxes::box(std::uint32_t id) const { return tree_->box(id); }
std::uint32_t StaticBoxes::model(std::uint32_t id) const { return tree_->model(id); }

}  // namespace collision_pairs
