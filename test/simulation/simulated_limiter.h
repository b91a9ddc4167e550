// The velocity limiter's inputs in a simulated node, and what they may be, restated plainly.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "limiter_inputs.h"
#include "monitored_robot.h"
#include "plain_knowledge.h"

namespace simulation {

/// Limits every second joint that slides or turns; there has to be one. Joint states are of all.
class SimulatedLimiter {
 public:
  SimulatedLimiter(const Scenario& setup, const Knowledge& knowledge);

  static bool isMeasured(const SimulatedLink& link) {
    return link.joint == SimulatedLink::SLIDING || link.joint == SimulatedLink::TURNING;
  }
  void advance(Ns ros, double steady, unsigned nb_jumps);
  /// Joint states: of all joints, or of one.
  void hear(const Event& event);
  /// What a decision would be made of now: empty, or what is wrong with it.
  std::string violation(const collision_pairs::Monitor& monitor);
  /// What keeps it from deciding; empty: nothing.
  const std::string& problem() const { return problem_; }

 private:
  struct Reported {
    Ns stamp = 0;
    double measured = 0.0, value = 0.0;
  };
  void judgeTime(const collision_pairs::CommandOutlet::Time& time, double gone);
  double latest() const;
  /// What the clock may have been behind.
  double upper() const;
  std::string whySuspect() const;
  std::optional<Pose> poseOf(int link) const;

  const Scenario& setup_;
  const Knowledge& knowledge_;
  std::vector<int> measured_, joints_;  ///< links: of all joints that are measured, and limited
  collision_pairs::LimiterInputs inputs_;
  collision_pairs::LimiterInputs::Clocks clocks_;
  std::map<int, Reported> newest_;
  std::map<int, double> refused_;  ///< s, of the clock, when a stamp was too far ahead
  double clock_ = 0.0;             ///< s: the latest, but for a jump
  bool is_clock_known_ = false;
  std::vector<std::pair<double, double>> lags_;  ///< when, and by how much it was seen to be behind
  double last_latest_ = 0.0, last_step_ = 0.0;
  double law_ = 0.0, latest_law_ = 0.0;  ///< s of the law's time: has passed, and may have
  std::string wrong_time_;
  std::string problem_;
};

}  // namespace simulation
