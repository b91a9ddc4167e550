// Common behaviour of all tools: wrong input produces one line on standard error and exit code 2;
// progress is shown on a terminal.
#pragma once

#include <chrono>
#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "command_line.h"

namespace collision_pairs {

/// Parses the command line and runs `work`. 0: done; 2: wrong input, reported in one line.
int runTool(CommandLine& command_line, int argc, char** argv, const std::function<void()>& work);

/// "warning: …" on standard error.
void warn(const std::string& message);

/// One line on standard error, redrawn several times a second; prints nothing if that is not a
/// terminal. Erased by the destructor.
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
