// Notices that a robot does not do what the velocity limiter assumes of it.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "limiter_law.h"

namespace collision_pairs {

/// Compares joint states with what the commands that were published can have made of the robot by
/// RobotResponse: for each joint an interval in which its position has to be is carried from state
/// to state (a set-membership observer: Milanese and Vicino, Automatica 27(6), 1991). It grows by
/// what the joint can have moved and is cut by what is measured; empty, the position is outside of
/// the prediction from some earlier one by more than the tolerance. So a state is compared with all
/// before it, at the cost of one: O(commands of the last second x milliseconds since the last).
/// All times are seconds of one clock that does not jump.
class ResponseWatch {
 public:
  /// Of a robot that `may_stand`, or be slower, whatever was published, only what goes further or
  /// moves without a command is noticed: a trajectory controller is on its way to positions.
  ResponseWatch(std::vector<std::string> joints, const LimiterSettings& settings, bool may_stand);

  /// Sending a command began at `begun` and had ended `now`.
  void published(double begun, double now, const std::vector<double>& command);

  struct Position {
    std::size_t joint = 0;  ///< of the command
    double stamp = 0.0;     ///< when it was measured; no later than it arrived
    double value = 0.0;     ///< rad or m; one that is not finite is not compared
  };
  /// A position arrived `now`. One that is not newer than the last of its joint is not compared.
  void measured(const Position& position, double now);
  /// What was measured before is of another time.
  void clear();

  /// Somebody asks for a command that moves.
  void asked(double now);
  /// Why nothing may pass: what was outside of the prediction, first. Empty when nothing was, and
  /// no command that moves was asked for, during the last second: whoever commands has then
  /// noticed.
  std::string fault(double now);

 private:
  struct Predicted {
    double stamp = 0.0, low = 0.0, high = 0.0;
  };
  std::string wordsOf(const Position& position, double off) const;

  const std::vector<std::string> joints_;
  const bool may_stand_;
  const double hold_, tolerance_;
  PassedCommands passed_;
  std::vector<std::optional<Predicted>> predicted_;  // by joint
  double last_published_;
  std::string fault_;
  double fault_time_ = 0.0;  // the last time that something was outside, or asked for
};

}  // namespace collision_pairs
