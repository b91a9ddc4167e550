#include "response_watch.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "turns.h"
#include "user_text.h"

namespace collision_pairs {
namespace {

constexpr double LONGEST_GAP = 1.0;    // s between compared states: commands are kept as long
constexpr double REST = 1.0;           // s without fault or command, after which commands pass
constexpr double LATELY = 0.5;         // s of which the words speak
constexpr double STAMP_ERROR = 0.005;  // s by which stamps may err, either way
constexpr double SPEED_ERROR = 0.02;   // share of its speed by which a joint may miss it

RobotResponse responseOf(const LimiterSettings& settings) {
  return {settings.reaction_time, settings.command_timeout, settings.deceleration};
}

}  // namespace

ResponseWatch::ResponseWatch(std::vector<std::string> joints, const LimiterSettings& settings,
                             bool may_stand)
    : joints_(std::move(joints)),
      may_stand_(may_stand),
      hold_(settings.command_timeout),
      tolerance_(settings.tracking_tolerance),
      passed_(responseOf(settings)),
      predicted_(joints_.size()),
      last_published_(-std::numeric_limits<double>::infinity()) {}

void ResponseWatch::published(double begun, double now, const std::vector<double>& command) {
  const double zeros_due = last_published_ + hold_;  // somebody else may have sent them: the guard
  if (begun > zeros_due) passed_.add(now, std::vector<double>(joints_.size(), 0.0), zeros_due);
  passed_.add(now, command, begun);
  last_published_ = begun;
}

void ResponseWatch::clear() { predicted_.assign(joints_.size(), std::nullopt); }

void ResponseWatch::measured(const Position& position, double now) {
  if (!std::isfinite(position.value)) return;
  std::optional<Predicted>& predicted = predicted_[position.joint];
  const bool is_first = !predicted || now - predicted->stamp > LONGEST_GAP;
  if (!is_first && !(position.stamp > predicted->stamp)) return;
  const double early = std::max(0.0, now - position.stamp);
  const double from = is_first ? position.stamp - 1e-3 : predicted->stamp;
  const PassedCommands::Way way =
      passed_.way(position.joint, from, position.stamp, early, may_stand_);
  const double half = 0.5 * tolerance_ + STAMP_ERROR * way.fastest;
  const Predicted alone{position.stamp, position.value - half, position.value + half};
  if (is_first) {
    predicted = alone;
    return;
  }
  const double missed = SPEED_ERROR * way.fastest * (position.stamp - predicted->stamp);
  double low = predicted->low + way.low - missed, high = predicted->high + way.high + missed;
  const double turns = wholeTurns(position.value - 0.5 * (low + high));
  low = std::max(low + turns, alone.low);
  high = std::min(high + turns, alone.high);
  if (low <= high) {
    predicted = Predicted{position.stamp, low, high};
    return;
  }
  // Of the two ends one is the position's own, less or more half the tolerance.
  const double off = (low > alone.low ? -1.0 : 1.0) * (low - high + 2.0 * half);
  fault_time_ = now;
  if (fault_.empty()) fault_ = wordsOf(position, off);
  predicted = alone;
}

std::string ResponseWatch::wordsOf(const Position& position, double off) const {
  const auto lately = [&](std::size_t joint) {
    return passed_.way(joint, position.stamp - LATELY, position.stamp, 0.0, false);
  };
  const PassedCommands::Way way = lately(position.joint);
  bool others_move = false;
  for (std::size_t joint = 0; joint < joints_.size(); ++joint) {
    others_move = others_move || (joint != position.joint && lately(joint).fastest > 0.0);
  }
  std::string words = "joint '" + joints_[position.joint] + "' is " +
                      formatted("%.3f", std::abs(off)) + " (rad or m) off what was passed: ";
  if (way.fastest == 0.0) {
    words +=
        "it moves without a command; does gravity or somebody push it, or another program "
        "command it?";
  } else if (off > 0.0 ? way.high > 0.0 : way.low < 0.0) {
    words += "it goes further; is deceleration too high, or reaction_time too short?";
  } else {
    words += "it does not follow; is its drive on, is it at a limit, is reaction_time too short?";
  }
  if (others_move) words += " Are joints in the order of the command?";
  return words + " Let commands rest for a second to go on";
}

void ResponseWatch::asked(double now) {
  if (!fault(now).empty()) fault_time_ = std::max(fault_time_, now);
}

std::string ResponseWatch::fault(double now) {
  if (now - fault_time_ > REST) fault_.clear();
  return fault_;
}

}  // namespace collision_pairs
