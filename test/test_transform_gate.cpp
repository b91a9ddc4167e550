// The rules by which transforms are admitted, one test each, and what is kept is bounded.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "frame_ways.h"
#include "random_inputs.h"
#include "refusal.h"

namespace collision_pairs::test_transform_gate {

using Eigen::Vector3d;
using testing::HasSubstr;

StampNs at(double seconds) { return static_cast<StampNs>(std::llround(seconds * 1e9)); }

const std::string BOTH = "it is published both on /tf and on /tf_static";

/// Frame "a" in "root", by default sent at its stamp.
class Gate : public testing::Test {
 protected:
  std::string send(double stamp, double x, const std::string& publisher = "/one",
                   const std::string& parent = "root") {
    return buffer_.take({parent, "a", at(stamp), {x, 0, 0}, Eigen::Quaterniond::Identity()}, false,
                        publisher, at(now_ < 0 ? stamp : now_));
  }
  std::string sendStatic(double now, double x, const std::string& publisher = "/one") {
    return buffer_.take({"root", "a", 0, {x, 0, 0}, Eigen::Quaterniond::Identity()}, true,
                        publisher, at(now));
  }
  /// Not a number if it is unknown.
  double xAt(double stamp) const { return x({Instant::AT, at(stamp)}); }
  double newestX(double now) const { return x({Instant::NEWEST, at(now)}); }
  std::string whyNot(double now) const {
    return refusal([&] { poseBetween(buffer_, "root", "a", {Instant::NEWEST, at(now)}); });
  }

  TransformBuffer buffer_{PoseLimits{1.0, 0.5, 0.25}};
  double now_ = -1.0;  ///< the clock, if it is not at the stamps

