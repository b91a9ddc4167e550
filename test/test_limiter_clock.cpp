// The times of the velocity limiter: those of a simulation are bounded by what was received.
#include <gtest/gtest.h>

#include "limiter_clock.h"
#include "random_inputs.h"

namespace collision_pairs::test_limiter_clock {

TEST(LimiterClock, IsNeverBehindAStampThatWasReceivedIfTheTimeIsSimulated) {
  RandomInputs random;
  for (int round = 0; round < 100; ++round) {
    LimiterClock clock(true);
    double now = 50.0, steady = 7.0, newest = 0.0;
    for (int i = 0; i < 100; ++i) {
      steady += random.uniform(0.0, 0.1);
      if (random.integer(0, 2) > 0) now += random.uniform(0.0, 0.1);  // else it stands still
      clock.follow(now, steady, 0);
      if (random.integer(0, 1)) {
        const double stamp = now + random.uniform(-0.2, 0.2);
        clock.receive(stamp);
        newest = std::max(newest, stamp);
      }
      ASSERT_EQ(clock.latest(), std::max(now, newest));
      ASSERT_GE(clock.lawLatest(), clock.law());
      ASSERT_EQ(clock.clock(), now);
    }
    EXPECT_NEAR(clock.law(), now, 1e-9) << "no more than has certainly passed";
  }
}

// A command that was published before the next tick may have an effect as much later.
TEST(LimiterClock, KnowsHowFarASimulatedClockThatIsSlowMayBeBehind) {
  RandomInputs random;
  for (int round = 0; round < 60; ++round) {
    const int tick = random.integer(1, 100), period = random.integer(2, 30);  // ms
    const int late = random.integer(0, 30);
    const bool has_states = random.integer(0, 1);
    LimiterClock clock(true);
    for (int ms = 0; ms < 4000; ++ms) {
      const int said = ms / tick * tick;
      clock.follow(50.0 + 1e-3 * said, 1e-3 * ms, 0);
      if (has_states && ms % period == 0) clock.receive(50.0 + 1e-3 * (ms - late));
      if (ms < 2000) continue;
      const double now = 50.0 + 1e-3 * ms;
      ASSERT_GE(clock.upper(), now - (has_states ? 1e-3 * period : 1e-9));
      ASSERT_LE(clock.upper(), now + 1e-3 * tick + 1e-9) << "and not more";
    }
  }
}

// Commands are recorded at this time, in order.
TEST(LimiterClock, NeverGoesBackInTheTimeThatMayHavePassed) {
  RandomInputs random;
  for (int round = 0; round < 100; ++round) {
    LimiterClock clock(true);
    double now = 50.0, steady = 7.0, last = 0.0;
    for (int i = 0; i < 300; ++i) {
      steady += random.uniform(0.0, 0.05);
      now += random.integer(0, 9) > 0 ? random.uniform(0.0, 0.01) : random.uniform(0.0, 0.4);
      if (random.integer(0, 99) == 0) now -= random.uniform(0.0, 5.0);
      clock.follow(now, steady, 0);
      ASSERT_GE(clock.lawLatest(), last) << round;
      last = clock.lawLatest();
      if (random.integer(0, 1)) clock.receive(now + random.uniform(-0.1, 0.1));
    }
  }
}

TEST(LimiterClock, TakesAJumpForwardForTimeThatHasPassed) {
  LimiterClock clock(true);
  clock.follow(100.0, 1.0, 0);
  clock.follow(100.4, 1.1, 0);
  EXPECT_NEAR(clock.upper(), 100.8, 1e-9);
  clock.follow(105.0, 1.2, 0);
  EXPECT_NEAR(clock.upper(), 105.4, 1e-9);
  clock.follow(105.001, 2.11, 0);
  EXPECT_NEAR(clock.upper(), 105.002, 1e-9) << "a second later";
}

TEST(LimiterClock, IsThatOfTheWallOtherwise) {
  LimiterClock clock(false);
  clock.follow(1000.0, 7.0, 0);
  clock.receive(1000.09);  // of a sender whose clock is ahead
  EXPECT_EQ(clock.latest(), 1000.0);
  EXPECT_EQ(clock.law(), 7.0);
  EXPECT_EQ(clock.lawLatest(), 7.0);
  EXPECT_TRUE(clock.follow(500.0, 8.0, 0)) << "it was set";
  EXPECT_EQ(clock.law(), 8.0);
  EXPECT_EQ(clock.standsFor(99.0), 0.0);
}

TEST(LimiterClock, ThatGoesBackForgetsWhatItReceivedButNotHowMuchTimeHasPassed) {
  LimiterClock clock(true);
  EXPECT_FALSE(clock.follow(100.0, 1.0, 0));
  clock.receive(100.05);
  const double before = clock.law();
  EXPECT_FALSE(clock.follow(99.99, 1.1, 0)) << "a clock that is being set";
  EXPECT_EQ(clock.clock(), 100.0);
  EXPECT_TRUE(clock.follow(40.0, 1.2, 0));
  EXPECT_EQ(clock.latest(), 40.0);
  EXPECT_EQ(clock.law(), before);
  clock.follow(40.5, 1.3, 0);
  EXPECT_NEAR(clock.law(), before + 0.5, 1e-9);
  EXPECT_TRUE(clock.follow(40.6, 1.4, 1)) << "it went back and forth, as others have seen";
  EXPECT_FALSE(clock.follow(40.7, 1.5, 1));
}

TEST(LimiterClock, StandsStillWhileNeitherItNorAStampGoesOn) {
  LimiterClock clock(true);
  EXPECT_EQ(clock.standsFor(3.0), 0.0) << "it was never read";
  clock.follow(100.0, 3.0, 0);
  clock.follow(100.0, 3.5, 0);
  EXPECT_EQ(clock.standsFor(3.5), 0.5);
  clock.receive(99.0);
  clock.follow(100.0, 3.6, 0);
  EXPECT_NEAR(clock.standsFor(3.6), 0.6, 1e-9) << "an old stamp says nothing";
  clock.receive(100.01);
  clock.follow(100.0, 3.7, 0);
  EXPECT_EQ(clock.standsFor(3.7), 0.0);
  clock.follow(100.005, 3.8, 0);
  EXPECT_NEAR(clock.standsFor(3.8), 0.1, 1e-9) << "that is no later than what was received";
  clock.follow(100.02, 3.9, 0);
  EXPECT_EQ(clock.standsFor(3.9), 0.0);
}

}  // namespace collision_pairs::test_limiter_clock
