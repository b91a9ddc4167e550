#include "command_outlet.h"

#include <algorithm>
#include <chrono>
#include <utility>

#include "user_text.h"

namespace collision_pairs {

CommandOutlet::CommandOutlet(Settings settings)
    : settings_(std::move(settings)),
      watch_(settings_.joints, settings_.law, settings_.may_stand),
      watchdog_([this] { watch(); }) {}

CommandOutlet::~CommandOutlet() {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    ends_ = true;
  }
  changed_.notify_all();
  watchdog_.join();
}

void CommandOutlet::tell(LimiterLaw& law, bool moves) {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (moves) watch_.asked(settings_.now().latest);
  for (const Published& published : untold_) law.published(published.time, published.decision);
  untold_.clear();
  is_deciding_ = true;
}

CommandOutlet::Result CommandOutlet::pass(const LimiterDecision& decision, double deadline,
                                          const Time& arrived, Send send) {
  const std::lock_guard<std::mutex> lock(mutex_);
  const Time now = settings_.now();
  if (!watch_.fault(now.latest).empty()) return Result::FAULT;
  if (!untold_.empty()) return Result::NOT_TOLD;
  if (now.steady > deadline || now.latest > decision.publish_by) return Result::LATE;
  send_ = std::move(send);
  is_deciding_ = false;
  publish(decision, arrived);
  return Result::PUBLISHED;
}

void CommandOutlet::stop(const LimiterDecision& decision, Send send) {
  const std::lock_guard<std::mutex> lock(mutex_);
  send_ = std::move(send);
  is_deciding_ = false;
  publish(decision, settings_.now());
}

std::string CommandOutlet::measured(const std::vector<ResponseWatch::Position>& positions) {
  const std::lock_guard<std::mutex> lock(mutex_);
  const Time now = settings_.now();
  const bool was_sound = watch_.fault(now.latest).empty();
  for (const ResponseWatch::Position& position : positions) watch_.measured(position, now.latest);
  const std::string fault = watch_.fault(now.latest);
  if (was_sound && !fault.empty() && is_watched_) publish(zeros(fault), now);
  return fault;
}

void CommandOutlet::forgetMeasured() {
  const std::lock_guard<std::mutex> lock(mutex_);
  watch_.clear();
}

std::string CommandOutlet::fault() {
  const std::lock_guard<std::mutex> lock(mutex_);
  return watch_.fault(settings_.now().latest);
}

// The command before may be in effect until this one was sent, and for the dead time after that.
void CommandOutlet::publish(const LimiterDecision& decision, const Time& since) {
  const double begun = settings_.now().law;
  send_(decision);
  const Time now = settings_.now();
  untold_.push_back({now.latest, decision});
  watch_.published(begun, now.latest, decision.command);
  since_ = since;
  if (!std::exchange(is_watched_, true)) changed_.notify_all();
}

double CommandOutlet::secondsLeft() const {
  const Time now = settings_.now();
  return settings_.law.command_timeout -
         std::max({now.steady - since_.steady, now.law - since_.law, now.latest - since_.latest});
}

void CommandOutlet::watch() {
  if (settings_.began) settings_.began();
  std::unique_lock<std::mutex> lock(mutex_);
  while (!ends_) {
    if (!is_watched_) {
      changed_.wait(lock);
      continue;
    }
    const double left = secondsLeft();
    if (left > 0.0) {
      changed_.wait_for(lock, std::chrono::duration<double>(std::min(left, settings_.poll)));
      continue;
    }
    const std::string timeout = inWords(settings_.law.command_timeout);
    const Time now = settings_.now();
    std::string reason = watch_.fault(now.latest);
    if (reason.empty()) {
      reason = is_deciding_ ? "overrun: a decision lasts, and nothing was passed for " + timeout
                            : "no command for " + timeout;
    }
    publish(zeros(std::move(reason)), now);
    is_watched_ = false;
  }
  if (is_watched_) publish(zeros("the limiter ends"), settings_.now());
}

LimiterDecision CommandOutlet::zeros(std::string reason) const {
  LimiterDecision zeros;
  zeros.command.assign(settings_.joints.size(), 0.0);
  zeros.reason = std::move(reason);
  return zeros;
}

}  // namespace collision_pairs
