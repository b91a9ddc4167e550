// Whose transforms are not believed: publishers that contradict each other, frames of both kinds.
#include <atomic>
#include <cmath>
#include <thread>

#include <gmock/gmock.h>

#include "random_inputs.h"
#include "transform_test.h"

namespace collision_pairs::test_suspect_transforms {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

TEST_F(Transforms, AboveACommonParentDoNotMatter) {
  input_.take(linkAt("a", ros::Time(0), 1.0), true, now_);
  receive("a", 999.5, 1.0);
  for (const char* child : {"b", "c"}) {
    auto message = linkAt(child, now_, 1.0);
    message.transforms[0].header.frame_id = "a";
    input_.take(message, false, now_);
  }
  EXPECT_NO_THROW(input_.lookUp("b", "c", ros::Time(0)));
  EXPECT_THROW(input_.lookUp("root", "c", ros::Time(0)), InputError);
}

TEST_F(Transforms, OfOneFrameAreTakenFromSixteenPublishersAndNoMore) {
  for (int i = 1; i <= 17; ++i) {
    EXPECT_THAT(input_.refused(), IsEmpty()) << i;
    receiveBy("/node_" + std::to_string(i), "a", 999.9 + 0.001 * i, 0.0);
  }
  EXPECT_THAT(input_.refused(), ElementsAre(HasSubstr("too many nodes publish it")));
  receiveBy("/node_17", "b", 999.9, 0.0);
  EXPECT_TRUE(knows("b"));
  EXPECT_EQ(input_.refused().size(), 1u);
}

TEST_F(Transforms, AheadOfTheClockAreNoNewerThanPresentOnes) {
  receiveBy("/ahead", "a", 1000.4, 7.0);
  EXPECT_EQ(newestOf("a"), 7.0) << "there is no other";
  receiveBy("/present", "a", 999.99, 1.0);
  EXPECT_EQ(newestOf("a"), 1.0);
  // Its time comes, but then it contradicts the other one.
  play(1000.0, 1001.0, [&] {
    receiveBy("/ahead", "a", now_.toSec() + 0.45, 7.0);
    receiveBy("/present", "a", now_.toSec(), 1.0);
    if (knows("a")) {
      EXPECT_EQ(newestOf("a"), 1.0);
    }
  });
  EXPECT_THAT(whyNot("a"), HasSubstr("'/ahead' and '/present'"));
}

TEST_F(Transforms, OfASingleMistakenStaticMessageAreNotBelievedWhereTheOtherPublisherEnds) {
  play(1000.0, 1000.5, [&] { receive("a", now_.toSec(), 1.0); });
  now_ = ros::Time(1000.6);
  receiveBy("/mistaken", "a", 0.0, 5.0, true);
  for (const double later : {1000.7, 1001.5, 1001.7, 1010.0}) {
    now_ = ros::Time(later);
    input_.followClock(now_);
    EXPECT_FALSE(knows("a")) << later;
  }
}

TEST_F(Transforms, AreNotInterpolatedFromOneThatIsSuspect) {
  receive("a", 999.9, 1.0);
  receiveBy("/mistaken", "a", 0.0, 5.0, true);
  for (const double stamp : {1000.75, 1001.25}) {  // suspect until 1001.0
    now_ = ros::Time(stamp);
    receive("a", stamp, 1.0);
  }
  EXPECT_FALSE(knows("a", ros::Time(1000.75)));
  EXPECT_FALSE(knows("a", ros::Time(1001.125)));
  EXPECT_TRUE(knows("a", ros::Time(1001.25)));
  now_ = ros::Time(1001.5);
  receive("a", 1001.5, 1.0);
  EXPECT_TRUE(knows("a", ros::Time(1001.375)));
}

// Either kind is silent for about as long as it takes, and either is heard first again. A pose that
// moves is the time since 1,000 s; static ones are a million, or one more.
TEST_F(Transforms, OfAFrameThatChangesItsKindAreThoseOfTheKindThatIsHeard) {
  RandomInputs random;
  int nb_static = 0, nb_moving = 0;
  double now = 1000.0;
  for (int round = 0; round < 600; ++round) {
    const std::string hand = "hand" + std::to_string(round);
    double moved = 0.0, fixed = 0.0;  // s: when either was heard
    for (int i = 0; i < 40; ++i) {
      now += random.integer(0, 3) > 0 ? random.uniform(0.0, 0.2) : random.uniform(0.8, 1.2);
      now_ = ros::Time(now);
      input_.followClock(now_);
      const int kind = random.integer(0, 9);
      const std::string by = random.integer(0, 4) > 0 ? "one" : "other";
      if (kind < 5) {
        receiveBy(by, hand, now, now - 1000.0);
        moved = now;
      } else if (kind < 9) {
        receiveBy(by, hand, 0.0, 1e6 + random.integer(0, 1), true);
        fixed = now;
      } else if (random.integer(0, 3) == 0) {  // a new buffer, as of the clock that goes back
        receiveBy("x", hand + "_" + std::to_string(i), 0.0, 0.0, true);
        receiveBy("x", hand + "_" + std::to_string(i), 0.0, 1.0, true);
        receiveBy("x", hand + "_" + std::to_string(i), 0.0, 1.0, true);
      }
      if (!knows(hand, now_)) continue;
      const double x = input_.lookUp("root", hand, now_).X_TS.translation().x();
      const bool is_static = x > 1e6 - 0.5;
      ++(is_static ? nb_static : nb_moving);
      ASSERT_TRUE(is_static || std::abs(x - (now - 1000.0)) < 1e-6) << round << ": " << x;
      ASSERT_FALSE(is_static && now - moved < 0.99) << round << ": it is ambiguous";
      ASSERT_FALSE(!is_static && now - fixed < 0.99) << round << ": it is ambiguous";
    }
  }
  EXPECT_GT(nb_static, 1000);
  EXPECT_GT(nb_moving, 1000);
}

TEST_F(Transforms, ThatContradictEachOtherWhileTheFrameStillCountsAsStaticAreSuspectOnceItMoves) {
  receiveBy("other", "hand", 0.0, 5.0, true);
  play(1001.5, 1002.3, [&] { receiveBy("one", "hand", now_.toSec(), 1.0); });
  receiveBy("other", "hand", 1002.29, 9.0);
  play(1002.3, 1002.6, [&] { receiveBy("one", "hand", now_.toSec(), 1.0); });
  EXPECT_THAT(whyNot("hand"), HasSubstr("contradict"));
  play(1002.6, 1003.4, [&] { receiveBy("one", "hand", now_.toSec(), 1.0); });
  EXPECT_EQ(newestOf("hand"), 1.0);
}

// By a sample it is found to be static, and its newest pose was sent by one of two nodes, once.
TEST_F(Transforms, OfAFrameThatBecomesStaticAreSuspectUntilAnAmbiguousPoseIsSentAgain) {
  receive("hand", 1000.0, 1.0);
  now_ = ros::Time(1000.5);
  receiveBy("one", "hand", 0.0, 5.0, true);
  now_ = ros::Time(1000.9);
  receiveBy("two", "hand", 0.0, 7.0, true);
  now_ = ros::Time(1001.6);
  receive("hand", 1001.6, 1.0);
  now_ = ros::Time(1004.0);
  input_.followClock(now_);
  EXPECT_THAT(whyNot("hand"), HasSubstr("sent once"));
  receiveBy("two", "hand", 0.0, 7.0, true);
  now_ = ros::Time(1005.5);
  input_.followClock(now_);
  EXPECT_EQ(newestOf("hand"), 7.0);
}

// What makes a frame static again is a sample that comes after its silence.
TEST_F(Transforms, OfAFrameThatIsFoundToBeStaticByASampleThatMovesItSurviveAnotherClock) {
  receive("hand", 1000.0, 1.0);
  now_ = ros::Time(1000.5);
  receiveBy("other", "hand", 0.0, 5.0, true);
  now_ = ros::Time(1000.9);
  receiveBy("other", "hand", 0.0, 5.0, true);
  now_ = ros::Time(1001.6);
  receive("hand", 1001.6, 1.0);
  EXPECT_FALSE(knows("hand"));
  now_ = ros::Time(10.0);
  input_.followClock(now_);
  EXPECT_FALSE(knows("hand")) << "it is heard on both";
  now_ = ros::Time(12.0);
  receiveBy("other", "hand", 0.0, 5.0, true);
  EXPECT_EQ(newestOf("hand"), 5.0);
}

TEST_F(Transforms, OfMoreFramesThanAnyRobotHasAreRefused) {
  for (int i = 0; i < 20000; ++i) receive("f" + std::to_string(i), 1000.0, 1.0);
  EXPECT_LE(input_.buffer().frames().size(), 10000u);
  EXPECT_TRUE(knows("f0"));
  EXPECT_THAT(input_.refused(), testing::Contains(HasSubstr("more than 10000 frames")));
}

TEST_F(Transforms, ThatAGapPrecedesAreNeverInterpolatedOverItByAnotherThread) {
  receive("a", 1000.0, 0.0);
  std::atomic<bool> ends{false}, is_bridged{false};
  std::thread reader([&] {
    while (!ends) is_bridged = is_bridged || knows("a", ros::Time(1001.0));
  });
  now_ = ros::Time(1002.0);
  receive("a", 1002.0, 1.0);
  ends = true;
  reader.join();
  EXPECT_FALSE(is_bridged);
  EXPECT_FALSE(knows("a", ros::Time(1001.0)));
}

}  // namespace collision_pairs::test_suspect_transforms
