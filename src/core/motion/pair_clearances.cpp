#include "pair_clearances.h"

#include <algorithm>
#include <cmath>

#include "collision_pairs/input_error.h"
#include "ignored_pairs.h"

namespace collision_pairs {
namespace {

void requireNotNegative(const std::string& what, double value, const std::string& unit) {
  if (value >= 0.0 && std::isfinite(value)) return;
  throw InputError("the " + what + " is " + std::to_string(value) + ", but must be 0 or more " +
                   unit + ", and finite");
}

void requireInRange(const MotionSettings& settings) {
  requireNotNegative("clearance", settings.clearance, "metres");
  requireNotNegative("clearance between links", settings.between_links.value_or(0.0), "metres");
  requireNotNegative("clearance beside objects", settings.beside_objects, "metres");
  requireNotNegative("time budget", settings.time_budget, "seconds");
  if (!(settings.resolution > 0.0) || !std::isfinite(settings.resolution)) {
    throw InputError("the resolution is " + std::to_string(settings.resolution) +
                     ", but must be more than 0 metres, and finite");
  }
}

}  // namespace

void PairClearances::begin(const MotionSettings& settings, const PlacedBodies& placed) {
  requireInRange(settings);
  settings_ = &settings;
  left_out_.clear();
  const std::size_t nb_models = scene_.models().size();
  carriers_.clear();
  if (settings.between_links) {
    for (std::uint32_t model = 0; model < nb_models; ++model) {
      carriers_.push_back(scene_.carrierOf(model, placed));
    }
  }
  for (const PairClearance& pair : settings.nearer) {
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

double PairClearances::of(const BoxPair& pair, bool is_beside) const {
  const auto& elements = scene_.elements();
  const auto models = std::minmax(elements[pair.first].model, elements[pair.second].model);
  double clearance = settings_->clearance + (is_beside ? settings_->beside_objects : 0.0);
  if (settings_->between_links) {
    const int carrier = carriers_[models.first];
    const bool are_links = carrier >= 0 && carrier == carriers_[models.second];
    if (are_links) clearance = *settings_->between_links;
  }
  for (const PairClearance& known : settings_->nearer) {
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
