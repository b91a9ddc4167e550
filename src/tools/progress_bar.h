// How far a tool is, for a person at a terminal.
#pragma once

#include <chrono>
#include <cstddef>
#include <string>

namespace collision_pairs {

/// One line on standard error, redrawn some times a second; nothing at all where that is no
/// terminal. Gone when it is destroyed.
class ProgressBar {
 public:
  ProgressBar(std::string title, std::size_t total);
  ~ProgressBar();
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;
  void show(std::size_t done);

 private:
  std::string title_;
  std::size_t total_;
  bool on_terminal_;
  std::chrono::steady_clock::time_point next_;
};

}  // namespace collision_pairs
