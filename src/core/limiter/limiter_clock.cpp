#include "limiter_clock.h"

#include <algorithm>

namespace collision_pairs {
namespace {

constexpr double LAG_COUNTS = 1.0;  // s of the wall
constexpr double JUMP = 0.5;        // s forward: no step of a clock that runs slowly
constexpr double SET_BACK = 0.02;   // s: less is a clock that is being set

}  // namespace

bool LimiterClock::follow(double clock, double steady, unsigned nb_jumps) {
  const bool went_back = clock < clock_ - SET_BACK || nb_jumps != nb_jumps_;
  nb_jumps_ = nb_jumps;
  if (went_back) {
    clock_ = clock;
    newest_ = -std::numeric_limits<double>::infinity();
    lags_.clear();
  }
  while (!lags_.empty() && steady - lags_.front().steady > LAG_COUNTS) lags_.pop_front();
  if (is_simulated_ && last_step_ && clock > latest() && clock - latest() < JUMP) {
    const double lag = clock - latest();
    while (!lags_.empty() && lags_.back().seconds <= lag) lags_.pop_back();
    lags_.push_back({steady, lag});
  }
  law_ = is_simulated_ ? law_ + std::max(0.0, clock - clock_) : steady;
  clock_ = std::max(clock_, clock);
  if (!last_step_ || latest() != last_latest_) last_step_ = steady;
  last_latest_ = latest();
  law_latest_ = lawLatest();
  return went_back;
}

void LimiterClock::receive(double stamp) { newest_ = std::max(newest_, stamp); }

double LimiterClock::latest() const { return is_simulated_ ? std::max(clock_, newest_) : clock_; }

double LimiterClock::upper() const {
  return latest() + (lags_.empty() ? 0.0 : lags_.front().seconds);
}

double LimiterClock::lawLatest() const { return std::max(law_latest_, law_ + (upper() - clock_)); }

double LimiterClock::standsFor(double steady) const {
  return is_simulated_ && last_step_ ? steady - *last_step_ : 0.0;
}

}  // namespace collision_pairs
