#include "progress_bar.h"

#include <cstdio>

#include <unistd.h>

namespace collision_pairs {
namespace {

constexpr auto REDRAWN_EVERY = std::chrono::milliseconds(100);
constexpr std::size_t BAR_WIDTH = 40;  // characters

}  // namespace

ProgressBar::ProgressBar(std::string title, std::size_t total, std::chrono::milliseconds line_every)
    : title_(std::move(title)),
      total_(total),
      on_terminal_(::isatty(STDERR_FILENO)),
      every_(on_terminal_ ? REDRAWN_EVERY : line_every),
      next_(Clock::now() + (on_terminal_ ? Clock::duration::zero() : every_)) {}

ProgressBar::~ProgressBar() {
  if (on_terminal_) std::fputs("\r\033[K", stderr);
}

void ProgressBar::show(std::size_t done) {
  const std::unique_lock<std::mutex> lock(mutex_, std::try_to_lock);
  const auto now = Clock::now();
  if (!lock || total_ == 0 || now < next_) return;
  next_ = now + every_;
  draw(100 * done / total_);
}

void ProgressBar::draw(std::size_t percent) const {
  const std::string bar(BAR_WIDTH * percent / 100, '#');
  if (on_terminal_) {
    std::fprintf(stderr, "\r\033[K%s [%-*s] %zu %% ", title_.c_str(), static_cast<int>(BAR_WIDTH),
                 bar.c_str(), percent);
  } else {
    std::fprintf(stderr, "%s: %zu %%\n", title_.c_str(), percent);
  }
  std::fflush(stderr);
}

}  // namespace collision_pairs
