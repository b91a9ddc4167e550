// Stamps, ages, and spans of stamps at which a pose is suspect.
#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

namespace collision_pairs {

/// Nanoseconds since the epoch.
using StampNs = std::int64_t;

constexpr StampNs NEVER = std::numeric_limits<StampNs>::max();
constexpr StampNs EVER_SINCE = std::numeric_limits<StampNs>::min();
/// tf2's stamps have 32 bits of seconds, to which it adds the length of its cache.
constexpr StampNs LAST_STAMP = 4000000000 * StampNs{1000000000};

inline double inSeconds(StampNs span) { return 1e-9 * static_cast<double>(span); }

/// When something that was received was measured, in seconds on the clock of the stamp. Nothing is
/// measured after it has arrived: a stamp ahead of the clock is that of a sender whose clock is
/// ahead.
inline double measuredAt(double stamp, double arrival) { return std::min(stamp, arrival); }

/// `stamp` + `span`; a span of NEVER has no end.
inline StampNs after(StampNs stamp, StampNs span) {
  return span == NEVER || stamp > NEVER - span ? NEVER : stamp + span;
}
inline StampNs before(StampNs stamp, StampNs span) {
  return span == NEVER || stamp < EVER_SINCE + span ? EVER_SINCE : stamp - span;
}

/// Limits for poses and their stamps, in seconds. The node's parameters have the same names.
struct PoseLimits {
  /// A pose older than this relative to now is not used; 0: no limit.
  double max_pose_age = 1.0;
  /// … nor one older than this relative to the newest transform of any frame that places the
  /// robot.
  /// Between two transforms further apart than this nothing is interpolated.
  double max_transform_age = 1.0;
  /// A stamp further ahead of now is refused, because clocks of computers differ by less.
  double clock_tolerance = 0.5;
};

/// The same in nanoseconds.
struct StampLimits {
  explicit StampLimits(const PoseLimits& limits);
  StampNs max_age;  ///< NEVER: no limit
  StampNs max_gap, tolerance;
  StampNs kept;     ///< history before the newest stamp
  StampNs lasting;  ///< of a suspicion: max_age, or max_gap if ages do not matter
};

/// Why a pose that lags behind the newest transform of a robot is not used; empty: it may be.
std::string whyBehind(StampNs lag, const StampLimits& limits);

/// Open at both ends.
struct Span {
  StampNs begin, end;
};

/// Stamps at which something is suspect, for one kind of reason: disjoint spans, sorted. Spans
/// that overlap become one with the later reason. Bounded: of too many, the two oldest become one.
class SuspectSpans {
 public:
  void add(Span span, std::string why);
  /// Why that stamp is suspect; null: it is not. O(log spans).
  const std::string* at(StampNs stamp) const;
  /// Takes out all stamps from `begin` to `end`, both included.
  void remove(StampNs begin, StampNs end);
  /// The last span, if it has no end or a later one, ends there.
  void endBy(StampNs end);
  bool isOpen() const { return !spans_.empty() && spans_.back().span.end == NEVER; }
  void forgetBefore(StampNs stamp);
  void clear() { spans_.clear(); }
  std::size_t size() const { return spans_.size(); }

 private:
  struct Suspect {
    Span span;
    std::string why;
  };
  std::vector<Suspect>::iterator firstEndingAfter(StampNs stamp);

  std::vector<Suspect> spans_;
};

}  // namespace collision_pairs
