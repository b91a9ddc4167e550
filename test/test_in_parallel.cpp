#include <atomic>
#include <chrono>
#include <mutex>
#include <set>
#include <stdexcept>
#include <string>
#include <thread>

#include <gtest/gtest.h>

#include "failing_threads.h"
#include "in_parallel.h"

namespace collision_pairs::test_in_parallel {

/// How often each index was asked for, how many threads did that, and whether two calls with one
/// thread number overlapped.
struct Calls {
  std::vector<int> of_index;
  std::set<std::thread::id> threads;
  std::set<std::size_t> numbers;
  std::multiset<std::size_t> running;
  bool overlapped = false;
};

Calls callsOf(std::size_t threads, std::size_t count) {
  Calls calls;
  calls.of_index.resize(count);
  std::mutex mutex;
  inParallel(threads, count, [&](std::size_t number, std::size_t i) {
    {
      const std::lock_guard<std::mutex> lock(mutex);
      ++calls.of_index[i];
      calls.threads.insert(std::this_thread::get_id());
      calls.numbers.insert(number);
      calls.running.insert(number);
      calls.overlapped |= calls.running.count(number) > 1;
    }
    std::this_thread::sleep_for(std::chrono::microseconds(50));
    const std::lock_guard<std::mutex> lock(mutex);
    calls.running.erase(calls.running.find(number));
  });
  return calls;
}

TEST(InParallel, CallsEachIndexOnceAndNoThreadNumberTwiceAtATime) {
  for (const std::size_t threads : {1u, 2u, 5u}) {
    for (const std::size_t count : {0u, 1u, 3u, 200u}) {
      const Calls calls = callsOf(threads, count);
      EXPECT_EQ(calls.of_index, std::vector<int>(count, 1)) << threads << " threads";
      EXPECT_FALSE(calls.overlapped);
      EXPECT_LE(calls.threads.size(), threads);
      for (const std::size_t number : calls.numbers) EXPECT_LT(number, threads);
    }
  }
}

TEST(InParallel, ThreadsThatCannotBeStartedAreDoneWithout) {
  for (const int can_be_started : {0, 1, 2}) {
    threads_left = can_be_started;
    const Calls calls = callsOf(4, 200);
    threads_left = -1;
    EXPECT_EQ(calls.of_index, std::vector<int>(200, 1));
    EXPECT_LE(calls.threads.size(), 1u + static_cast<std::size_t>(can_be_started));
  }
}

TEST(InParallel, ThrowsAnExceptionOfAnyThreadAgainAndEndsTheLoop) {
  for (const std::size_t threads : {1u, 3u}) {
    for (std::size_t thrower = 0; thrower < threads; ++thrower) {
      std::atomic<bool> thrown{false};
      std::atomic<int> nb_calls{0};
      const auto work = [&](std::size_t thread, std::size_t i) {
        ++nb_calls;
        if (thread == thrower) {
          thrown = true;
          throw std::runtime_error("at " + std::to_string(i));
        }
        while (!thrown) std::this_thread::yield();
      };
      EXPECT_THROW(inParallel(threads, 1000000, work), std::runtime_error) << thrower;
      EXPECT_LT(nb_calls, 1000000);
    }
  }
}

TEST(InParallel, ZeroThreadsAreAsManyAsTheMachineHasAndNeverMoreThanThereIsWork) {
  EXPECT_EQ(nbThreads(0, 1000000), std::max(1u, std::thread::hardware_concurrency()));
  EXPECT_EQ(nbThreads(3, 1000000), 3u);
  EXPECT_EQ(nbThreads(3, 2), 2u);
}

}  // namespace collision_pairs::test_in_parallel
