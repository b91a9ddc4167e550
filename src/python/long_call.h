// Calls that take long: their threads, and Python's signals meanwhile.
#pragma once

#include <atomic>
#include <chrono>
#include <string>
#include <thread>

#include <pthread.h>
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

/// Releases the GIL for a call's duration. Made with the GIL. A child of fork() has none of its
/// parent's other threads, but the locks that they held, for ever: a child that was forked while
/// one was in such a call can make none.
class OthersMayRun {
 public:
  /// Once, before any call.
  static void watchForks() {
    ::pthread_atfork(nullptr, nullptr, [] { was_forked_in_call_ |= nb_calls_ > 0; });
  }

 private:
  struct Counted {
    Counted() {
      if (was_forked_in_call_) {
        throw InputError(
            "this process was made by fork() while another thread was in a call of "
            "collision_pairs: start it by 'spawn' or 'forkserver' (multiprocessing), or earlier");
      }
      ++nb_calls_;
    }
    ~Counted() { --nb_calls_; }
    Counted(const Counted&) = delete;
    Counted& operator=(const Counted&) = delete;
  };
  static inline std::atomic<int> nb_calls_{0};
  static inline bool was_forked_in_call_ = false;
  Counted counted_;
  pybind11::gil_scoped_release released_;
};

/// Python wants the program to stop (Ctrl-C); its exception is set.
struct Interrupted {};

/// Lets Python look for signals now and then, on the thread that made it, which Python waits for
/// and which has not the GIL. Other threads' calls do nothing.
class SignalCheck {
 public:
  /// Every so many calls the time is read.
  explicit SignalCheck(unsigned every) : every_(every) {}
  /// Throws Interrupted.
  void now() {
    if (std::this_thread::get_id() != caller_ || ++nb_calls_ % every_ != 0) return;
    if (Clock::now() < next_) return;
    next_ = Clock::now() + PERIOD;
    const pybind11::gil_scoped_acquire python;
    if (PyErr_CheckSignals() != 0) throw Interrupted();
  }

 private:
  using Clock = std::chrono::steady_clock;
  static constexpr std::chrono::milliseconds PERIOD{50};
  const unsigned every_;
  const std::thread::id caller_ = std::this_thread::get_id();
  unsigned nb_calls_ = 0;
  Clock::time_point next_ = Clock::now() + PERIOD;
};

}  // namespace collision_pairs