 private:
  double x(const Instant& instant) const {
    try {
      return poseBetween(buffer_, "root", "a", instant).X_TS.translation().x();
    } catch (const InputError&) {
      return std::nan("");
    }
  }
};

TEST_F(Gate, Rule1StampsThatAreNoneOrAheadOrOldAreRefused) {
  now_ = 100.0;
  EXPECT_EQ(send(0.0, 1.0), "its stamp is zero");
  EXPECT_THAT(send(100.26, 1.0), HasSubstr("ahead of the clock"));
  EXPECT_THAT(send(98.99, 1.0), HasSubstr("old when it arrived"));
  EXPECT_THAT(whyNot(100.0), HasSubstr("TF does not connect")) << "nothing of it was taken";
}

TEST_F(Gate, Rule2BetweenSamplesOfOnePublisherAPoseIsKnownUnlessTheyAreTooFarApart) {
  send(10.0, 0.0);
  send(10.5, 1.0);
  send(11.0625, 2.0);
  EXPECT_DOUBLE_EQ(xAt(10.25), 0.5);
  EXPECT_TRUE(std::isnan(xAt(10.75)));
  EXPECT_DOUBLE_EQ(xAt(11.0625), 2.0);
  send(11.3125, 3.0);
  EXPECT_DOUBLE_EQ(xAt(11.1875), 2.5);
  EXPECT_TRUE(std::isnan(xAt(10.75))) << "still";
}

TEST_F(Gate, Rule2BetweenSamplesOfTwoPublishersAPoseIsKnownWhereOneOfThemSpansIt) {
  send(10.0, 0.0, "/one");
  send(10.25, 0.25, "/two");
  EXPECT_TRUE(std::isnan(xAt(10.125))) << "nobody says that the two follow each other";
  EXPECT_DOUBLE_EQ(xAt(10.25), 0.25);
  send(10.5, 0.5, "/one");
  EXPECT_DOUBLE_EQ(xAt(10.125), 0.125);
  EXPECT_DOUBLE_EQ(xAt(10.375), 0.375);
}

TEST_F(Gate, Rule3AndRule4PublishersThatContradictEachOtherAreSuspectForAnAgeBeforeAndAfter) {
  for (double t = 10.0; t < 13.0; t += 0.125) send(t, t - 10.0, "/one");
  now_ = 12.9375;
  EXPECT_THAT(send(12.0625, 7.0, "/two"), HasSubstr("'/one' and '/two' both publish it"));
  EXPECT_DOUBLE_EQ(xAt(11.875), 1.875) << "more than an age before it was noticed";
  for (const double suspect : {12.0, 12.5, 12.875}) EXPECT_TRUE(std::isnan(xAt(suspect)));
  now_ = -1.0;
  for (double t = 13.0; t < 15.0; t += 0.125) send(t, t - 10.0, "/one");
  EXPECT_TRUE(std::isnan(xAt(13.0)));
  EXPECT_DOUBLE_EQ(xAt(13.25), 3.25) << "more than an age after it";
}

TEST_F(Gate, Rule4FromASuspectSampleNothingIsInterpolatedBeyondTheSuspectSpanThatCameLater) {
  for (int i = 0; i < 10; ++i) send(100.0 + 0.1 * i, 0.0);
  now_ = 101.0;
  send(101.2, 0.0);
  EXPECT_EQ(xAt(101.1), 0.0);
  send(100.05, 3.0, "/two");  // until 101.05
  EXPECT_TRUE(std::isnan(xAt(101.0)));
  EXPECT_TRUE(std::isnan(xAt(101.1))) << "between 100.9 and 101.2";
  EXPECT_EQ(xAt(101.2), 0.0);
}

TEST_F(Gate, Rule3OnePublisherInTwoSequencesContradictsItself) {
  for (double t = 10.0; t < 12.0; t += 0.125) send(t, 0.0);
  now_ = 11.875;
  EXPECT_THAT(send(11.0625, 3.0), HasSubstr("'/one' publishes it in two sequences"));
  EXPECT_TRUE(std::isnan(xAt(11.5)));
}

TEST_F(Gate, Rule5AFrameOfBothKindsIsSuspectUntilOneIsSilentForAnAge) {
  for (double t = 10.0; t < 12.0; t += 0.125) send(t, t);
  EXPECT_THAT(sendStatic(12.0, 5.0), HasSubstr(BOTH));
  for (double t = 12.0; t < 13.0; t += 0.125) {
    EXPECT_THAT(send(t, t), HasSubstr(BOTH));
    EXPECT_THAT(whyNot(t), HasSubstr(BOTH));
  }
  EXPECT_EQ(send(13.0, 13.0), "");
  EXPECT_DOUBLE_EQ(newestX(13.0), 13.0);
  EXPECT_TRUE(std::isnan(newestX(20.0))) << "when it ends the static one does not take over";
}

// The same where the moving one was silent, a static one came, and the moving one resumes.
TEST_F(Gate, Rule5AStaticTransformDuringASilenceCountsAgainstWhatResumes) {
  RandomInputs random;
  for (int i = 0; i < 100; ++i) {
    const double silent = 10.0 + random.uniform(1.1, 5.0),
                 resumes = silent + random.uniform(0.0, 0.9);
    buffer_.restart(at(1.0));
    for (double t = 9.0; t < 10.0; t += 0.125) send(t, t);
    sendStatic(silent, 5.0, "/mistaken");
    for (double t = resumes; t < silent + 0.99; t += 0.1) {
      EXPECT_THAT(send(t, t), HasSubstr(BOTH)) << silent << ' ' << t;
      EXPECT_TRUE(std::isnan(newestX(t))) << silent << ' ' << t;
    }
    for (double t = resumes + 2.1; t < resumes + 2.5; t += 0.1) send(t, t);
    EXPECT_FALSE(std::isnan(newestX(resumes + 2.5))) << "nothing static was heard for an age";
  }
}

TEST_F(Gate, Rule6AStaticFrameMovesAfterAnAgeOfMovingTransformsAndNotAfterOne) {
  sendStatic(10.0, 5.0);
  send(20.0, 1.0);
  EXPECT_TRUE(std::isnan(newestX(20.5)));
  EXPECT_DOUBLE_EQ(newestX(21.125), 5.0);
  for (double t = 30.0; t < 31.5; t += 0.125) send(t, t);
  EXPECT_DOUBLE_EQ(newestX(31.375), 31.375);
  EXPECT_TRUE(std::isnan(xAt(25.0))) << "then it was static";
}

TEST_F(Gate, Rule6AFrameThatMovedBecomesStaticIfThatIsSaidTwice) {
  for (double t = 10.0; t < 11.0; t += 0.125) send(t, t);
  EXPECT_THAT(sendStatic(15.0, 5.0), HasSubstr("does not count before it is sent again"));
  EXPECT_TRUE(std::isnan(newestX(15.0)));
  EXPECT_EQ(sendStatic(16.0, 5.0), "");
  EXPECT_DOUBLE_EQ(newestX(16.0), 5.0);
  EXPECT_TRUE(std::isnan(xAt(10.5))) << "then it moved";
}

TEST_F(Gate, Rule7AndRule8OfStaticPosesThatContradictTheNewestSentTwiceCounts) {
  RandomInputs random;
  for (int i = 0; i < 200; ++i) {
    TransformBuffer fresh(PoseLimits{1.0, 0.5, 0.25});
    const int nb_nodes = random.integer(2, 6);
    double now = 10.0;
    const auto node = [](int n) { return "/node_" + std::to_string(n); };
    const auto take = [&](int n, double x) {
      now += random.uniform(0.0, 0.3);
      return fresh.take({"root", "a", 0, {x, 0, 0}, Eigen::Quaterniond::Identity()}, true, node(n),
                        at(now));
    };
    const auto known = [&](double later) {
      try {
        return poseBetween(fresh, "root", "a", {Instant::NEWEST, at(now + later)})
            .X_TS.translation()
            .x();
      } catch (const InputError&) {
        return std::nan("");
      }
    };
    EXPECT_EQ(take(0, 0.0), "");
    EXPECT_EQ(known(0.0), 0.0) << "by one node alone";
    for (int n = 1; n < nb_nodes; ++n) {
      EXPECT_THAT(take(n, n), HasSubstr("contradict each other on /tf_static"));
      EXPECT_TRUE(std::isnan(known(1e6))) << "for ever, unless one is sent again";
    }
    const int again = random.integer(0, nb_nodes - 1);
    const bool by_another = random.integer(0, 1) == 1;
    take(by_another ? nb_nodes : again, again);
    EXPECT_EQ(known(1.01), again) << nb_nodes << " nodes, again " << again;
  }
}

TEST_F(Gate, Rule7ANodeThatSendsAnotherStaticPoseIsNotSaidToContradictItself) {
  sendStatic(10.0, 1.0);
  sendStatic(11.0, 1.0, "/two");
  EXPECT_THAT(sendStatic(12.0, 2.0), HasSubstr("the newest pose was sent once; send it again"));
  EXPECT_THAT(sendStatic(13.0, 3.0, "/two"), HasSubstr("'/one' and '/two' contradict each other"));
  EXPECT_THAT(whyNot(1e6), HasSubstr("'/one' and '/two' contradict each other"));
}

TEST_F(Gate, Rule8ASuspicionOfWhenAFrameWasStaticBeforeIsOverIfItsPoseIsSentTwiceMeanwhile) {
  sendStatic(10.0, 1.0);
  sendStatic(11.0, 1.0, "/two");
  sendStatic(12.0, 2.0);  // once: suspect
  for (double t = 20.0; t < 21.5; t += 0.125) send(t, t);
  sendStatic(21.5, 3.0);
  for (double t = 21.5; t < 22.75; t += 0.125) sendStatic(t, 3.0);
  EXPECT_DOUBLE_EQ(newestX(22.75), 3.0);
}

TEST_F(Gate, Rule9StampsBeforeAStaticPoseChangesAreSuspectHoweverLongAgo) {
  sendStatic(10.0, 1.0);
  EXPECT_EQ(xAt(5.0), 1.0);
  sendStatic(20.0, 2.0);
  EXPECT_EQ(xAt(100.0), 2.0);
  for (const double t : {20.0, 25.0, 50.0}) {
    sendStatic(t, 2.0);
    for (const double before : {5.0, 15.0, 19.5}) EXPECT_TRUE(std::isnan(xAt(before))) << t;
    EXPECT_EQ(xAt(20.0), 2.0);
  }
}

TEST_F(Gate, Rule10WhenTheClockGoesBackStaticPosesStay) {
  sendStatic(10.0, 1.0);
  buffer_.take({"a", "b", at(10.0), {1, 0, 0}, Eigen::Quaterniond::Identity()}, false, "",
               at(10.0));
  buffer_.restart(at(3.0));
  EXPECT_EQ(newestX(3.0), 1.0);
  EXPECT_THROW(poseBetween(buffer_, "a", "b", {Instant::AT, at(10.0)}), InputError);
}

TEST_F(Gate, PosesOfOtherFramesGoOnWhereAStaticOneChanges) {
  const auto sendOther = [&](double t) {
    buffer_.take({"root", "b", at(t), {t, 0, 0}, Eigen::Quaterniond::Identity()}, false, "/one",
                 at(t));
  };
  const auto other = [&](double t) {
    return poseBetween(buffer_, "root", "b", {Instant::AT, at(t)}).X_TS.translation().x();
  };
  sendStatic(9.0, 1.0);
  for (double t = 10.0; t < 14.0; t += 0.125) {
    sendOther(t);
    if (t > 11.0) sendStatic(t + 0.0625, t, "/one");
    if (t > 10.0) {
      EXPECT_NEAR(other(t - 0.03125), t - 0.03125, 1e-9);
    }
  }
  for (double t = 10.0; t < 13.8; t += 0.0625) EXPECT_NEAR(other(t), t, 1e-9);
}

TEST_F(Gate, NamesThatTf2WouldChangeAreRefused) {
  const auto take = [&](const char* parent, const char* child) {
    return buffer_.take({parent, child, 0, {0, 0, 0}, Eigen::Quaterniond::Identity()}, true, "",
                        at(1.0));
  };
  EXPECT_EQ(take("root", "/a"), "") << "as tf wrote them";
  EXPECT_THAT(take("root", "//a"), HasSubstr("two slashes"));
  EXPECT_THAT(take("//root", "a"), HasSubstr("two slashes"));
}

/// Whatever is sent of a frame.
TEST(TransformGate, KeepsABoundedAmountOfAFrame) {
  RandomInputs random;
  TransformBuffer buffer(PoseLimits{1.0, 0.5, 0.25});
  std::size_t most = 0;
  double now = 10.0;
  for (int i = 0; i < 200000; ++i) {
    now += random.uniform(0.0, 0.02);
    const bool is_static = random.integer(0, 2) == 0;
    const std::string by = "/node_" + std::to_string(random.integer(0, 99));
    buffer.take({"root", "a", at(now - random.uniform(-0.2, 1.0)), random.vector(-9.0, 9.0),
                 Eigen::Quaterniond::Identity()},
                is_static, by, at(now));
    if (i > 10000) most = std::max(most, buffer.gate().nbKept(buffer.findFrame("a")));
  }
  EXPECT_LT(most, 3000u);
}

TEST(TransformGate, KeepsOnePoseOfAStaticFrameThatChangesAHundredThousandTimes) {
  TransformBuffer buffer(PoseLimits{1.0, 0.5, 0.25});
  for (int i = 0; i < 119000; ++i) {
    buffer.take({"root", "a", 0, {1e-3 * i, 0, 0}, Eigen::Quaterniond::Identity()}, true, "/one",
                at(10.0 + 0.01 * i));
  }
  EXPECT_LT(buffer.gate().nbKept(buffer.findFrame("a")), 20u);
}

}  // namespace collision_pairs::test_transform_gate
