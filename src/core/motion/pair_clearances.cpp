#include "pair_clearances.h"

#include <algorithm>

#include "check_input.h"
#include "collision_pairs/input_error.h"
#include "ignored_pairs.h"
#include "unknown_because.h"

namespace collision_pairs {
namespace {

void requireNotNegative(const std::string& what, double value, const std::string& unit) {
  if (value >= 0.0 && value <= MAX_REACH) return;
  throw InputError("the " + what + " is " + std::to_string(value) + ", but must be 0 or more " +
                   unit + ", and finite");
}

void requireInRange(const MotionSettings& settings) {
  requireNotNegative("clearance", settings.clearance, "metres");
  requireNotNegative("time budget", settings.time_budget, "seconds");
  if (!(settings.resolution > 0.0 && settings.resolution <= MAX_REACH)) {
    throw InputError("the resolution is " + std::to_string(settings.resolution) +
                     ", but must be more than 0 metres, and finite");
  }
}

}  // namespace

void PairClearances::begin(const MotionSettings& settings) {
  requireInRange(settings);
  settings_ = &settings;
  keeps_some_ = false;
}

double PairClearances::of(std::uint32_t model_a, std::uint32_t model_b) {
  const auto [first, second] = std::minmax(model_a, model_b);
  const double most = settings_->clearance;
  const double clearance = settings_->clearance_of ? settings_->clearance_of(first, second) : most;
  keeps_some_ = keeps_some_ || clearance >= 0.0;
  if (clearance <= most) return clearance;
  throw InputError("clearance_of says " + std::to_string(clearance) + " m of " +
                   pairName(scene_, first, second) +
                   ", but no pair keeps more than the clearance, " + std::to_string(most) + " m");
}

bool PairClearances::leaveOut(std::uint32_t model_a, std::uint32_t model_b) {
  if (settings_->only_moved && !state_.movesModels(model_a, model_b)) return true;
  return of(model_a, model_b) < 0.0;
}

bool PairClearances::leaveOutAll() {
  const auto isKept = [this](auto first, auto second) { return !leaveOut(first, second); };
  return mayLeaveOut() && !keeps_some_ && !hasPair(scene_, scene_.filter(), isKept);
}

}  // namespace collision_pairs
