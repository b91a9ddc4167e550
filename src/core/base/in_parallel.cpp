#include "in_parallel.h"

#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

namespace collision_pairs {

std::size_t nbThreads(unsigned wanted, std::size_t count) {
  const unsigned threads = wanted > 0 ? wanted : std::max(1u, std::thread::hardware_concurrency());
  return std::min<std::size_t>(threads, count);
}

void inParallel(std::size_t threads, std::size_t count,
                const std::function<void(std::size_t, std::size_t)>& work) {
  std::atomic<std::size_t> next{0};
  std::mutex mutex;
  std::exception_ptr failure;
  const auto take = [&](std::size_t thread) {
    try {
      for (std::size_t i = next++; i < count; i = next++) work(thread, i);
    } catch (...) {
      next = count;  // the others end too
      const std::lock_guard<std::mutex> lock(mutex);
      if (!failure) failure = std::current_exception();
    }
  };
  std::vector<std::thread> others;
  try {
    if (threads > 1) others.reserve(threads - 1);
    for (std::size_t i = 1; i < threads && i < count; ++i) others.emplace_back(take, i);
  } catch (const std::exception&) {
    // No memory, or no thread available: the running threads do its share.
  }
  take(0);
  for (std::thread& other : others) other.join();
  if (failure) std::rethrow_exception(failure);
}

}  // namespace collision_pairs
