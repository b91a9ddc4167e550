#include "tool.h"

#include <cstdio>
#include <iostream>

#include <unistd.h>

#include "collision_pairs/input_error.h"

namespace collision_pairs {
namespace {

constexpr int WRONG_INPUT = 2;
constexpr auto REDRAWN_EVERY = std::chrono::milliseconds(100);
constexpr std::size_t BAR_WIDTH = 40;  // characters

}  // namespace

int runTool(CommandLine& command_line, int argc, char** argv, const std::function<void()>& work) {
  try {
    if (command_line.parse(argc, argv)) work();
    return 0;
  } catch (const std::exception& error) {
    std::cerr << "error: " << InputError(error.what()).what() << '\n';
    return WRONG_INPUT;
  }
}

void warn(const std::string& message) {
  std::cerr << "warning: " << InputError(message).what() << '\n';
}

ProgressBar::ProgressBar(std::string title, std::size_t total)
    : title_(std::move(title)), total_(total), on_terminal_(::isatty(STDERR_FILENO)) {}

ProgressBar::~ProgressBar() {
  if (on_terminal_) std::fputs("\r\033[K", stderr);
}

void ProgressBar::show(std::size_t done) {
  if (!on_terminal_ || total_ == 0) return;
  const auto now = std::chrono::steady_clock::now();
  if (now < next_) return;
  next_ = now + REDRAWN_EVERY;
  const std::string bar(BAR_WIDTH * done / total_, '#');
  std::fprintf(stderr, "\r\033[K%s [%-*s] %zu %% ", title_.c_str(), static_cast<int>(BAR_WIDTH),
               bar.c_str(), 100 * done / total_);
  std::fflush(stderr);
}

}  // namespace collision_pairs
