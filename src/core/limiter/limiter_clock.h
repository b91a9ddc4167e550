// The times that the velocity limiter counts in.
#pragma once

#include <deque>
#include <limits>
#include <optional>

namespace collision_pairs {

/// Time is bounded by what was received, not by what a clock claims: a simulated clock may be late,
/// or stand still, while joint states of later times arrive. All in seconds.
class LimiterClock {
 public:
  explicit LimiterClock(bool is_simulated) : is_simulated_(is_simulated) {}

  /// The clock of stamps, that of the wall, which never jumps, and how often others have seen the
  /// former jump. Returns true if it went back since the last call: what was received before is of
  /// another time.
  bool follow(double clock, double steady, unsigned nb_jumps);
  /// Of the last call: for a time about which nobody was asked.
  unsigned nbJumps() const { return nb_jumps_; }

  /// A joint position with this stamp was received.
  void receive(double stamp);

  /// The latest that was read, but for a jump back.
  double clock() const { return clock_; }
  /// Not before any stamp that was received, if the time is simulated; else the clock.
  double latest() const;
  /// Has certainly passed, whatever happens to the clock: that of the wall, or goes on with a
  /// simulated clock; never back.
  double law() const { return law_; }
  /// No earlier than the present: latest(), and as much more as it has been behind a simulated
  /// clock that moved, at most, within the last second: what comes at 10 Hz is up to 0.1 s behind.
  double upper() const;
  /// The same, of upper(): may have passed. Never back, either: what is published is recorded at
  /// it.
  double lawLatest() const;

  /// When a position was measured, on the time of law(): that of its stamp, which a simulated clock
  /// may not have reached; else that by which it was measured.
  double lawAt(double stamp, double measured) const {
    return law_ + ((is_simulated_ ? stamp : measured) - clock_);
  }

  /// Wall time since latest() last moved, if the time is simulated; else 0.
  double standsFor(double steady) const;

 private:
  const bool is_simulated_;
  double clock_ = 0.0, law_ = 0.0;
  double law_latest_ = -std::numeric_limits<double>::infinity();  // of the last call
  double newest_ = -std::numeric_limits<double>::infinity();      // stamp
  unsigned nb_jumps_ = 0;
  double last_latest_ = 0.0;  // of the last call
  struct Lag {
    double steady, seconds;
  };
  std::deque<Lag> lags_;             // of the last second, each followed by smaller ones only
  std::optional<double> last_step_;  // when it moved, by the wall
};

}  // namespace collision_pairs
