// When a frame is static, when it moves, and when that is not to be told.
#include <gtest/gtest.h>

#include "transform_kind.h"

namespace collision_pairs {
namespace {

constexpr StampNs SECOND = 1000000000, AGE = SECOND;

StampNs at(double seconds) { return static_cast<StampNs>(seconds * 1e9); }

/// From the stamp on, and not a nanosecond before.
void expectFrom(const TransformKind& frame, StampNs stamp, TransformKind::Kind before,
                TransformKind::Kind from) {
  EXPECT_EQ(frame.at(stamp - 1), before) << stamp;
  EXPECT_EQ(frame.at(stamp), from) << stamp;
}

TEST(TransformKind, IsUnheardAndThenAsItWasHeardFirstAtAnyStamp) {
  EXPECT_EQ(TransformKind().at(at(1)), TransformKind::UNHEARD);
  TransformKind moves, is_static;
  moves.noteMoving(at(10), AGE);
  is_static.noteStatic(at(10), AGE, false);
  for (const double seconds : {0.0, 10.0, 100.0}) {
    EXPECT_EQ(moves.at(at(seconds)), TransformKind::MOVES);
    EXPECT_EQ(is_static.at(at(seconds)), TransformKind::STATIC);
  }
}

TEST(TransformKind,
     IsAmbiguousFromAnAgeBeforeTheFirstOfTheOtherKindToAnAgeAfterTheLastOfTheSilent) {
  TransformKind frame;
  frame.noteMoving(at(9.5), AGE);
  frame.noteStatic(at(10), AGE, false);
  expectFrom(frame, at(9) + 1, TransformKind::MOVES, TransformKind::AMBIGUOUS);
  expectFrom(frame, at(11), TransformKind::AMBIGUOUS, TransformKind::MOVES);
  frame.noteMoving(at(10.5), AGE);
  expectFrom(frame, at(11), TransformKind::AMBIGUOUS, TransformKind::MOVES);
  frame.noteStatic(at(10.75), AGE, true);
  expectFrom(frame, at(11.5), TransformKind::AMBIGUOUS, TransformKind::STATIC);
  frame.noteStatic(at(12), AGE, true);  // by now it is settled
  expectFrom(frame, at(9) + 1, TransformKind::MOVES, TransformKind::AMBIGUOUS);
  expectFrom(frame, at(11.5), TransformKind::AMBIGUOUS, TransformKind::STATIC);
  frame.noteMoving(at(20), AGE);
  expectFrom(frame, at(19) + 1, TransformKind::STATIC, TransformKind::AMBIGUOUS);
  expectFrom(frame, at(21), TransformKind::AMBIGUOUS, TransformKind::STATIC);
  frame.noteMoving(at(20.5), AGE);
  frame.noteMoving(at(22), AGE);  // the other one was silent, and this goes on
  expectFrom(frame, at(21), TransformKind::AMBIGUOUS, TransformKind::MOVES);
  EXPECT_EQ(frame.at(at(30)), TransformKind::MOVES);
  expectFrom(frame, at(9) + 1, TransformKind::MOVES, TransformKind::AMBIGUOUS);
}

// Of more conflicts than are kept one by one, whatever lies between the last two is ambiguous.
TEST(TransformKind, IsAmbiguousInEachOfAnyNumberOfConflicts) {
  constexpr int CONFLICTS = 1200;
  TransformKind frame;
  const auto begin = [](int i) { return at(10.0 * i); };
  for (int i = 1; i <= CONFLICTS; ++i) {
    frame.noteMoving(begin(i), AGE);
    frame.noteStatic(begin(i) + SECOND / 2, AGE, true);
    frame.noteMoving(begin(i) + 5 * SECOND, AGE);
  }
  for (int i = 1; i <= CONFLICTS; ++i) {
    ASSERT_EQ(frame.at(begin(i) + SECOND / 2), TransformKind::AMBIGUOUS) << i;
  }
}

TEST(TransformKind, BecomesStaticLongAfterItMovedIfThatIsSaidTwice) {
  for (const bool again : {false, true}) {
    TransformKind frame;
    frame.noteMoving(at(9) - 1, AGE);
    frame.noteStatic(at(10), AGE, again);
    expectFrom(frame, at(10), TransformKind::MOVES,
               again ? TransformKind::STATIC : TransformKind::MOVES);
    TransformKind just_now;
    just_now.noteMoving(at(9), AGE);
    just_now.noteStatic(at(10), AGE, again);
    EXPECT_EQ(just_now.at(at(10)), TransformKind::AMBIGUOUS);
  }
}

TEST(TransformKind, StaysAmbiguousForeverWithoutALimitOfAge) {
  TransformKind frame;
  frame.noteMoving(at(1), NEVER);
  frame.noteStatic(at(10), NEVER, true);
  frame.noteMoving(at(1000), NEVER);
  for (const double seconds : {0.0, 10.0, 1e6}) {
    EXPECT_EQ(frame.at(at(seconds)), TransformKind::AMBIGUOUS);
  }
}

TEST(TransformKind, StaysWhatItWasWhenTheClockGoesBack) {
  for (const bool was_static : {false, true}) {
    const auto kind = was_static ? TransformKind::STATIC : TransformKind::MOVES;
    TransformKind frame;
    frame.restart(at(3), AGE);
    EXPECT_EQ(frame.at(at(3)), TransformKind::UNHEARD);
    was_static ? frame.noteStatic(at(10), AGE, true) : frame.noteMoving(at(10), AGE);
    TransformKind ambiguous = frame;
    frame.restart(at(3), AGE);
    for (const double seconds : {0.0, 3.0, 10.0}) EXPECT_EQ(frame.at(at(seconds)), kind);
    was_static ? ambiguous.noteMoving(at(10.5), AGE) : ambiguous.noteStatic(at(10.5), AGE, true);
    ambiguous.restart(at(3), AGE);
    expectFrom(ambiguous, at(2) + 1, kind, TransformKind::AMBIGUOUS);
    expectFrom(ambiguous, at(4), TransformKind::AMBIGUOUS, kind);
  }
}

}  // namespace
}  // namespace collision_pairs
