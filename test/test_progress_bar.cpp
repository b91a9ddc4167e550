#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "progress_bar.h"

namespace collision_pairs::test_progress_bar {

using std::chrono::milliseconds;
using testing::internal::CaptureStderr;
using testing::internal::GetCapturedStderr;

TEST(ProgressBar, WhatIsNoTerminalGetsALineEachPeriodAndNoneOfWorkThatIsShort) {
  CaptureStderr();
  {
    ProgressBar long_work("search", 8, milliseconds(20)), short_work("states", 8);
    for (std::size_t done = 1; done <= 8; ++done) {
      if (done % 2 == 0) std::this_thread::sleep_for(milliseconds(25));
      long_work.show(done);
      short_work.show(done);
    }
  }
  EXPECT_EQ(GetCapturedStderr(), "search: 25 %\nsearch: 50 %\nsearch: 75 %\nsearch: 100 %\n");
}

TEST(ProgressBar, CountsWhatSeveralThreadsHaveDone) {
  CaptureStderr();
  ProgressBar bar("states", 4001, milliseconds(1));
  std::thread other([&] {
    for (int i = 0; i < 2000; ++i) bar.countOne();
  });
  for (int i = 0; i < 2000; ++i) bar.countOne();
  other.join();
  std::this_thread::sleep_for(milliseconds(5));
  bar.countOne();
  EXPECT_THAT(GetCapturedStderr(), testing::EndsWith("states: 100 %\n"));
}

TEST(ProgressBar, NoWorkIsNotDividedBy) {
  CaptureStderr();
  ProgressBar bar("states", 0, milliseconds(0));
  bar.show(0);
  EXPECT_EQ(GetCapturedStderr(), "");
}

}  // namespace collision_pairs::test_progress_bar
