// Calls that take long: their threads, and Python's signals meanwhile.
#pragma once

#include <chrono>
#include <string>
#include <thread>

#include <pybind11/pybind11.h>

#include "collision_pairs/input_error.h"

namespace collision_pairs {

/// Throws InputError for more than a program can mean: each has a detector of its own.
inline unsigned usableThreads(unsigned threads) {
  constexpr unsigned MAX_THREADS = 1024;
  if (threads <= MAX_THREADS) return threads;
  throw InputError("threads is " + std::to_string(threads) + ", but must be at most " +
                   std::to_string(MAX_THREADS) + "; 0: one per core");
}

/// Python wants the program to stop (Ctrl-C); its exception is set.
struct Interrupted {};

/// Lets Python look for signals now and then, on the thread that made it, which Python waits for
/// and which has not the GIL. Other threads' calls do nothing.
class SignalCheck {
 public:
  /// Throws Interrupted.
  void now() {
    if (std::this_thread::get_id() != caller_ || ++nb_calls_ % EVERY != 0) return;
    if (Clock::now() < next_) return;
    next_ = Clock::now() + PERIOD;
    const pybind11::gil_scoped_acquire python;
    if (PyErr_CheckSignals() != 0) throw Interrupted();
  }

 private:
  using Clock = std::chrono::steady_clock;
  static constexpr unsigned EVERY = 32;
  static constexpr std::chrono::milliseconds PERIOD{50};
  const std::thread::id caller_ = std::this_thread::get_id();
  unsigned nb_calls_ = 0;
  Clock::time_point next_ = Clock::now() + PERIOD;
};

}  // namespace collision_pairs
