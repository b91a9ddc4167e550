// A loop on a given number of threads, each with memory of its own.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <thread>

#include "in_parallel.h"

namespace collision_pairs {

/// Calls work(i) for each i below `count`, each once, in any order; `makeWork` makes
/// the work of each thread. threads: 0 means as many as the machine has; more than that are not
/// started. The first exception ends the loop and is thrown again here.
template <class MakeWork>
void onThreads(unsigned threads, std::uint64_t count, const MakeWork& makeWork) {
  if (threads == 0) threads = std::max(1u, std::thread::hardware_concurrency());
  std::atomic<std::uint64_t> next{0};
  const auto takeSome = [&](std::size_t) {
    if (next >= count) return;
    auto work = makeWork();
    try {
      for (std::uint64_t i = next++; i < count; i = next++) work(i);
    } catch (...) {
      next = count;  // the others end too
      throw;
    }
  };
  inParallel(threads, takeSome);
}

}  // namespace collision_pairs
