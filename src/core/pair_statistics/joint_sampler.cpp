#include "joint_sampler.h"

#include <algorithm>
#include <cmath>
#include <iterator>

namespace collision_pairs {
namespace {

constexpr double PI = 3.14159265358979323846;

std::uint64_t mixed(std::uint64_t z) {
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
  return z ^ (z >> 31);
}

/// Limits of 1e16 are those of a joint that has none: no number of states would show what is near.
bool isLimited(const Joint& joint) {
  constexpr double LONGEST = 1000.0, MOST_TURNED = 1e6;  // m, rad
  const double most = joint.type == JointType::PRISMATIC ? LONGEST : MOST_TURNED;
  return joint.hasLimits() && (joint.lower != 0.0 || joint.upper != 0.0) &&
         joint.upper - joint.lower <= most;
}

bool turnsEndlessly(const Joint& joint) {
  return joint.hasPosition() && joint.type != JointType::PRISMATIC && !isLimited(joint);
}

JointSampler::Range rangeOf(const Joint& joint) {
  if (!joint.hasPosition() || joint.mimic) return {};
  if (isLimited(joint)) return {joint.lower, joint.upper};
  if (turnsEndlessly(joint)) return {-PI, PI};
  return {};
}

}  // namespace

RandomStream::RandomStream(std::uint64_t seed, std::uint64_t index)
    : state_(mixed(mixed(seed) + index)) {}

double RandomStream::uniform() {
  state_ += 0x9e3779b97f4a7c15u;
  return static_cast<double>(mixed(state_) >> 11) * 0x1p-53;
}

JointSampler::JointSampler(std::shared_ptr<const RobotModel> robot, std::uint64_t seed)
    : robot_(std::move(robot)), seed_(seed) {
  for (const Joint& joint : robot_->joints()) ranges_.push_back(rangeOf(joint));
}

void JointSampler::draw(std::uint64_t index, std::vector<double>& positions) const {
  RandomStream random = stream(index);
  positions.assign(ranges_.size(), 0.0);
  for (std::size_t i = 0; i < ranges_.size(); ++i) {
    const bool moves = ranges_[i].lower < ranges_[i].upper;
    positions[i] = moves ? ranges_[i].at(random.uniform()) : ranges_[i].lower;
  }
  robot_->applyMimics(positions);
}

template <class Take>
void JointSampler::visitJoints(int body_a, int body_b, const Take& take) const {
  robot_->visitBetween(body_a, body_b, [&](int body, bool) {
    int joint = robot_->bodies()[body].joint;
    if (joint < 0) return;  // a root
    double ratio = 1.0;
    const bool slides = robot_->joints()[joint].type == JointType::PRISMATIC;
    while (robot_->joints()[joint].mimic) {
      ratio *= robot_->joints()[joint].mimic->multiplier;
      joint = robot_->joints()[joint].mimic->joint;
    }
    const bool is_whole = slides ? ratio == 0.0 : ratio == std::round(ratio);
    take(joint, is_whole);
  });
}

bool JointSampler::stands(int joint) const {
  const bool moves = robot_->joints()[joint].type != JointType::FIXED;
  const bool has_range = ranges_[joint].lower != 0.0 || ranges_[joint].upper != 0.0;
  return moves && !robot_->joints()[joint].mimic && !has_range;
}

std::vector<int> JointSampler::jointsBetween(int body_a, int body_b) const {
  std::set<int> moving;
  visitJoints(body_a, body_b, [&](int joint, bool) {
    if (ranges_[joint].lower < ranges_[joint].upper) moving.insert(joint);
  });
  return {moving.begin(), moving.end()};
}

std::set<std::string> JointSampler::drawnInPartBetween(int body_a, int body_b) const {
  std::set<std::string> names;
  visitJoints(body_a, body_b, [&](int joint, bool is_whole) {
    const bool is_one_turn = turnsEndlessly(robot_->joints()[joint]);
    if (stands(joint) || (is_one_turn && !is_whole)) names.insert(robot_->joints()[joint].name);
  });
  return names;
}

std::vector<std::string> JointSampler::standingJoints() const {
  std::vector<std::string> names;
  for (std::size_t i = 0; i < ranges_.size(); ++i) {
    if (stands(static_cast<int>(i))) names.push_back(robot_->joints()[i].name);
  }
  return names;
}

}  // namespace collision_pairs
