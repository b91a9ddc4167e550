// Where a robot can be until it stands, after the velocity commands that were passed to it.
#pragma once

#include <cstddef>
#include <deque>
#include <vector>

namespace collision_pairs {

/// What is assumed of a robot that follows velocity commands; docs/limiter.md. Per joint, rad or m.
struct RobotResponse {
  /// Seconds: a command that is passed takes effect within this time, for all joints at once.
  /// Commands keep their order.
  double reaction_time = 0.1;
  /// Seconds from the passing of a command until the next one is passed, or zeros.
  double hold = 0.2;
  /// Per second squared: each joint's velocity approaches that of the command in effect, up or
  /// down, at least at this rate, and does not overshoot.
  std::vector<double> deceleration;
};

/// A segment of displacements from the measured positions, and how far each joint may be from its
/// place on it. The robot stays within until it stands.
struct StoppingTube {
  std::vector<double> from, to, deviation;  ///< one per joint of the command
  double seconds = 0.0;                     ///< from the measurement until it stands
};

/// The commands that may still have an effect on the robot, and what it can do because of them.
/// Before the first one the robot stands. A command counts from its publication on: one that was
/// decided and not published has no effect.
///
/// Let w(t) be the command in effect and u the direction of the next one. Every command is split
/// into lambda u + r. From the measurement at t0 on the displacement is
///     u * (integral of lambda) + (integral of r) + (integral of v - w).
/// Each integral is bounded, whatever the dead times are, and whenever zeros follow the next
/// command within the hold: the first gives the segment, the other two the deviation. The bounds
/// are derived at the functions. Cost: O(commands kept x joints).
class PassedCommands {
 public:
  explicit PassedCommands(RobotResponse response);

  /// A command was published at `now`: seconds of any clock that does not jump, not before that of
  /// the last one. Sending it began at `begun`.
  void add(double now, const std::vector<double>& command, double begun);
  void add(double now, const std::vector<double>& command) { add(now, command, now); }

  /// `next`, which is to be passed `now` or before, is a multiple of `direction`, which is not
  /// zero; the positions were measured at `stamp` <= now, each joint's so many seconds `later`, >=
  /// 0 (empty: all at once).
  StoppingTube tube(double stamp, double now, const std::vector<double>& direction,
                    const std::vector<double>& next, const std::vector<double>& later = {}) const;

  /// Bounds of what a joint moved between two instants of the past, of which the first is at most a
  /// second old: rad or m. Commands may have had an effect `early`, seconds >= 0: where instants
  /// are stamps of a clock that may be late. It may also stand at any time, if `may_stand`.
  struct Way {
    double low = 0.0, high = 0.0;
    double fastest = 0.0;  ///< of either direction, per second
  };
  Way way(std::size_t joint, double from, double to, double early, bool may_stand) const;

  /// True if whatever is in effect from `stamp` on is a multiple, >= 0, of the direction.
  bool areAlong(const std::vector<double>& direction, double stamp) const;

 private:
  struct Passed {
    double time, begun;
    std::vector<double> command;
  };
  struct Sequence;

  /// The latest instant at which number i, which a later one replaced, is in effect.
  double endOf(std::size_t i, double now) const;
  std::size_t firstInEffect(double stamp, double now) const;
  void forget(double now);

  RobotResponse response_;
  std::deque<Passed> passed_;
  double renewed_;  // when the last one was published, again: sending it began
};

}  // namespace collision_pairs
