// Against tf2's own buffer, which is what the node asks.
#include <algorithm>
#include <cmath>
#include <random>

#include <gtest/gtest.h>
#include <tf2/buffer_core.h>
#include <tf2/exceptions.h>

#include "tracks.h"

namespace collision_pairs {
namespace {

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

TEST(TransformTracks, PosesAreThoseOfTf2AtAnyInstantInAnyOrderOfArrival) {
  const std::vector<std::pair<std::string, std::string>> tree = {
      {"map", "odom"}, {"odom", "base"}, {"base", "a"}, {"a", "b"}, {"base", "c"}};
  for (unsigned seed = 0; seed < 20; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> any(-1.0, 1.0);
    std::vector<geometry_msgs::TransformStamped> messages;
    for (const auto& [parent, child] : tree) {
      for (int i = 0; i < 20; ++i) {
        const StampNs stamp =
            100 * SECOND + i * SECOND / 10 + static_cast<StampNs>(any(random) * 4e7);
        const Quaterniond R =
            Quaterniond(any(random), any(random), any(random), any(random)).normalized();
        messages.push_back(
            toMessage(parent, child, stamp, Vector3d(any(random), any(random), any(random)), R));
      }
    }
    std::shuffle(messages.begin(), messages.end(), random);
    tf2::BufferCore buffer;
    TransformTracks tracks;
    for (const auto& m : messages) {
      buffer.setTransform(m, "test");
      const auto& p = m.transform.translation;
      const auto& q = m.transform.rotation;
      tracks.add("/" + m.header.frame_id, m.child_frame_id,
                 static_cast<StampNs>(m.header.stamp.toNSec()), Vector3d(p.x, p.y, p.z),
                 Quaterniond(q.w, q.x, q.y, q.z), false);
    }
    tracks.finish();
    int nb_known = 0;
    for (int i = 0; i < 60; ++i) {
      const StampNs stamp = 100 * SECOND + i * SECOND / 25;
      FramePoses frames(tracks, stamp, 10 * SECOND);
      frames.anchor(tracks.findFrame("base"), Isometry3d::Identity());
      frames.climbFrom(tracks.findFrame("base"));
      for (const std::string frame : {"map", "odom", "a", "b", "c"}) {
        Isometry3d expected = Isometry3d::Identity(), found = expected;
        const bool known = ask(buffer, "base", frame, stamp, expected);
        ASSERT_EQ(frames.find(tracks.findFrame(frame), found), known) << frame << " at " << i;
        if (known) {
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
    tracks_.finish();
    FramePoses frames(tracks_, stamp, SECOND);
    frames.anchor(tracks_.findFrame("base"), Isometry3d::Identity());
    Isometry3d X;
    const bool found = frames.find(tracks_.findFrame("arm"), X);
    if (found) x = X.translation().x();
    return found;
  }
  void add(double seconds, double x, bool is_static = false) {
    EXPECT_TRUE(tracks_.add("base", "arm", static_cast<StampNs>(seconds * 1e9), Vector3d(x, 0, 0),
                            NO_TURN, is_static));
  }
  TransformTracks tracks_;
  double x_ = 0.0;
};

TEST_F(OneTrack, NothingIsKnownBeforeTheFirstAndAfterTheLastSample) {
  add(1, 1);
  add(2, 2);
  EXPECT_FALSE(known(SECOND - 1, x_));
  EXPECT_TRUE(known(2 * SECOND, x_));
  EXPECT_FALSE(known(2 * SECOND + 1, x_));
}

TEST_F(OneTrack, NothingIsKnownWithinALongGap) {
  add(1, 1);
  add(2.5, 2);
  add(3, 4);
  EXPECT_FALSE(known(2 * SECOND, x_));
  EXPECT_TRUE(known(2750000000, x_));
  EXPECT_DOUBLE_EQ(x_, 3.0);
}

TEST_F(OneTrack, AGapOfExactlyTheLongestIsBridged) {
  add(1, 1);
  add(2, 3);
  ASSERT_TRUE(known(SECOND + SECOND / 2, x_));
  EXPECT_DOUBLE_EQ(x_, 2.0);
}

TEST_F(OneTrack, StaysWithItsParentUntilItIsSeenOnAnother) {
  add(1, 1);
  EXPECT_TRUE(tracks_.add("other", "arm", 2 * SECOND, Vector3d(5, 0, 0), NO_TURN, false));
  ASSERT_TRUE(known(SECOND + SECOND / 2, x_));
  EXPECT_EQ(x_, 1.0);
  EXPECT_FALSE(known(2 * SECOND, x_)) << "of the other parent nothing is known";
}

TEST_F(OneTrack, AStaticTransformIsNotDisplacedByOneThatMoves) {
  add(5, 7, true);
  add(1, 8);
  ASSERT_TRUE(known(SECOND, x_));
  EXPECT_EQ(x_, 7.0);
}

TEST_F(OneTrack, OfEqualStampsTheFirstStays) {
  add(1, 7);
  add(1, 8);
  ASSERT_TRUE(known(SECOND, x_));
  EXPECT_EQ(x_, 7.0);
}

TEST_F(OneTrack, AStaticTransformIsGoodAtAnyInstantAndTheLastOneCounts) {
  add(5, 7, true);
  add(6, 8, true);
  ASSERT_TRUE(known(1, x_));
  EXPECT_EQ(x_, 8.0);
}

TEST_F(OneTrack, WhatIsNoRotationOrNotFiniteIsRefused) {
  const double nan = std::nan("");
  EXPECT_FALSE(tracks_.add("base", "arm", 1, Vector3d(nan, 0, 0), NO_TURN, false));
  EXPECT_FALSE(tracks_.add("base", "arm", 1, Vector3d::Zero(), Quaterniond(0, 0, 0, 0), false));
  EXPECT_FALSE(tracks_.add("base", "arm", 1, Vector3d::Zero(), Quaterniond(nan, 0, 0, 0), false));
  EXPECT_FALSE(tracks_.add("arm", "/arm", 1, Vector3d::Zero(), NO_TURN, false));
}

TEST_F(OneTrack, FramesInARingAreUnknownAndEndNothing) {
  add(1, 1);
  tracks_.add("arm", "base", SECOND, Vector3d::Zero(), NO_TURN, false);
  tracks_.add("y", "x", SECOND, Vector3d::Zero(), NO_TURN, false);
  tracks_.add("x", "y", SECOND, Vector3d::Zero(), NO_TURN, false);
  EXPECT_TRUE(known(SECOND, x_));
  FramePoses frames(tracks_, SECOND, SECOND);
  frames.anchor(tracks_.findFrame("base"), Isometry3d::Identity());
  frames.climbFrom(tracks_.findFrame("base"));
  Isometry3d X;
  EXPECT_FALSE(frames.find(tracks_.findFrame("x"), X));
}

TEST_F(OneTrack, AnAnchorOverridesWhatTheTracksSaid) {
  add(1, 5);
  EXPECT_TRUE(known(SECOND, x_));
  FramePoses frames(tracks_, SECOND, SECOND);
  frames.anchor(tracks_.findFrame("base"), Isometry3d::Identity());
  Isometry3d X;
  ASSERT_TRUE(frames.find(tracks_.findFrame("arm"), X));
  frames.anchor(tracks_.findFrame("arm"), Isometry3d::Identity());
  ASSERT_TRUE(frames.find(tracks_.findFrame("arm"), X));
  EXPECT_EQ(X.translation(), Vector3d(0, 0, 0));
}

TEST(JointTracks, AContinuousJointTakesTheShorterWayRound) {
  JointTracks tracks;
  tracks.add("wheel", 0, 3.0);
  tracks.add("wheel", SECOND, -3.0);
  tracks.finish();
  const auto& samples = tracks.tracks().at("wheel");
  double position = 0.0;
  ASSERT_TRUE(JointTracks::lookUp(samples, SECOND / 2, SECOND, true, position));
  EXPECT_NEAR(position, M_PI, 1e-12);
  ASSERT_TRUE(JointTracks::lookUp(samples, SECOND / 2, SECOND, false, position));
  EXPECT_NEAR(position, 0.0, 1e-12);
  EXPECT_FALSE(JointTracks::lookUp(samples, SECOND / 2, SECOND / 2, false, position));
  EXPECT_FALSE(tracks.add("wheel", 0, std::nan("")));
}

}  // namespace
}  // namespace collision_pairs
