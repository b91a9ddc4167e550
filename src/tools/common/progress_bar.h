// How far a tool is, on standard error.
#pragma once

#include <atomic>
#include <chrono>
#include <cstddef>
#include <mutex>
#include <string>

namespace collision_pairs {

/// On a terminal one line, redrawn several times a second and erased by the destructor. Elsewhere,
/// where nobody may be watching, a line each `line_every` that the work goes on. Calls from any
/// thread; of two at once, one is not shown.
class ProgressBar {
 public:
  ProgressBar(std::string title, std::size_t total,
              std::chrono::milliseconds line_every = std::chrono::seconds(10));
  ~ProgressBar();
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;
  void show(std::size_t done);
  /// One more is done. Tens of nanoseconds.
  void countOne() { show(++nb_counted_); }

 private:
  using Clock = std::chrono::steady_clock;
  void draw(std::size_t percent) const;

  const std::string title_;
  const std::size_t total_;
  const bool on_terminal_;
  const Clock::duration every_;
  std::atomic<std::size_t> nb_counted_{0};
  std::mutex mutex_;  // guards what follows
  Clock::time_point next_;
};

}  // namespace collision_pairs
