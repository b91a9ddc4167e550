// Joints that are not fixed, but that static transforms hold, and what is kept of them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "newest_poses.h"
#include "random_inputs.h"
#include "refusal.h"

namespace collision_pairs::test_standing_joints {

using Eigen::Vector3d;
using testing::ElementsAre;

class StandingJoints : public NewestPoses {};

TEST_F(StandingJoints, WhatStandsOnlyByStaticTransformsNamesTheJointThatIsNotFixed) {
  take("base", "arm", 0, true);
  take("tool", "wheel", 9.5);
  const std::string why =
      "only /tf_static places it, but joint 'slide' is not fixed: publish it on "
      "/tf, or list the joint in static_joints";
  EXPECT_THAT(found().problems, ElementsAre("", why, why));
  EXPECT_THAT(found({"slide"}).problems, ElementsAre("", "", ""));
  EXPECT_THAT(found({"spin"}).problems, ElementsAre("", why, why));
  EXPECT_EQ(refusal([&] {
              found({"spin", "slid"});
            }),
            "static_joints: 'slid' is not a joint of the robot; did you mean 'slide'?");
}

TEST_F(StandingJoints, BeyondAJointThatStaticTransformsHoldNothingIsKnownFromAnyFrame) {
  take("base", "arm", 0.0, true);
  take("tool", "wheel", 9.5);
  const auto knownIn = [&](const char* frame, const std::vector<std::string>& static_joints = {}) {
    const RobotPoses poses(buffer_, *robot_, frame, static_joints);
    return poses.newest(10 * SECOND, std::vector<char>(3, 1)).known;
  };
  take("tool", "camera", 0.0, true);  // no link
  take("wheel", "gimbal", 9.5);
  EXPECT_THAT(knownIn("base"), ElementsAre(1, 0, 0));
  for (const char* frame : {"arm", "tool", "wheel", "camera", "gimbal"}) {
    EXPECT_THAT(knownIn(frame), ElementsAre(0, 1, 1)) << frame;
    EXPECT_THAT(knownIn(frame, {"slide"}), ElementsAre(1, 1, 1)) << frame;
  }
}

TEST_F(StandingJoints, OfACameraBeyondAJointThatStaticTransformsHoldAreUnknown) {
  take("base", "arm", 0.0, true);
  take("tool", "wheel", 9.5);
  take("tool", "camera", 0.0, true);  // no link
  take("wheel", "gimbal", 9.5);
  const auto why = [&](const char* target, const char* source,
                       const std::vector<std::string>& static_joints = {}) {
    const RobotPoses poses(buffer_, *robot_, "base", static_joints);
    return refusal([&] { poses.between(target, source, {Instant::AT, 19 * SECOND / 2}); });
  };
  const std::string held =
      "only /tf_static places it, but joint 'slide' is not fixed: publish it "
      "on /tf, or list the joint in static_joints";
  for (const char* source : {"arm", "tool", "wheel", "camera", "gimbal"}) {
    EXPECT_EQ(why("base", source), held);
    EXPECT_EQ(why(source, "base"), held);
    EXPECT_EQ(why("base", source, {"slide"}), "accepted");
    EXPECT_EQ(why("camera", source), "accepted");
  }
}

TEST_F(StandingJoints, AreKnownFromAFrameThatIsFixedToALinkBehindAMovingJoint) {
  take("base", "arm", 9.5);
  take("tool", "wheel", 9.5);
  take("wheel", "camera", 0.0, true);  // no link
  const RobotPoses poses(buffer_, *robot_, "camera");
  EXPECT_THAT(poses.newest(10 * SECOND, std::vector<char>(3, 1)).known, ElementsAre(1, 1, 1));
}

// Transforms of any frame, static and not, on any parent: what is kept between look-ups is found
// anew whenever it has to be.
TEST_F(StandingJoints, DoNotDependOnWhatWasAskedBefore) {
  RandomInputs random;
  const std::vector<std::string> frames = {"base", "arm", "tool", "wheel", "camera", "world"};
  const auto anyFrame = [&] { return frames[random.integer(0, 5)]; };
  const RobotPoses kept(buffer_, *robot_, "base"), kept_in_world(buffer_, *robot_, "world");
  const auto answers = [&](const RobotPoses& poses, StampNs now) {
    const FoundBodies found = poses.newest(now, std::vector<char>(3, 1));
    std::vector<std::string> all = found.problems;
    for (const std::string& target : frames) {
      for (const std::string& source : frames) {
        all.push_back(refusal([&] { poses.between(target, source, {Instant::NEWEST, now}); }));
      }
    }
    return all;
  };
  int nb_held = 0;
  for (int i = 0; i < 1000 || (nb_held == 0 && i < 10000); ++i) {
    const StampNs now = 10 * SECOND + i * (SECOND / 10);
    const bool is_static = random.integer(0, 1) == 1;
    const StampNs stamp = now + static_cast<StampNs>(random.uniform(-0.4, 0.4) * 1e9);
    const Vector3d p(random.uniform(0.0, 2.0), 0, 0);
    buffer_.take({anyFrame(), anyFrame(), stamp, p, Eigen::Quaterniond::Identity()}, is_static,
                 random.integer(0, 19) == 0 ? "liar" : "", now);
    const auto now_kept = answers(kept, now);
    ASSERT_EQ(now_kept, answers(RobotPoses(buffer_, *robot_, "base"), now)) << i;
    ASSERT_EQ(answers(kept_in_world, now), answers(RobotPoses(buffer_, *robot_, "world"), now))
        << i;
    const FoundBodies found = kept.newest(now, {1, 1, 1});
    for (std::size_t b = 0; b < 3 && found.stamp == NEVER; ++b) {
      if (!found.known[b]) continue;
      const std::string link = robot_->links()[robot_->bodies()[b].link].name;
      ASSERT_EQ(kept.between("base", link, {Instant::AT, now}).oldest, NEVER) << i;
    }
    nb_held += std::count_if(now_kept.begin(), now_kept.end(), [](const std::string& why) {
      return why.rfind("only /tf_static", 0) == 0;
    });
  }
  EXPECT_GT(nb_held, 0);
}

}  // namespace collision_pairs::test_standing_joints
