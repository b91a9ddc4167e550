#include "exact_configuration.h"

#include "check_input.h"
#include "collision_pairs/input_error.h"
#include "pair_certifier.h"

namespace collision_pairs {
namespace {

// Most edges that planners ask for are in contact. So configurations no more than this far apart
// (rad or m of the joint that moves most) are checked before anything is certified. Halves the time
// that RRT-Connect spends on edges; with half and twice this step it is 8 and 20 % longer.
constexpr double FIRST_STEP = 0.4;
constexpr double LONGEST_SAMPLED = 100.0;  // rad or m

}  // namespace

void ExactConfiguration::begin(const MotionSettings& settings, const CloudVoxels& voxels) {
  checkVoxels(scene_, voxels);
  settings_ = &settings;
  poses_.voxels = voxels;
}

bool ExactConfiguration::meets(bool verdict_only) {
  state_.gatherPoses(poses_);
  CheckSettings exact;
  exact.alarm_distance = 0.0;
  exact.fidelity = settings_->fidelity;
  exact.verdict_only = verdict_only;
  if (clearances_.mayLeaveOut()) {
    exact.may_ignore = [this](auto first, auto second) {
      return clearances_.leaveOut(first, second);
    };
  }
  const CollisionReport& found = detector_.detect(poses_, exact);
  for (const std::uint32_t model : found.left_out) {
    if (scene_.cloudOf(scene_.models()[model].first_element) < 0) refuseBox(scene_, model);
  }
  return found.verdict == Verdict::COLLISION;
}

bool ExactConfiguration::meetsAtSteps(double& at, std::uint32_t& nb_checks) {
  const double length = state_.length();
  if (!(length <= LONGEST_SAMPLED)) return false;
  const auto meetsAt = [&](double fraction) {
    at = fraction;
    state_.moveTo(at, 0.0);
    ++nb_checks;
    return meets(true);
  };
  if (meetsAt(1.0)) return true;
  for (double part = 1.0; part == 1.0 || part * length > FIRST_STEP; part *= 0.5) {
    for (double fraction = 0.5 * part; fraction < 1.0; fraction += part) {
      if (meetsAt(fraction)) return true;
    }
  }
  return false;
}

std::vector<std::pair<std::uint32_t, std::uint32_t>> ExactConfiguration::pairs() const {
  std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs;
  for (const PairReport& pair : detector_.report().pairs) {
    if (pair.state == PairState::CONTACT) pairs.emplace_back(pair.first, pair.second);
  }
  return pairs;
}

void refuseBox(const CollisionScene& scene, std::uint32_t model) {
  throw InputError("link " + whyNoBox(scene.models()[model].name));
}

}  // namespace collision_pairs
