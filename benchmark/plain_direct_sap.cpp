#include "plain_direct_sap.h"

#include <algorithm>

namespace collision_pairs {

void PlainDirectSap::begin(double alarm_distance) {
  alarm_distance_ = alarm_distance;
  boxes_.clear();
}

void PlainDirectSap::add(const Aabb& box) { boxes_.push_back(box); }

const std::vector<BoxPair>& PlainDirectSap::end() {
  pairs_.clear();
  createEndPoints(greatestVarianceAxis());
  std::sort(order_.begin(), order_.end(), [](const EndPoint* a, const EndPoint* b) {
    return a->value != b->value ? a->value < b->value : a->box < b->box;
  });
  sweep();
  return pairs_;
}

// Over both corners of each box.
int PlainDirectSap::greatestVarianceAxis() const {
  if (boxes_.empty()) return 0;
  const double count = 2.0 * static_cast<double>(boxes_.size());
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const Aabb& box : boxes_) mean += (box.min + box.max) / count;
  Eigen::Vector3d variance = Eigen::Vector3d::Zero();
  for (const Aabb& box : boxes_) {
    variance += (box.min - mean).cwiseAbs2() + (box.max - mean).cwiseAbs2();
  }
  int axis = 0;
  variance.maxCoeff(&axis);
  return axis;
}

void PlainDirectSap::createEndPoints(int axis) {
  end_points_.clear();
  for (std::uint32_t i = 0; i < boxes_.size(); ++i) {
    end_points_.push_back({boxes_[i].min[axis] - 0.5 * alarm_distance_, i, true});
    end_points_.push_back({boxes_[i].max[axis] + 0.5 * alarm_distance_, i, false});
  }
  order_.clear();
  for (EndPoint& end_point : end_points_) order_.push_back(&end_point);
}

void PlainDirectSap::sweep() {
  active_.clear();
  for (const EndPoint* end_point : order_) {
    if (!end_point->is_begin) {
      active_.erase(std::find(active_.begin(), active_.end(), end_point->box));
      continue;
    }
    for (const std::uint32_t other : active_) {
      const double gap = squaredGap(boxes_[end_point->box], boxes_[other]);
      if (gap <= alarm_distance_ * alarm_distance_) {
        pairs_.push_back({std::min(end_point->box, other), std::max(end_point->box, other)});
      }
    }
    active_.push_back(end_point->box);
  }
}

}  // namespace collision_pairs
