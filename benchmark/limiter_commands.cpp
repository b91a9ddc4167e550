#include "limiter_commands.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

namespace collision_pairs {
namespace {

constexpr double AIM_EVERY = 0.05;  // s between aims of a command that presses

}  // namespace

LimiterScene::Commands::Commands(const LimiterScene& scene, RandomInputs& random,
                                 CertifiedSurroundings& probe)
    : scene_(scene), random_(random), probe_(probe), base_(scene.joints_.size(), 0.0) {}

std::vector<double> LimiterScene::Commands::at(double now, const std::vector<double>& q) {
  if (scene_.options_.commands) return scene_.options_.commands(now, q);
  if (now >= until_) choose(now);
  if (kind_ == Kind::PRESS) press(now, q);
  const double most = scene_.options_.max_speed;
  std::vector<double> command = base_;
  for (std::size_t i = 0; i < command.size(); ++i) {
    if (kind_ == Kind::SINUSOID) command[i] *= std::sin(frequency_ * now + static_cast<double>(i));
    if (kind_ == Kind::GOAL) command[i] = 2.0 * (goal_[i] - q[i]);
    // Not far beyond the limits of the joint.
    if (q[i] < scene_.lower_[i]) command[i] = std::abs(command[i]);
    if (q[i] > scene_.upper_[i]) command[i] = -std::abs(command[i]);
  }
  double largest = 0.0;
  for (const double x : command) largest = std::max(largest, std::abs(x));
  if (largest > most) {
    for (double& x : command) x *= most / largest;
  }
  return command;
}

void LimiterScene::Commands::press(double now, const std::vector<double>& q) {
  if (now < aimed_ + AIM_EVERY) return;
  aimed_ = now;
  base_ = scene_.towardsNearest(q, presses_itself_, probe_);
  for (double& x : base_) x *= press_speed_;
}

void LimiterScene::Commands::choose(double now) {
  if (scene_.options_.press_share > 0.0 && random_.uniform(0, 1) < scene_.options_.press_share) {
    kind_ = Kind::PRESS;
    presses_itself_ = random_.integer(0, 3) == 0;
    press_speed_ = random_.uniform(0.05, 1.0);
    aimed_ = -1.0;
    until_ = now + random_.uniform(0.5, 3.0);
    return;
  }
  const double draw = random_.uniform(0, 1);
  kind_ = draw < 0.3    ? Kind::JUMP
          : draw < 0.5  ? Kind::REVERSAL
          : draw < 0.65 ? Kind::SINUSOID
          : draw < 0.9  ? Kind::GOAL
          : draw < 0.94 ? Kind::REST
                        : Kind::SILENCE;
  until_ = now + random_.uniform(0.1, kind_ == Kind::GOAL ? 3.0 : 1.0);
  frequency_ = random_.uniform(2.0, 20.0);
  goal_ = scene_.drawState(random_);
  const double speed = scene_.options_.max_speed * random_.uniform(0.1, 1.0);
  for (double& x : base_) {
    if (kind_ == Kind::REVERSAL) {
      x = -x;
    } else {
      x = kind_ == Kind::REST || random_.integer(0, 2) == 0 ? 0.0 : random_.uniform(-speed, speed);
    }
  }
}

std::vector<double> LimiterScene::towardsNearest(const std::vector<double>& q, bool any,
                                                 CertifiedSurroundings& probe) const {
  RobotState state;
  state.positions = allPositions(q);
  probe.setState(std::move(state));
  std::vector<double> towards(q.size(), 0.0), unit(q.size(), 0.0);
  std::vector<NearPair> pairs;
  std::string why;
  for (const double reach : {0.05, 0.5}) {
    double nearest = std::numeric_limits<double>::infinity(), squares = 0.0;
    NearPair of;
    for (std::size_t j = 0; j < q.size(); ++j) {
      unit[j] = 1.0;
      probe.nearPairs(reach, unit, pairs, why);
      unit[j] = 0.0;
      for (const NearPair& pair : pairs) {
        if ((pair.is_robot && !any) || pair.distance > nearest) continue;
        if (pair.first != of.first || pair.second != of.second) {
          towards.assign(q.size(), 0.0);
          squares = 0.0;
        }
        of = pair;
        nearest = pair.distance;
        if (!std::isfinite(pair.derivative)) continue;
        towards[j] = -pair.derivative;
        squares += pair.derivative * pair.derivative;
      }
    }
    for (double& x : towards) x = squares > 1e-6 ? x / squares : 0.0;
    if (squares > 1e-6) break;
  }
  return towards;
}

}  // namespace collision_pairs
