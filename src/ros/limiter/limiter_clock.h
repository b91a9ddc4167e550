// The times that the velocity limiter counts in.
#pragma once

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
  bool follow(double clock, double steady) { return follow(clock, steady, nb_jumps_); }

  /// A joint position with this stamp was received.
  void receive(double stamp);

  /// The latest that was read, but for a jump back.
  double clock() const { return clock_; }
  /// Not before any stamp that was received, if the time is simulated; else the clock.
  double latest() const;
  /// Has certainly passed, whatever happens to the clock: that of the wall, or goes on with a
  /// simulated clock; never back.
  double law() const { return law_; }
  /// The same, of latest(): may have passed.
  double lawLatest() const { return law_ + (latest() - clock_); }

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
  double newest_ = -std::numeric_limits<double>::infinity();  // stamp
  unsigned nb_jumps_ = 0;
  double last_latest_ = 0.0;         // of the last call
  std::optional<double> last_step_;  // when it moved, by the wall
};

}  // namespace collision_pairs
