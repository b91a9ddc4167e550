// The one way by which commands leave the limiter.
#pragma once

#include <condition_variable>
#include <functional>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "limiter_law.h"
#include "response_watch.h"

namespace collision_pairs {

/// Publishes decisions, and zeros once no command was published for a while: these come from a
/// watchdog on a thread of its own that does nothing else, so they come in time whatever a decision
/// does meanwhile, and before it ends. What is published and what is recorded is the same by
/// construction: both happen here, under one lock, in one order. A decision that is late, or that
/// does not know of all that was published, is not published; nor is one for a robot that does not
/// do what was published. Thread safe.
class CommandOutlet {
 public:
  struct Time {
    double law = 0.0;     ///< s: has certainly passed; in simulated time that of the clock
    double latest = 0.0;  ///< s: may have passed; in simulated time that of the newest stamp, too
    double steady = 0.0;  ///< s of the wall
  };
  /// Sends one message of the command's type.
  using Send = std::function<void(const LimiterDecision&)>;
  struct Settings {
    std::vector<std::string> joints;  ///< of the command
    /// Zeros follow after command_timeout, in whichever time is over first.
    LimiterSettings law;
    bool may_stand = false;  ///< see ResponseWatch
    double poll = 1e9;       ///< s, at most, between two looks of the watchdog at the time
    std::function<Time()> now;
    std::function<void()> began;  ///< called by the watchdog's thread when it begins; may be empty
  };

  explicit CommandOutlet(Settings settings);
  ~CommandOutlet();
  CommandOutlet(const CommandOutlet&) = delete;

  /// A decision begins, on a command that moves or zeros: records in the law what was published
  /// since the last call.
  void tell(LimiterLaw& law, bool moves);

  /// Joint states came. If one shows that the robot does not do what was published, and it may
  /// still have a command, zeros are published at once. Returns fault().
  std::string measured(const std::vector<ResponseWatch::Position>& positions);
  /// What was measured before is of another time.
  void forgetMeasured();
  /// See ResponseWatch.
  std::string fault();

  enum class Result { PUBLISHED, LATE, NOT_TOLD, FAULT };
  /// Publishes a decision on a command that `arrived` then, unless it is later than its publish_by
  /// or `deadline`, seconds of the steady clock, something was published since tell(), or there is
  /// a fault().
  Result pass(const LimiterDecision& decision, double deadline, const Time& arrived, Send send);
  /// Publishes zeros, at any time.
  void stop(const LimiterDecision& decision, Send send);

 private:
  struct Published {
    double time;
    LimiterDecision decision;
  };

  void publish(const LimiterDecision& decision, const Time& since);
  double secondsLeft() const;
  LimiterDecision zeros(std::string reason) const;
  void watch();

  const Settings settings_;
  std::mutex mutex_;  // guards what follows
  std::condition_variable changed_;
  bool ends_ = false;
  std::vector<Published> untold_;
  ResponseWatch watch_;
  Send send_;                // of the last command
  bool is_watched_ = false;  // zeros are due after the time-out
  Time since_;               // it counts from here
  bool is_deciding_ = false;
  std::thread watchdog_;  // last: it uses the others
};

}  // namespace collision_pairs
