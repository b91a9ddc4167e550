#include "prepared_surroundings.h"

#include <exception>
#include <thread>
#include <utility>

#include "collision_pairs/input_error.h"

namespace collision_pairs {
namespace {

constexpr std::chrono::milliseconds PERIOD(
    50);  // between two looks whether something else is wanted

constexpr std::chrono::milliseconds A_DECISION(1);

}  // namespace

PreparedSurroundings::PreparedSurroundings(Ask ask, Make make)
    : ask_(std::move(ask)), make_(std::move(make)), thread_([this] { prepare(); }) {}

PreparedSurroundings::~PreparedSurroundings() {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    ends_ = true;
  }
  changed_.notify_all();
  thread_.join();
}

std::shared_ptr<CertifiedSurroundings> PreparedSurroundings::get(
    const Wanted& wanted, std::chrono::steady_clock::time_point deadline) {
  std::unique_lock<std::mutex> lock(mutex_);
  const auto isReady = [&] { return made_of_ == wanted; };
  if (!isReady()) {
    is_asked_ = true;
    changed_.notify_all();
    if (!changed_.wait_until(lock, deadline, isReady)) {
      throw InputError("the scene has changed, and its check is being prepared");
    }
  }
  if (!error_.empty()) throw InputError(error_);
  return made_;
}

void PreparedSurroundings::prepare() {
  std::unique_lock<std::mutex> lock(mutex_);
  while (!ends_) {
    is_asked_ = false;
    lock.unlock();
    const Wanted wanted = ask_();
    lock.lock();
    if (!wanted.scene || wanted == made_of_) {
      changed_.wait_for(lock, PERIOD, [this] { return ends_ || is_asked_; });
      continue;
    }
    lock.unlock();
    std::shared_ptr<CertifiedSurroundings> made;
    std::string error;
    try {
      made = make_(wanted);
    } catch (const std::exception& caught) {
      error = caught.what();
    }
    lock.lock();
    made_.swap(made);
    made_of_ = wanted;
    error_ = std::move(error);
    lock.unlock();
    changed_.notify_all();
    while (made.use_count() > 1) std::this_thread::sleep_for(A_DECISION);
    made.reset();  // the old one: here, and not at the end of the decision that had it
    lock.lock();
  }
}

}  // namespace collision_pairs
