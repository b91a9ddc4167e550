#include "progress_bar.h"

#include <cstdio>

#include <unistd.h>

namespace collision_pairs {
namespace {

constexpr auto PERIOD = std::chrono::milliseconds(100);
constexpr std::size_t WIDTH = 40;  // characters

}  // namespace

ProgressBar::ProgressBar(std::string title, std::size_t total)
    : title_(std::move(title)), total_(total), on_terminal_(::isatty(STDERR_FILENO)) {}

ProgressBar::~ProgressBar() {
  if (on_terminal_) std::fputs("\r\033[K", stderr);
}

void ProgressBar::show(std::size_t done) {
  if (!on_terminal_ || total_ == 0) return;
  const auto now = std::chrono::steady_clock::now();
  if (now < next_) return;
  next_ = now + PERIOD;
  const std::string bar(WIDTH * done / total_, '#');
  std::fprintf(stderr, "\r\033[K%s [%-*s] %zu %% ", title_.c_str(), static_cast<int>(WIDTH),
               bar.c_str(), 100 * done / total_);
  std::fflush(stderr);
}

}  // namespace collision_pairs
