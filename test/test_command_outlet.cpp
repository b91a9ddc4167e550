// What leaves the limiter: decisions that are in time, zeros whatever the decisions do, and the law
// knows of exactly that.
#include <atomic>
#include <chrono>
#include <cmath>
#include <condition_variable>
#include <mutex>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "benchmark/simulated_joints.h"
#include "command_outlet.h"
#include "published_decisions.h"

namespace collision_pairs::test_command_outlet {

constexpr double INF = std::numeric_limits<double>::infinity();

LimiterDecision decisionOf(double speed, double publish_by = INF) {
  LimiterDecision decision;
  decision.command = {speed};
  decision.scale = speed == 0.0 ? 0.0 : 1.0;
  decision.publish_by = publish_by;
  return decision;
}

/// An outlet with a clock that the test sets, and what it has sent.
class Outlet : public testing::Test {
 protected:
  void begin(double command_timeout) {
    CommandOutlet::Settings settings;
    settings.joints = {"slide"};
    settings.law.command_timeout = command_timeout;
    settings.law.deceleration = {2.0};
    settings.poll = 0.001;
    settings.now = [this] {
      const double now = now_;
      return CommandOutlet::Time{now, now + ahead_, now};
    };
    outlet_ = std::make_unique<CommandOutlet>(settings);
  }
  CommandOutlet::Send send() {
    return [this](const LimiterDecision& decision) {
      const std::lock_guard<std::mutex> lock(mutex_);
      sent_.push_back(decision);
      was_sent_.notify_all();
    };
  }
  CommandOutlet::Time time() const { return {now_, now_ + ahead_, now_}; }
  /// Of the watchdog; false: it did not come.
  bool waitFor(std::size_t nb_sent) {
    std::unique_lock<std::mutex> lock(mutex_);
    return was_sent_.wait_for(lock, std::chrono::seconds(60),
                              [&] { return sent_.size() >= nb_sent; });
  }
  std::vector<LimiterDecision> sent() {
    const std::lock_guard<std::mutex> lock(mutex_);
    return sent_;
  }

