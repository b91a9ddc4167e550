#include <algorithm>
#include <cmath>

#include "anytime_query.h"
#include "check_input.h"
#include "collision_pairs/collision_detector.h"
#include "element_boxes.h"
#include "found_pairs.h"
#include "pair_ladder.h"

// The search for the smallest distance of all pairs.
namespace collision_pairs {

// Sweeps with a reach that grows until it includes the nearest pair: all other pairs are further
// apart than the reach. Pairs are processed in order of the gap of their boxes, so that most are
// dismissed at once.
void CollisionDetector::searchMinimum(const Deadline& deadline) {
  SmallestDistance best = found_->smallestDistance();
  Aabb moving = noBox();
  const auto& boxes = boxes_->boxes();
  for (std::size_t i = scene_->nbStaticElements(); i < boxes.size(); ++i) {
    if (boxes[i].valid()) moving = enclosing(moving, boxes[i]);
  }
  const auto sizeOf = [](const Aabb& box) {  // a half-space's is not finite
    return box.valid() ? std::min((box.max - box.min).norm(), MAX_REACH) : 0.0;
  };
  const double extent =
      moving.valid() ? sizeOf(enclosing(moving, scene_->staticBoxes().bounds())) : 0.0;
  // A floor, or a distant box, must not make the first reach include everything.
  const double first_reach = std::min(extent / 64.0, sizeOf(moving));
  double known = settings_.alarm_distance;  // all pairs nearer are known; clouds come last
  double measured = -1.0;  // pairs whose boxes are no further apart than this are done
  bool in_time = true;
  for (double reach = std::max({2.0 * known, first_reach, 1e-300});
       best.metres > known && known < extent;
       reach = std::min({4.0 * reach, best.metres, MAX_REACH})) {
    in_time = !deadline.spent();
    if (!in_time) break;
    sweep(reach, reached_);
    in_time = measureNearestFirst(reached_, measured, deadline, best, known);
    if (!in_time) break;
    known = measured = reach;
  }
  if (in_time) in_time = measureCloudsBeyond(deadline, best);
  if (!in_time && !scene_->clouds().empty()) known = settings_.alarm_distance;
  report_.budget_spent |= !in_time;
  if (!in_time && known < best.metres) best = {known, true};
  report_.min_distance = best.metres;
  report_.min_distance_is_bound = best.is_bound;
}

bool CollisionDetector::measureNearestFirst(const std::vector<BoxPair>& pairs, double measured,
                                            const Deadline& deadline, SmallestDistance& best,
                                            double& known) {
  const auto& boxes = boxes_->boxes();
  by_gap_.clear();
  for (const BoxPair& pair : pairs) {
    const double gap = squaredGap(boxes[pair.first], boxes[pair.second]);
    if (measured < 0.0 || gap > measured * measured) by_gap_.emplace_back(gap, pair);
  }
  std::sort(by_gap_.begin(), by_gap_.end());
  for (const auto& [squared_gap, candidate] : by_gap_) {
    const double squared_best = std::max(best.metres, 0.0) * best.metres;
    if (squared_gap > squared_best) break;
    if (deadline.spent()) {
      known = std::max(known, std::sqrt(squared_gap));
      return false;
    }
    if (!boxes_->inReach(candidate, squared_best)) continue;  // by their tight boxes
    if (isIgnored(candidate)) continue;
    const BoxPair pair = ladder_->byModel(candidate);
    PairDistance found =
        ladder_->refine(pair, settings_.fidelity, best.metres, settings_.tolerance).found;
    endAtBoxes(pair, found);
    if (found.certainty == Certainty::BEYOND) continue;
    if (best.offer(found.distance, found.certainty)) report_.nearest = contactOf(pair, found);
  }
  return true;
}

}  // namespace collision_pairs
