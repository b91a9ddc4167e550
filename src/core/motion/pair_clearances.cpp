#include "pair_clearances.h"

#include <algorithm>
#include <cmath>

#include "collision_pairs/input_error.h"
#include "ignored_pairs.h"

namespace collision_pairs {

void PairClearances::begin(const MotionSettings& settings) {
  nearer_ = &settings.nearer;
  left_out_.clear();
  const std::size_t nb_models = scene_.models().size();
  for (const PairClearance& pair : *nearer_) {
    if (!std::isfinite(pair.clearance) || pair.first >= nb_models || pair.second >= nb_models) {
      throw InputError("nearer: models " + std::to_string(pair.first) + " and " +
                       std::to_string(pair.second) + " keep " + std::to_string(pair.clearance) +
                       " m; they must be two of the scene's " + std::to_string(nb_models) +
                       " models, and the distance finite");
    }
    if (pair.clearance < 0.0) left_out_.push_back(std::minmax(pair.first, pair.second));
  }
  std::sort(left_out_.begin(), left_out_.end());
}

double PairClearances::of(const BoxPair& pair, double clearance) const {
  const auto& elements = scene_.elements();
  const auto models = std::minmax(elements[pair.first].model, elements[pair.second].model);
  for (const PairClearance& known : *nearer_) {
    if (std::minmax(known.first, known.second) != models) continue;
    clearance = std::min(clearance, known.clearance);
  }
  return clearance;
}

bool PairClearances::leavesOut(std::uint32_t first, std::uint32_t second) const {
  return std::binary_search(left_out_.begin(), left_out_.end(), std::make_pair(first, second));
}

bool PairClearances::leavesOutAll() const {
  return leavesOutSome() && !allowsMoreThan(left_out_, scene_, scene_.filter());
}

}  // namespace collision_pairs
