// What a robot of LimiterScene is told to do.
#pragma once

#include <vector>

#include "limiter_simulation.h"

namespace collision_pairs {

/// Jumps, reversals, sinusoids, ways to random states, rests, and if asked, presses.
class LimiterScene::Commands {
 public:
  Commands(const LimiterScene& scene, RandomInputs& random, CertifiedSurroundings& probe);
  std::vector<double> at(double now, const std::vector<double>& q);
  bool isSilent() const { return kind_ == Kind::SILENCE; }

 private:
  enum class Kind { JUMP, REVERSAL, SINUSOID, GOAL, REST, SILENCE, PRESS };
  void choose(double now);
  void press(double now, const std::vector<double>& q);

  const LimiterScene& scene_;
  RandomInputs& random_;
  CertifiedSurroundings& probe_;
  Kind kind_ = Kind::REST;
  bool presses_itself_ = false;
  double press_speed_ = 0.0, aimed_ = 0.0;  // m/s; s
  double until_ = 0.0, frequency_ = 1.0;
  std::vector<double> base_, goal_;
};

}  // namespace collision_pairs
