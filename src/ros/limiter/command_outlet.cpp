#include "command_outlet.h"

#include <algorithm>
#include <chrono>
#include <utility>

#include "user_text.h"

namespace collision_pairs {

CommandOutlet::CommandOutlet(Settings settings)
    : settings_(std::move(settings)), watchdog_([this] { watch(); }) {}

CommandOutlet::~CommandOutlet() {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    ends_ = true;
  }
  changed_.notify_all();
  watchdog_.join();
}

void CommandOutlet::tell(LimiterLaw& law) {
  const std::lock_guard<std::mutex> lock(mutex_);
  for (const Published& published : untold_) law.published(published.time, published.decision);
  untold_.clear();
  is_deciding_ = true;
}

CommandOutlet::Result CommandOutlet::pass(const LimiterDecision& decision, double deadline,
                                          const Time& arrived, Send send) {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (!untold_.empty()) return Result::NOT_TOLD;
  const Time now = settings_.now();
  if (now.steady > deadline || now.law > decision.publish_by) return Result::LATE;
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

// The command before may be in effect until this one was sent, and for the dead time after that.
void CommandOutlet::publish(const LimiterDecision& decision, const Time& since) {
  send_(decision);
  untold_.push_back({settings_.now().law, decision});
  seconds_to_rest_ = decision.seconds_to_rest;
  since_ = since;
  if (!std::exchange(is_watched_, true)) changed_.notify_all();
}

double CommandOutlet::secondsLeft() const {
  const Time now = settings_.now();
  return settings_.command_timeout -
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
    publish(zeros(), settings_.now());
    is_watched_ = false;
  }
}

LimiterDecision CommandOutlet::zeros() const {
  const std::string timeout = inWords(settings_.command_timeout);
  LimiterDecision zeros;
  zeros.command.assign(settings_.nb_joints, 0.0);
  zeros.reason = is_deciding_ ? "overrun: a decision lasts, and nothing was passed for " + timeout
                              : "no command for " + timeout;
  zeros.seconds_to_rest = seconds_to_rest_;
  return zeros;
}

}  // namespace collision_pairs
