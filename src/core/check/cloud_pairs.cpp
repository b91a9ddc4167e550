#include <algorithm>

#include "anytime_query.h"
#include "check_input.h"
#include "collision_pairs/collision_detector.h"
#include "element_boxes.h"
#include "found_pairs.h"
#include "ignored_pairs.h"
#include "pair_ladder.h"
#include "voxel_search.h"

// The pairs of an element and a cloud.
namespace collision_pairs {

void CollisionDetector::takeVoxels(const BodyPoses& poses) {
  const auto& clouds = scene_->clouds();
  voxels_ = poses.voxels;
  voxels_.resize(clouds.size());
  for (std::size_t i = 0; i < clouds.size(); ++i) {
    boxes_->boxes()[clouds[i].element] = noBox();
    if (voxels_[i]) report_.nb_boxes += static_cast<std::uint32_t>(voxels_[i]->size());
    if (voxels_[i] && !voxels_[i]->isTruncated()) continue;
    if (settings_.selection && !settings_.selection->uses(clouds[i].model)) continue;
    report_.left_out.push_back(clouds[i].model);
  }
  std::sort(report_.left_out.begin(), report_.left_out.end());
}

template <class Take>
void CollisionDetector::forEachCloudPair(const Take& take) const {
  const auto& elements = scene_->elements();
  const auto& boxes = boxes_->boxes();
  for (std::uint32_t i = scene_->nbStaticElements(); i < scene_->endOfMovingElements(); ++i) {
    for (std::size_t cloud = 0; cloud < voxels_.size(); ++cloud) {
      if (!voxels_[cloud] || voxels_[cloud]->isEmpty() || !boxes[i].valid()) continue;
      const BoxPair pair{i, scene_->clouds()[cloud].element};
      const bool allowed = filter().allowed(elements[i].model, elements[pair.second].model);
      if (allowed && isAsked(pair)) take(pair, *voxels_[cloud]);
    }
  }
}

void CollisionDetector::findCloudPairs() {
  cloud_pairs_.clear();
  forEachCloudPair([&](const BoxPair& pair, const OccupiedVoxels& voxels) {
    if (!voxel_search_->isWithin(pair, voxels, settings_.alarm_distance)) return;
    if (!isIgnored(pair)) cloud_pairs_.push_back(pair);
  });
}

const OccupiedVoxels& CollisionDetector::voxelsOf(const BoxPair& pair) const {
  return *voxels_[static_cast<std::size_t>(scene_->cloudOf(pair.second))];
}

void CollisionDetector::sortCloudPairs() {
  by_gap_.clear();
  for (const BoxPair& pair : cloud_pairs_) {
    const auto bound = voxel_search_->boundOfBoxes(ladder_->byModel(pair), voxelsOf(pair),
                                                   settings_.alarm_distance);
    by_gap_.emplace_back(bound.answer.found.distance, pair);
  }
  std::sort(by_gap_.begin(), by_gap_.end());
  cloud_pairs_.clear();
  for (const auto& [gap, pair] : by_gap_) cloud_pairs_.push_back(pair);
}

void CollisionDetector::measureClouds(const Deadline& deadline) {
  report_.candidates.insert(report_.candidates.end(), cloud_pairs_.begin(), cloud_pairs_.end());
  std::sort(report_.candidates.begin(), report_.candidates.end());
  if (report_.ended_early) return;
  if (deadline.isSet()) sortCloudPairs();  // the nearest first
  for (const BoxPair& candidate : cloud_pairs_) {
    const BoxPair pair = ladder_->byModel(candidate);
    const OccupiedVoxels& voxels = voxelsOf(candidate);
    const double reach = settings_.alarm_distance;
    const VoxelSearch::Found found =
        deadline.spent() ? voxel_search_->boundOfBoxes(pair, voxels, reach)
        : settings_.verdict_only
            ? voxel_search_->touches(pair, voxels, settings_.fidelity, deadline)
            : voxel_search_->nearest(pair, voxels, settings_.fidelity, reach, deadline);
    take(pair, found.answer.found, found.answer.rung, found.voxel);
    if (report_.ended_early) return;
  }
  report_.budget_spent |= report_.nb_unresolved > 0;
}

bool CollisionDetector::measureCloudsBeyond(const Deadline& deadline, SmallestDistance& best) {
  bool in_time = true;
  forEachCloudPair([&](const BoxPair& candidate, const OccupiedVoxels& voxels) {
    in_time = in_time && !deadline.spent();
    if (!in_time) return;
    if (ignored_->isAsking()) {
      const double reach = std::clamp(best.metres, 0.0, MAX_REACH);
      if (!voxel_search_->isWithin(candidate, voxels, reach) || isIgnored(candidate)) return;
    }
    const BoxPair pair = ladder_->byModel(candidate);
    const auto found =
        voxel_search_->nearest(pair, voxels, settings_.fidelity, best.metres, deadline);
    const PairDistance& distance = found.answer.found;
    in_time = distance.certainty != Certainty::UNFINISHED;
    if (distance.certainty == Certainty::BEYOND) return;
    if (best.offer(distance.distance, distance.certainty)) {
      report_.nearest = contactOf(pair, distance, found.voxel);
    }
  });
  return in_time;
}

}  // namespace collision_pairs
