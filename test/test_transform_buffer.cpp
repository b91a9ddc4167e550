// Against tf2's own buffer, which is what the node asks.
#include <algorithm>
#include <cmath>
#include <random>

#include <gtest/gtest.h>
#include <tf2/buffer_core.h>
#include <tf2/exceptions.h>

#include "joint_tracks.h"
#include "random_inputs.h"
#include "robot_poses.h"

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
    TransformBuffer tracks(PoseLimits{0.0, 10.0, 0.5}, true);
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
      FramePoses frames(tracks, {Instant::AT, stamp});
      frames.anchor(tracks.findFrame("base"), {Isometry3d::Identity()});
      for (const std::string frame : {"map", "odom", "a", "b", "c"}) {
        Isometry3d expected = Isometry3d::Identity();
        FramePoses::Known found;
        const bool known = ask(buffer, "base", frame, stamp, expected);
        ASSERT_EQ(frames.find(tracks.findFrame(frame), found), known) << frame << " at " << i;
        if (known) {
          EXPECT_LT((found.X_RF.matrix() - expected.matrix()).cwiseAbs().maxCoeff(), 1e-12);
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
    FramePoses frames(tracks_, {Instant::AT, stamp});
    frames.anchor(tracks_.findFrame("base"), {Isometry3d::Identity()});
    FramePoses::Known found;
    if (!frames.find(tracks_.findFrame("arm"), found)) return false;
    x = found.X_RF.translation().x();
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
  TransformBuffer tracks_{PoseLimits{0.0, 1.0, 0.5}, true};
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

TEST_F(OneTrack, WhatHadNotArrivedDiffersFromWhatIsTooFarApart) {
  add(1, 1);
  add(2.5, 2);
  add(3, 4);
  const int arm = tracks_.findFrame("arm");
  for (const bool as_it_arrived : {false, true}) {
    EXPECT_EQ(tracks_.whyUnknown(arm, 2 * SECOND, as_it_arrived),
              "no two of its transforms around that stamp are within 1.00 s of each other");
  }
  EXPECT_EQ(tracks_.whyUnknown(arm, 2750000000, true),
            "at that stamp, its newest transform that had arrived was too old or in doubt");
}

TEST_F(OneTrack, AGapOfExactlyTheLongestIsBridged) {
  add(1, 1);
  add(2, 3);
  ASSERT_TRUE(known(SECOND + SECOND / 2, x_));
  EXPECT_DOUBLE_EQ(x_, 2.0);
}

TEST_F(OneTrack, StaysWithItsParentUntilItIsSeenOnAnother) {
  add(1, 1);
  EXPECT_EQ(take("other", "arm", 2, Vector3d(5, 0, 0)), "");
  ASSERT_TRUE(known(SECOND + SECOND / 2, x_));
  EXPECT_EQ(x_, 1.0);
  EXPECT_FALSE(known(2 * SECOND, x_)) << "of the other parent nothing is known";
}

TEST_F(OneTrack, AFrameThatIsStaticAndMovesIsUnknownForeverWithoutALimitOfAge) {
  add(5, 7, true);
  add(6, 8);
  EXPECT_FALSE(known(6 * SECOND, x_));
}

TEST_F(OneTrack, OfEqualStampsTheFirstStaysIfTheyAgreeAndElseItIsInDoubt) {
  add(1, 7);
  add(1, 7.00001);
  ASSERT_TRUE(known(SECOND, x_));
  EXPECT_EQ(x_, 7.0);
  add(1, 8);
  EXPECT_FALSE(known(SECOND, x_));
}

TEST_F(OneTrack, AStaticTransformIsGoodAtAnyInstantAndTheLastOneCounts) {
  add(5, 7, true);
  add(6, 8, true);
  ASSERT_TRUE(known(1, x_));
  EXPECT_EQ(x_, 7.0);
  ASSERT_TRUE(known(100 * SECOND, x_));
  EXPECT_EQ(x_, 8.0);
}

TEST_F(OneTrack, WhatIsNoRotationOrNotFiniteIsRefused) {
  const double nan = std::nan("");
  EXPECT_NE(take("base", "arm", 1, Vector3d(nan, 0, 0)), "");
  for (const double w : {0.0, nan}) {
    EXPECT_NE(take("base", "arm", 1, Vector3d::Zero(), false, Quaterniond(w, 0, 0, 0)), "");
  }
  EXPECT_NE(take("arm", "/arm", 1, Vector3d::Zero()), "");
  EXPECT_EQ(tracks_.findFrame("arm"), -1);
}

TEST_F(OneTrack, FramesInARingAreUnknownAndEndNothing) {
  add(1, 1);
  take("arm", "base", 1, Vector3d::Zero());
  take("y", "x", 1, Vector3d::Zero());
  take("x", "y", 1, Vector3d::Zero());
  EXPECT_TRUE(known(SECOND, x_));
  FramePoses frames(tracks_, {Instant::AT, SECOND});
  frames.anchor(tracks_.findFrame("base"), {Isometry3d::Identity()});
  FramePoses::Known found;
  EXPECT_FALSE(frames.find(tracks_.findFrame("x"), found));
  EXPECT_FALSE(frames.isPlaced(tracks_.findFrame("x")));
}

TEST(JointTracks, AContinuousJointTakesTheShorterWayRound) {
  JointTracks tracks;
  const TrackLimits limits({1.0, 1.0, 0.5}, true);
  tracks.take("wheel", 3.0, SECOND, "", SECOND, limits);
  tracks.take("wheel", -3.0, 2 * SECOND, "", 2 * SECOND, limits);
  const auto& wheel = tracks.joints().at("wheel");
  double position = 0.0;
  std::string why;
  ASSERT_TRUE(JointTracks::lookUp(wheel, SECOND * 3 / 2, limits, true, position, why));
  EXPECT_NEAR(position, M_PI, 1e-12);
  ASSERT_TRUE(JointTracks::lookUp(wheel, SECOND * 3 / 2, limits, false, position, why));
  EXPECT_NEAR(position, 0.0, 1e-12);
  const TrackLimits shorter({1.0, 0.5, 0.5}, true);
  EXPECT_FALSE(JointTracks::lookUp(wheel, SECOND * 3 / 2, shorter, false, position, why));
}

}  // namespace
}  // namespace collision_pairs
