// Limiters for the simulation.
#pragma once

#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "limiter_simulation.h"
#include "response_watch.h"

namespace collision_pairs {

/// Our law, for one run.
Limiter lawLimiter(std::shared_ptr<LimiterLaw> law,
                   std::shared_ptr<CertifiedSurroundings> surroundings);

/// The law with the node's rules: a decision is made for 20 ms from now, is published when it is
/// there, and recorded then; in place of one that takes longer, or for a robot of which the watch
/// says a fault, zeros. For one run.
class NodeLimiter {
 public:
  /// Without `obeys` faults of the watch are counted only; with `overruns` one decision in 300
  /// does.
  NodeLimiter(const LimiterScene& scene, RandomInputs& random, bool obeys, bool overruns = true);

  Passed operator()(const LimiterView& view);
  /// A joint state arrived. True if zeros have to be passed at once.
  bool measured(double now, double stamp, const std::vector<double>& positions);

  int nbFaults() const { return nb_faults_; }
  double firstFault() const { return first_fault_; }   ///< s
  const std::string& fault() const { return fault_; }  ///< the first, in words
  /// Of the last command that did not pass whole.
  const std::string& reason() const { return reason_; }

 private:
  RandomInputs& random_;
  const bool obeys_, overruns_;
  LimiterLaw law_;
  ResponseWatch watch_;
  CertifiedSurroundings surroundings_;
  int nb_faults_ = 0;
  double first_fault_ = std::numeric_limits<double>::infinity();
  std::string fault_, reason_;
};

/// MoveIt Servo's (moveit_servo/src/collision_check.cpp): from the nearest distance at the joint
/// state of the cycle, with its default thresholds.
Limiter servoLimiter(std::shared_ptr<CertifiedSurroundings> surroundings);

}  // namespace collision_pairs