  using Result = CommandOutlet::Result;
  std::atomic<double> now_{100.0}, ahead_{0.0};
  std::mutex mutex_;
  std::condition_variable was_sent_;
  std::vector<LimiterDecision> sent_;
  LimiterSettings settings_;
  std::unique_ptr<CommandOutlet> outlet_;
};

TEST_F(Outlet, PublishesADecisionUntilItsTimeAndNoLater) {
  begin(9.0);
  settings_.deceleration = {2.0};
  LimiterLaw law(settings_);
  EXPECT_EQ(outlet_->pass(decisionOf(0.3, 100.0), 100.0, time(), send()), Result::PUBLISHED);
  outlet_->tell(law, true);
  EXPECT_EQ(outlet_->pass(decisionOf(0.4, 99.999), 100.0, time(), send()), Result::LATE);
  EXPECT_EQ(outlet_->pass(decisionOf(0.5, 100.0), 99.999, time(), send()), Result::LATE);
  ASSERT_EQ(sent().size(), 1u);
  EXPECT_EQ(sent()[0].command[0], 0.3);
}

TEST_F(Outlet, SendsZerosWhileADecisionIsBlocked) {
  begin(0.2);
  settings_.deceleration = {2.0};
  LimiterLaw law(settings_);
  outlet_->tell(law, true);
  ASSERT_EQ(outlet_->pass(decisionOf(0.3), INF, time(), send()), Result::PUBLISHED);
  outlet_->tell(law, true);  // and then the decision does not come to its end
  now_ = 100.19;
  std::this_thread::sleep_for(std::chrono::milliseconds(50));
  EXPECT_EQ(sent().size(), 1u) << "the command is certified for as long";
  now_ = 100.2001;
  ASSERT_TRUE(waitFor(2));
  EXPECT_EQ(sent()[1].command, std::vector<double>{0.0});
  EXPECT_EQ(sent()[1].reason, "overrun: a decision lasts, and nothing was passed for 0.20 s");
  // In time by its own clock, but it does not know of the zeros.
  EXPECT_EQ(outlet_->pass(decisionOf(0.3), INF, time(), send()), Result::NOT_TOLD);
  EXPECT_EQ(sent().size(), 2u);
  outlet_->stop(law.stop("told to"), send());
  outlet_->tell(law, true);
  EXPECT_EQ(outlet_->pass(decisionOf(0.3), INF, time(), send()), Result::PUBLISHED);
}

TEST_F(Outlet, SendsZerosOnceAfterSilenceInWhicheverTimeIsOverFirst) {
  begin(0.2);
  ASSERT_EQ(outlet_->pass(decisionOf(0.3), INF, time(), send()), Result::PUBLISHED);
  ahead_ = 0.2001;  // joint states of so much later, and a clock that stands still
  ASSERT_TRUE(waitFor(2));
  EXPECT_EQ(sent()[1].reason, "no command for 0.20 s");
  now_ = 109.0;
  std::this_thread::sleep_for(std::chrono::milliseconds(50));
  EXPECT_EQ(sent().size(), 2u);
}

TEST_F(Outlet, SendsZerosBeforeItEndsUnlessItHas) {
  for (const bool has_sent : {false, true}) {
    sent_.clear();
    begin(has_sent ? 0.2 : 1000.0);
    outlet_->pass(decisionOf(0.5), INF, time(), send());
    if (has_sent) {
      now_ = now_ + 0.3;
      ASSERT_TRUE(waitFor(2));
    }
    outlet_.reset();
    ASSERT_EQ(sent().size(), 2u) << has_sent;
    EXPECT_EQ(sent()[1].command, std::vector<double>{0.0});
  }
}

// A simulated clock may be late: the command before is in effect for as much longer.
TEST_F(Outlet, ToTheLawACommandWasPublishedWhenItMayHaveBeen) {
  begin(9.0);
  ahead_ = 0.1;
  settings_.deceleration = {2.0};
  LimiterLaw law(settings_);
  ASSERT_EQ(outlet_->pass(decisionOf(0.3), INF, time(), send()), Result::PUBLISHED);
  outlet_->tell(law, true);
  FreeSurroundings surroundings;
  law.decide({100.17, 100.15, 0.0, {0.3}}, surroundings);
  PassedCommands passed({settings_.reaction_time, settings_.command_timeout + 0.01, {2.0}});
  passed.add(100.1, {0.3});
  const StoppingTube expected = passed.tube(100.15, 100.17, {0.3}, {0.3});
  EXPECT_NEAR(surroundings.tube.from[0], expected.from[0], 1e-9);
  EXPECT_NEAR(surroundings.tube.to[0], expected.to[0], 1e-9);
  EXPECT_NEAR(surroundings.tube.deviation[0], expected.deviation[0], 1e-9);
}

TEST_F(Outlet, ARobotThatDoesNotDoWhatWasPublishedIsSentZerosAtOnceAndNothingElse) {
  begin(0.2);
  const auto measured = [&](double position) { return outlet_->measured({{0, now_, position}}); };
  ASSERT_EQ(outlet_->pass(decisionOf(0.3), INF, time(), send()), Result::PUBLISHED);
  EXPECT_EQ(measured(0.0), "");
  now_ = 100.05;
  EXPECT_EQ(measured(0.012), "") << "it may have been at 0.3 m/s";
  EXPECT_EQ(sent().size(), 1u);
  now_ = 100.06;
  const std::string fault = measured(0.05);
  ASSERT_EQ(sent().size(), 2u);
  EXPECT_EQ(sent()[1].command[0], 0.0);
  EXPECT_EQ(sent()[1].reason, fault);
  EXPECT_EQ(outlet_->fault(), fault);
  EXPECT_EQ(measured(0.05), fault);
  EXPECT_EQ(sent().size(), 2u) << "zeros are sent once";
  settings_.deceleration = {2.0};
  LimiterLaw law(settings_);
  outlet_->tell(law, true);
  EXPECT_EQ(outlet_->pass(decisionOf(0.3), INF, time(), send()), Result::FAULT);
  EXPECT_EQ(sent().size(), 2u);
  now_ = 100.27;
  ASSERT_TRUE(waitFor(3));
  EXPECT_EQ(sent()[2].reason, fault) << "that nobody commands is not the news";
  now_ = 100.06;
  outlet_->tell(law, true);
  now_ = 101.05;
  EXPECT_NE(outlet_->fault(), "") << "a second after it was asked for";
  now_ = 101.07;
  EXPECT_EQ(outlet_->fault(), "");
  EXPECT_EQ(outlet_->pass(decisionOf(0.3), INF, time(), send()), Result::PUBLISHED);
}

TEST_F(Outlet, ARobotWithoutACommandIsSentNothing) {
  begin(0.2);
  EXPECT_EQ(outlet_->measured({{0, 100.0, 0.0}}), "");
  now_ = 100.01;
  EXPECT_NE(outlet_->measured({{0, now_, 1.0}}), "");
  EXPECT_TRUE(sent().empty());
  now_ = 100.02;
  outlet_->forgetMeasured();  // the clock has jumped
  outlet_->measured({{0, now_, 5.0}});
  now_ = 101.02;
  EXPECT_EQ(outlet_->fault(), "");
}

// A robot at 2 m/s; one decision, to go on slowly, takes so long that zeros are published instead.
TEST_F(Outlet, AfterAnOverrunTheRobotIsWhereTheNextTubeSays) {
  constexpr double STEP = 0.001, PERIOD = 0.02, SPEED = 2.0;
  for (const double took : {0.03, 0.10, 0.15, 0.20}) {
    SCOPED_TRACE(took);
    now_ = 100.0;
    sent_.clear();
    settings_.deceleration = {5.0};
    settings_.ramp_up = 1e6;
    settings_.command_timeout = 0.5;
    begin(settings_.command_timeout);
    LimiterLaw law(settings_);
    FreeSurroundings surroundings;
    SimulatedJoints robot({0.0}, settings_.deceleration);
    std::size_t nb_followed = 0;
    double now = 100.0;
    const auto follow = [&](double until) {
      for (; now < until; now += STEP) {
        const auto published = sent();
        for (; nb_followed < published.size(); ++nb_followed) {
          robot.command(now + settings_.reaction_time - STEP, published[nb_followed].command);
        }
        robot.step(now, STEP);
      }
      now_ = now;
    };
    const auto decide = [&](double speed, double seconds) {
      outlet_->tell(law, true);
      const auto arrived = time();
      const double by = now + 0.02, measured = robot.positions()[0];
      const auto decision = law.decide({by, now, 0.0, {speed}}, surroundings);
      follow(now + seconds);
      if (outlet_->pass(decision, by, arrived, send()) != Result::PUBLISHED) {
        outlet_->stop(law.stop("overrun"), send());
      }
      return measured;
    };
    for (int i = 0; i < 50; ++i) {
      decide(SPEED, STEP);
      follow(now + PERIOD - STEP);
    }
    decide(0.1 * SPEED, took);
    const double measured = decide(0.1 * SPEED, STEP);
    const StoppingTube tube = surroundings.tube;
    const double furthest =
        measured + std::max(tube.from[0], tube.to[0]) + tube.deviation[0] + 1e-6;
    outlet_.reset();  // it holds no longer
    sent_.push_back(decisionOf(0.0));
    follow(now + 2.0);
    EXPECT_LE(robot.positions()[0], furthest);
    EXPECT_GT(robot.positions()[0], furthest - 0.6) << "the bound is of this robot";
  }
}

}  // namespace collision_pairs::test_command_outlet
