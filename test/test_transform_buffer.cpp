// Against tf2's own buffer, which is what the node asks.
#include <algorithm>
#include <cmath>
#include <random>

#include <gtest/gtest.h>
#include <tf2/buffer_core.h>
#include <tf2/exceptions.h>

#include "random_inputs.h"
#include "robot_poses.h"

namespace collision_pairs::test_transform_buffer {

using Eigen::Isometry3d;
using Eigen::Quaterniond;
using Eigen::Vector3d;

constexpr StampNs SECOND = 1000000000;
const Quaterniond NO_TURN = Quaterniond::Identity();

geometry_msgs::TransformStamped toMessage(const std::string& parent, const std::string& child,
                                          StampNs stamp, const Vector3d& p, const Quaterniond& R) {
  geometry_msgs::TransformStamped message;
  message.header.frame_id = parent;
  message.child_frame_id = child;
  message.header.stamp.fromNSec(static_cast<std::uint64_t>(stamp));
  message.transform.translation.x = p.x();
  message.transform.translation.y = p.y();
  message.transform.translation.z = p.z();
  message.transform.rotation.x = R.x();
  message.transform.rotation.y = R.y();
  message.transform.rotation.z = R.z();
  message.transform.rotation.w = R.w();
  return message;
}

bool ask(const tf2::BufferCore& buffer, const std::string& root, const std::string& frame,
         StampNs stamp, Isometry3d& X) {
  try {
    ros::Time time;
    time.fromNSec(static_cast<std::uint64_t>(stamp));
    const auto found = buffer.lookupTransform(root, frame, time).transform;
    const auto& p = found.translation;
    X = Isometry3d::Identity();
    X.linear() = Quaterniond(found.rotation.w, found.rotation.x, found.rotation.y, found.rotation.z)
                     .toRotationMatrix();
    X.translation() = Vector3d(p.x, p.y, p.z);
    return true;
  } catch (const tf2::TransformException&) {
    return false;
  }
}

TEST(TransformBuffer, PosesAreThoseOfTf2AtAnyInstantInAnyOrderOfArrival) {
  const std::vector<std::pair<std::string, std::string>> tree = {
      {"map", "odom"}, {"odom", "base"}, {"base", "a"}, {"a", "b"}, {"base", "c"}};
  std::mt19937 random(givenSeed());
  for (int round = 0; round < 20; ++round) {
    SCOPED_TRACE("round " + std::to_string(round));
    std::uniform_real_distribution<double> any(-1.0, 1.0);
    std::vector<geometry_msgs::TransformStamped> messages;
    for (const auto& [parent, child] : tree) {
      const Vector3d way(any(random), any(random), any(random)), axis = Vector3d(way).normalized();
      double gone = any(random);  // always on, or else it would be two publishers' by its looks
      for (int i = 0; i < 20; ++i) {
        const StampNs stamp =
            100 * SECOND + i * SECOND / 10 + static_cast<StampNs>(any(random) * 4e7);
        gone += 0.05 + 0.04 * any(random);
        const Quaterniond R(Eigen::AngleAxisd(gone, axis));
        messages.push_back(toMessage(parent, child, stamp, gone * way, R));
      }
    }
    std::shuffle(messages.begin(), messages.end(), random);
    tf2::BufferCore buffer;
    TransformBuffer tracks(PoseLimits{0.0, 10.0, 0.5});
    for (const auto& m : messages) {
      buffer.setTransform(m, "test");
      const auto& p = m.transform.translation;
      const auto& q = m.transform.rotation;
      tracks.take(
          {"/" + m.header.frame_id, m.child_frame_id, static_cast<StampNs>(m.header.stamp.toNSec()),
           Vector3d(p.x, p.y, p.z), Quaterniond(q.w, q.x, q.y, q.z)},
          false, "", 110 * SECOND);
    }
    int nb_known = 0;
    for (int i = 0; i < 60; ++i) {
      const StampNs stamp = 100 * SECOND + i * SECOND / 25;
      const int base = tracks.findFrame("base");
      const FrameWays ways(tracks, base, {Instant::AT, stamp});
      for (const std::string frame : {"map", "odom", "a", "b", "c"}) {
        Isometry3d expected = Isometry3d::Identity();
        const bool known = ask(buffer, "base", frame, stamp, expected);
        const int number = tracks.findFrame(frame);
        ASSERT_EQ(ways.to(number).is_known, known) << frame << " at " << i;
        if (known) {
          const Isometry3d found = ways.poseOf(number, ways.to(number), stamp);
          EXPECT_LT((found.matrix() - expected.matrix()).cwiseAbs().maxCoeff(), 1e-12);
        }
        nb_known += known;
      }
    }
    EXPECT_GT(nb_known, 100);
  }
}

class OneTrack : public testing::Test {
 protected:
  bool known(StampNs stamp, double& x) {
    const int base = tracks_.findFrame("base"), arm = tracks_.findFrame("arm");
    if (!FrameWays(tracks_, base, {Instant::AT, stamp}).to(arm).is_known) return false;
    x = tracks_.poseBelow(base, arm, stamp).translation().x();
    return true;
  }
  void add(double seconds, double x, bool is_static = false) {
    take("base", "arm", seconds, Vector3d(x, 0, 0), is_static);
  }
  std::string take(const std::string& parent, const std::string& child, double seconds,
                   const Vector3d& p, bool is_static = false, const Quaterniond& R = NO_TURN) {
    const auto stamp = static_cast<StampNs>(seconds * 1e9);
    now_ = std::max(now_, stamp);
    return tracks_.take({parent, child, stamp, p, R}, is_static, "", now_);
  }
  StampNs now_ = 0;
  TransformBuffer tracks_{PoseLimits{0.0, 1.0, 0.5}};
  double x_ = 0.0;
};

TEST_F(OneTrack, OneWayHasItsPoseAtEachStampWhateverWasAskedBefore) {
  for (const double seconds : {10.0, 10.5}) {
    add(seconds, seconds - 9.0);
    take("arm", "hand", seconds, Vector3d(4, 0, 0));
  }
  const int base = tracks_.findFrame("base");
  const FrameWays ways(tracks_, base, {Instant::NEWEST, 11 * SECOND});
  const auto at = [&](double seconds, const char* name) {
    const int frame = tracks_.findFrame(name);
    return ways.poseOf(frame, ways.to(frame), static_cast<StampNs>(seconds * 1e9))
        .translation()
        .x();
  };
  EXPECT_DOUBLE_EQ(at(10, "arm"), 1.0);
  EXPECT_DOUBLE_EQ(at(10, "hand"), 5.0);
  EXPECT_DOUBLE_EQ(at(10.5, "hand"), 5.5);
  EXPECT_DOUBLE_EQ(at(10.25, "arm"), 1.25);
  EXPECT_DOUBLE_EQ(at(10.25, "hand"), 5.25);
}

TEST_F(OneTrack, NothingIsKnownBeforeTheFirstAndAfterTheLastSample) {
  add(1, 1);
  add(2, 2);
  EXPECT_FALSE(known(SECOND - 1, x_));
  EXPECT_TRUE(known(2 * SECOND, x_));
  EXPECT_FALSE(known(2 * SECOND + 1, x_));
}

TEST_F(OneTrack, AGapOfExactlyTheLongestIsBridged) {
  add(1, 1);
  add(2, 3);
  ASSERT_TRUE(known(SECOND + SECOND / 2, x_));
  EXPECT_DOUBLE_EQ(x_, 2.0);
}

// tf2 would hold the earlier pose: whatever has moved meanwhile is elsewhere.
TEST_F(OneTrack, BetweenTwoParentsNothingIsKnown) {
  add(1, 1);
  EXPECT_EQ(take("other", "arm", 2, Vector3d(5, 0, 0)), "");
  ASSERT_TRUE(known(SECOND, x_));
  EXPECT_EQ(x_, 1.0);
  EXPECT_FALSE(known(SECOND + SECOND / 2, x_));
  EXPECT_EQ(tracks_.gate().whyUnknown(tracks_.findFrame("arm"), SECOND + SECOND / 2),
            "its parent changes between two of its transforms");
  EXPECT_FALSE(known(2 * SECOND, x_)) << "of the other parent nothing is known";
  take("base", "other", 2, Vector3d(10, 0, 0));
  ASSERT_TRUE(known(2 * SECOND, x_));
  EXPECT_EQ(x_, 15.0);
}

TEST_F(OneTrack, AFrameThatIsStaticAndMovesIsUnknownForeverWithoutALimitOfAge) {
  add(5, 7, true);
  add(6, 8);
  EXPECT_FALSE(known(6 * SECOND, x_));
}

TEST_F(OneTrack, OfEqualStampsTheFirstStaysIfTheyAgreeAndElseItIsSuspect) {
  add(1, 7);
  add(1, 7.00001);
  ASSERT_TRUE(known(SECOND, x_));
  EXPECT_EQ(x_, 7.0);
  add(1, 8);
  EXPECT_FALSE(known(SECOND, x_));
}

TEST_F(OneTrack, FramesInARingAreUnknownAndEndNothing) {
  add(1, 1);
  take("arm", "base", 1, Vector3d::Zero());
  take("y", "x", 1, Vector3d::Zero());
  take("x", "y", 1, Vector3d::Zero());
  const FrameWays ways(tracks_, tracks_.findFrame("base"), {Instant::AT, SECOND});
  EXPECT_FALSE(ways.to(tracks_.findFrame("x")).is_known);
  EXPECT_FALSE(ways.isPlaced(tracks_.findFrame("x")));
}

TEST_F(OneTrack, WhatIsRefusedIsRefusedInTheseWords) {
  const Vector3d here = Vector3d::Zero();
  EXPECT_EQ(take("base", "", 1, here), "a frame has no name");
  EXPECT_EQ(take("/", "arm", 1, here), "a frame has no name");
  EXPECT_EQ(take("arm", "/arm", 1, here), "it is its own parent");
  EXPECT_EQ(take("base", "arm", 0, here), "its stamp is zero");
  EXPECT_EQ(take("base", "arm", 0, here, true), "") << "a static one needs no stamp";
  const double nan = std::nan("");
  EXPECT_EQ(take("base", "bent", 1, {nan, 0, 0}), "it is not finite, or not a rotation");
  for (const double scale : {0.0, nan, 0.9989, 1.0011}) {
    EXPECT_EQ(take("base", "bent", 1, here, false, Quaterniond(scale, 0, 0, 0)),
              "it is not finite, or not a rotation");
  }
  EXPECT_EQ(tracks_.findFrame("bent"), -1);
  for (const double scale : {0.9991, 1.0009}) {
    EXPECT_EQ(take("base", "bent", 1, here, false, Quaterniond(0, 0, 0, scale)), "");
  }
  const int base = tracks_.findFrame("base"), bent = tracks_.findFrame("bent");
  EXPECT_TRUE(tracks_.gate().isKnown(bent, SECOND));
  const Isometry3d X = tracks_.poseBelow(base, bent, SECOND);
  EXPECT_TRUE(X.linear().isApprox(Vector3d(-1, -1, 1).asDiagonal().toDenseMatrix(), 1e-12));
  EXPECT_EQ(tracks_.parentAt(bent, SECOND), base);
}

TEST_F(OneTrack, WhyAPoseIsNotKnownIsSaidInTheseWords) {
  add(10, 1);
  add(10.5, 2);
  const int arm = tracks_.findFrame("arm"), base = tracks_.findFrame("base");
  const auto at = [](double seconds) { return static_cast<StampNs>(seconds * 1e9); };
  EXPECT_EQ(tracks_.gate().whyUnknown(base, at(10)), "TF does not say where it is");
  EXPECT_EQ(tracks_.gate().whyUnknown(arm, at(10.75)),
            "its newest transform is 0.25 s older than that stamp (no extrapolation)");
  EXPECT_EQ(tracks_.gate().whyUnknown(arm, at(9)),
            "no two of its transforms around that stamp are within 1.00 s of each other");
  TransformBuffer live(PoseLimits{1.0, 1.0, 0.5});
  live.take({"base", "arm", at(10), Vector3d::Zero(), NO_TURN}, false, "", at(10));
  const int root = live.findFrame("base"), link = live.findFrame("arm");
  const auto newest = [&](StampNs now) { return FrameWays(live, root, {Instant::NEWEST, now}); };
  EXPECT_EQ(newest(at(10)).whyNot(root), "TF does not say where it is");
  EXPECT_TRUE(newest(at(11)).to(link).is_known) << "just as old as may be";
  EXPECT_EQ(newest(at(11)).to(link).oldest, at(10));
  EXPECT_FALSE(newest(at(11) + 1).to(link).is_known);
  EXPECT_EQ(newest(at(12.5)).whyNot(link),
            "its newest transform is 2.50 s old, and max_pose_age is 1.00 s");
  live.restart(at(3));
  EXPECT_EQ(newest(at(3)).whyNot(link),
            "no transform of it was received since the clock went back");
}

TEST(StampLimits, AreThoseOfTheParametersInNanoseconds) {
  const StampLimits limits({0.25, 0.5, 0.125});
  EXPECT_EQ(limits.max_age, SECOND / 4);
  EXPECT_EQ(limits.max_gap, SECOND / 2);
  EXPECT_EQ(limits.tolerance, SECOND / 8);
  EXPECT_EQ(limits.kept, 10 * SECOND);
  const StampLimits none({0.0, 0.0, 1e300});
  EXPECT_EQ(none.max_age, NEVER);
  EXPECT_EQ(none.max_gap, 0);
  EXPECT_EQ(none.tolerance, NEVER);
}

TEST(StampLimits, StampsAreTakenUpToTheToleranceAheadAndTheAgeBehind) {
  const StampNs now = 100 * SECOND;
  const auto refusal = [&](const PoseLimits& limits, StampNs newest, StampNs stamp) {
    TransformBuffer buffer(limits);
    if (newest != 0) buffer.take({"base", "arm", newest, {0, 0, 0}, NO_TURN}, false, "", now);
    return buffer.take({"base", "arm", stamp, {0, 0, 0}, NO_TURN}, false, "", now);
  };
  const PoseLimits limits{0.25, 1.0, 0.125};
  EXPECT_EQ(refusal(limits, 0, 0), "its stamp is zero");
  EXPECT_EQ(refusal(limits, 0, now + SECOND / 8), "");
  EXPECT_EQ(refusal(limits, 0, now + SECOND / 8 + 1), "its stamp is 0.13 s ahead of the clock");
  EXPECT_EQ(refusal(limits, 0, now - SECOND / 4), "");
  EXPECT_EQ(refusal(limits, 0, now - SECOND / 4 - 1),
            "it was 0.25 s old when it arrived, and max_pose_age is 0.25 s");
  const PoseLimits ageless{0.0, 1.0, 0.125};
  EXPECT_EQ(refusal(ageless, now, now - 10 * SECOND), "");
  EXPECT_EQ(refusal(ageless, now, now - 10 * SECOND - 1), "it is older than what is kept");
}

/// A sample beside three consecutive ones of another publisher.
TEST(Contradictions, AreFurtherFromBothNeighboursThanTheseAreFromEachOther) {
  std::string how;
  const double just = 0.9e-4, more = 1.1e-4;  // what rounding may do, and what it may not
  const auto pose = [](int parent, double x, double angle) {
    return FramePose{parent, Vector3d(0, x, 0),
                     Quaterniond(Eigen::AngleAxisd(angle, Vector3d::UnitX()))};
  };
  const auto ofPoses = [&](const FramePose& sample, const FramePose& earlier) {
    how = "";
    return contradicts(sample, earlier, pose(1, 0.5, 0.5), pose(1, 0.75, 0.625), how);
  };
  const FramePose still = pose(1, 0.5, 0.5), came = pose(1, 0.0, 0.0);
  EXPECT_FALSE(ofPoses(pose(1, 1.0 + just, 0.75 + just), still));
  EXPECT_TRUE(ofPoses(pose(1, 1.0 + more, 0.5), still));
  EXPECT_EQ(how, "by 0.2501 m and 0 rad");
  EXPECT_TRUE(ofPoses(pose(1, 0.5, 0.75 + more), still));
  EXPECT_EQ(how, "by 0 m and 0.1251 rad");
  EXPECT_FALSE(ofPoses(pose(1, 1.25 + just, 1.125 + just), came)) << "as far as the step before";
  EXPECT_TRUE(ofPoses(pose(1, 1.25, 0.5), pose(2, 0.0, 0.0))) << "that was to another parent";
  EXPECT_TRUE(ofPoses(pose(3, 0.5, 0.5), still));
  EXPECT_EQ(how, "they name different parents");
  EXPECT_FALSE(contradicts(pose(2, 9, 0), still, still, pose(2, 0, 0), how)) << "one of the two";
}

}  // namespace collision_pairs::test_transform_buffer
