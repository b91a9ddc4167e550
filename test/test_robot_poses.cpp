// Why bodies of a robot have no pose, from transforms put together here.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "newest_poses.h"
#include "random_inputs.h"

namespace collision_pairs::test_robot_poses {

using Eigen::Vector3d;
using testing::ElementsAre;

TEST_F(NewestPoses, WhyOneIsNotKnownIsSaidInTheseWords) {
  take("base", "arm", 9.875);
  EXPECT_THAT(found().problems, ElementsAre("", "", "TF has no frame of that name"));
  take("tool", "wheel", 9.875);
  EXPECT_THAT(found().problems, ElementsAre("", "", "")) << "the URDF fixes the tool to the arm";
  take("cart", "arm", 9.9375);
  EXPECT_EQ(found().problems[1], "transform of 'cart': TF does not say where it is (in 'base')");
}

TEST_F(NewestPoses, AreNotKnownInAFrameThatNobodyNames) {
  take("base", "arm", 9.875);
  const RobotPoses poses(buffer_, *robot_, "world");
  const FoundBodies found = poses.newest(10 * SECOND, std::vector<char>(3, 1));
  EXPECT_THAT(found.known, ElementsAre(0, 0, 0));
  EXPECT_THAT(found.problems, ElementsAre("TF has no frame 'world'", "TF has no frame 'world'",
                                          "TF has no frame of that name"));
}

TEST_F(NewestPoses, LinksThatTfNamesLaterAreFoundFromThenOn) {
  const RobotPoses poses(buffer_, *robot_, "base");
  const auto known = [&] { return poses.newest(10 * SECOND, std::vector<char>(3, 1)).known; };
  EXPECT_THAT(known(), ElementsAre(1, 0, 0));
  take("base", "arm", 9.875);
  EXPECT_THAT(known(), ElementsAre(1, 1, 0));
  take("tool", "wheel", 9.875);
  EXPECT_THAT(known(), ElementsAre(1, 1, 1));
}

TEST_F(NewestPoses, OneThatLagsBehindTheOthersIsSaidTo) {
  take("base", "arm", 8.5);
  for (const double seconds : {8.5, 9.5}) take("base", "wheel", seconds);
  EXPECT_THAT(found().problems, ElementsAre("", "", "")) << "just as far as it may";
  EXPECT_EQ(found().stamp, 8 * SECOND + SECOND / 2);
  take("base", "wheel", 9.75);
  EXPECT_THAT(found().problems,
              ElementsAre("",
                          "its newest transform is 1.25 s older than the newest of all links, and "
                          "max_transform_age is 1.00 s",
                          ""));
  EXPECT_EQ(found().stamp, 9 * SECOND + 3 * SECOND / 4);
}

/// W hangs on a frame that nothing connects, by a transform without a limit of its age: at the
/// newest of each nothing is known, but at the clock's stamp W is where its fixed joint has it.
TEST_F(NewestPoses, OnesThatAreKnownByTheClockAloneAreNotCalledStatic) {
  TransformBuffer buffer{PoseLimits{0.0, 1.0, 0.5}};
  send(buffer, "nowhere", "tool", 5.0, 1.0, "");
  for (const double seconds : {9.75, 10.25}) send(buffer, "base", "arm", seconds, 1.0, "");
  const FoundBodies found = RobotPoses(buffer, *robot_, "tool").newest(10 * SECOND, {1, 1, 0});
  EXPECT_THAT(found.known, ElementsAre(1, 1, 0));
  EXPECT_EQ(found.stamp, 10 * SECOND);
}

// The first joint, or the transform of the whole robot in the frame of the reports.
TEST_F(NewestPoses, BelowAFrameThatFellSilentAreLeftOutThoughAgesDoNotMatter) {
  RandomInputs random;
  for (int i = 0; i < 100; ++i) {
    TransformBuffer buffer{PoseLimits{0.0, 0.5, 0.5}};
    const std::string frame = random.integer(0, 1) ? "world" : "base";
    const RobotPoses poses(buffer, *robot_, frame);
    const std::string silent = frame == "world" && random.integer(0, 1) ? "base" : "arm";
    const double end = random.uniform(11.0, 12.0);  // of what falls silent
    double last = 0.0;                              // that it sent
    for (double now = 10.0; now < 16.0; now += random.uniform(0.01, 0.1)) {
      for (const auto& [parent, child] : {std::pair<std::string, std::string>("world", "base"),
                                          {"base", "arm"},
                                          {"tool", "wheel"}}) {
        if (child == silent && now > end) continue;
        if (child == silent) last = now;
        const auto stamp = static_cast<StampNs>(now * 1e9);
        buffer.take({parent, child, stamp, Vector3d(now, 0, 0), Eigen::Quaterniond::Identity()},
                    false, "", stamp);
      }
      const FoundBodies found =
          poses.newest(static_cast<StampNs>(now * 1e9), std::vector<char>(3, 1));
      const bool is_frozen = now - last > 0.5;
      if (is_frozen) {
        EXPECT_FALSE(found.known[1] && found.known[2]) << frame << ' ' << silent << ' ' << now;
        EXPECT_THAT(found.problems[1], testing::HasSubstr("older than the newest of all links"));
      } else {
        EXPECT_THAT(found.known, ElementsAre(1, 1, 1)) << frame << ' ' << silent << ' ' << now;
      }
    }
  }
}

TEST_F(NewestPoses, AreNotThoseOfBeforeTheFrameThatTheyAreInBecameSuspect) {
  TransformBuffer buffer(PoseLimits{0.0, 1.0, 0.5});
  const RobotPoses poses(buffer, *robot_, "tool");
  const auto known = [&] { return poses.newest(20 * SECOND, {1, 1, 1}).known; };
  send(buffer, "base", "arm", 10.0, 1.0, "/one");
  send(buffer, "tool", "wheel", 10.0, 1.0, "/one");
  EXPECT_THAT(known(), ElementsAre(1, 1, 1));
  makeArmSuspect(buffer);
  EXPECT_THAT(known(), ElementsAre(0, 1, 0)) << "the wheel was heard of eight seconds earlier";
}

// The tool's own transform places the arm, or the one of W places what W hangs on.
TEST_F(NewestPoses, AreNotThoseOfBeforeASuspectTransformThatFixedJointsReplace) {
  for (const std::string frame : {"world", "tool"}) {
    TransformBuffer buffer(PoseLimits{0.0, 1.0, 0.5});
    const RobotPoses poses(buffer, *robot_, frame);
    const auto known = [&] { return poses.newest(20 * SECOND, {1, 1, 1}).known; };
    send(buffer, "world", "base", 10.0, 1.0, "/one");
    send(buffer, "world", "tool", 10.0, 1.0, "/one");
    send(buffer, "tool", "wheel", 10.0, 1.0, "/one");
    EXPECT_THAT(known(), ElementsAre(1, 1, 1));
    makeArmSuspect(buffer);
    const bool is_of_frame = frame == "tool";  // fixed to it
    EXPECT_THAT(known(), ElementsAre(0, is_of_frame, 0)) << "the arm was heard of 9 s later";
  }
}

TEST_F(NewestPoses, WhyOneFrameIsNotKnownInAnotherIsSaidInTheseWords) {
  take("map", "a", 9.75);
  take("map", "a", 10);
  take("map", "b", 0, true);
  take("else", "c", 10);
  EXPECT_EQ(between("a", "/b"), "accepted");
  EXPECT_EQ(between("a", "a", SECOND), "accepted");
  EXPECT_EQ(between("none", "other"), "TF has no frame 'none'");
  EXPECT_EQ(between("a", "other"), "TF has no frame 'other'");
  EXPECT_EQ(between("a", "c"), "TF does not connect 'a' and 'c'");
  const std::string late =
      "its newest transform is 0.25 s older than that stamp (no extrapolation)";
  EXPECT_EQ(between("a", "b", 10 * SECOND + SECOND / 4), late);
  EXPECT_EQ(between("b", "a", 10 * SECOND + SECOND / 4), late);
}

// TF knows the arm on the base, and the wheel on the tool, but not that the tool is fixed to the
// arm.
TEST_F(NewestPoses, OfLinksToEachOtherAreFoundByFixedJointsToo) {
  take("base", "arm", 9.5);
  take("tool", "wheel", 9.5);
  const auto xOf = [&](const std::string& target, const std::string& source,
                       const std::string& frame) {
    const RobotPoses poses(buffer_, *robot_, frame);
    return poses.between(target, source, {Instant::NEWEST, 10 * SECOND}).X_TS.translation().x();
  };
  for (const char* frame : {"base", "arm", "tool"}) {
    EXPECT_EQ(xOf("base", "arm", frame), 1.0);
    EXPECT_EQ(xOf("base", "tool", frame), 1.0);
    EXPECT_EQ(xOf("tool", "arm", frame), 0.0);
    EXPECT_EQ(xOf("/base", "wheel", frame), 2.0);
    EXPECT_EQ(xOf("wheel", "/base", frame), -2.0);
  }
  const RobotPoses poses(buffer_, *robot_, "base");
  EXPECT_THROW(poses.between("base", "nowhere", {Instant::NEWEST, 10 * SECOND}), NotConnected);
  take("base", "arm", 9.75);
  const auto mixed = poses.between("base", "wheel", {Instant::NEWEST, 10 * SECOND});
  EXPECT_EQ(mixed.oldest, 19 * SECOND / 2) << "at one instant";
}

TEST_F(NewestPoses, OfLinksThatTfDoesNotNameAreFoundByFixedJointsToo) {
  take("base", "arm", 9.5);
  const RobotPoses poses(buffer_, *robot_, "base");
  const Instant newest{Instant::NEWEST, 10 * SECOND};
  EXPECT_EQ(poses.between("base", "tool", newest).X_TS.translation().x(), 1.0);
  EXPECT_EQ(poses.between("base", "tool", newest).oldest, 19 * SECOND / 2);
  EXPECT_THROW(poses.between("base", "wheel", newest), NotConnected);
}

TEST_F(NewestPoses, OfARobotWhoseRootHangsOnItsOwnToolAreUnknown) {
  take("base", "arm", 9.75);
  take("arm", "tool", 0, true);
  take("tool", "wheel", 9.75);
  take("wheel", "camera", 9.75);
  take("camera", "base", 9.75);
  const std::string why = "its ancestors form a cycle (in 'base')";
  EXPECT_THAT(found().known, ElementsAre(1, 0, 0));
  EXPECT_THAT(found().problems, ElementsAre("", why, why));
  EXPECT_EQ(between("base", "wheel", 39 * SECOND / 4), "'wheel': its ancestors form a cycle");
}

TEST_F(NewestPoses, OfARobotWhoseRootHangsOnALinkThatOnlyTheUrdfPlacesAreUnknown) {
  take("base", "arm", 9.75);
  take("tool", "wheel", 9.75);
  EXPECT_THAT(found().known, ElementsAre(1, 1, 1));
  take("tool", "base", 9.75);
  const std::string why = "its ancestors form a cycle (in 'base')";
  EXPECT_THAT(found().problems, ElementsAre("", why, why));
  for (const char* frame : {"arm", "tool", "wheel"}) {
    const RobotPoses poses(buffer_, *robot_, frame);
    const std::vector<char> known = poses.newest(10 * SECOND, {1, 1, 1}).known;
    EXPECT_EQ(std::count(known.begin(), known.end(), 1), 1) << "but itself, in " << frame;
  }
}

TEST_F(NewestPoses, OfACameraOnARobotWhoseRootHangsOnItselfAreUnknown) {
  take("base", "arm", 9.75);
  take("arm", "camera", 9.75);
  const RobotPoses poses(buffer_, *robot_, "base");
  const Instant at{Instant::AT, 39 * SECOND / 4}, newest{Instant::NEWEST, 10 * SECOND};
  EXPECT_EQ(poses.between("base", "camera", at).X_TS.translation().x(), 2.0);
  take("tool", "base", 9.75);
  EXPECT_THROW(poses.between("base", "camera", at), NotConnected);
  EXPECT_THROW(poses.between("base", "camera", newest), NotConnected);
  EXPECT_THROW(poses.between("camera", "arm", newest), NotConnected);
}

TEST_F(NewestPoses, OfARobotWhoseRootHangsOnItByAnyLinkOfABodyAreUnknown) {
  const auto robot =
      robotFrom(emptyLink("base") + emptyLink("arm") + emptyLink("tool") + emptyLink("hook") +
                joint("slide", "prismatic", "base", "arm") +
                joint("flange", "fixed", "arm", "tool") + joint("weld", "fixed", "arm", "hook"));
  take("tool", "base", 9.75);
  take("cart", "arm", 9.75);  // leads elsewhere
  const RobotPoses poses(buffer_, *robot, "base");
  EXPECT_THAT(poses.newest(10 * SECOND, {1, 1}).known, ElementsAre(1, 1)) << "by its tool";
  take("base", "hook", 9.75);
  EXPECT_THAT(poses.newest(10 * SECOND, {1, 1}).known, ElementsAre(1, 0));
}

TEST_F(NewestPoses, OfLinksThatHangOnTheOtherLinkOfTheirBodyAreKnown) {
  take("tool", "arm", 0, true);
  take("arm", "base", 9.75);
  take("tool", "wheel", 9.75);
  const RobotPoses poses(buffer_, *robot_, "arm");
  EXPECT_THAT(poses.newest(10 * SECOND, {1, 1, 1}).known, ElementsAre(1, 1, 1));
}

TEST_F(NewestPoses, OfALinkOnABodyAreKnownFromTheLinkOfItThatHungOnWhatHangsOnItLately) {
  take("cart", "arm", 9.5);
  take("tool", "cart", 9.75);
  take("tool", "wheel", 9.75);
  const RobotPoses poses(buffer_, *robot_, "cart");
  const auto found = poses.between("arm", "wheel", {Instant::AT, 39 * SECOND / 4});
  EXPECT_EQ(found.X_TS.translation().x(), 1.0);
}

// By either of two links of each body: 2^40 ways.
TEST_F(NewestPoses, AreFoundWhereBodiesHangOnEachOtherByManyWays) {
  std::string links, tree;
  for (int i = 0; i < 40; ++i) {
    const std::string body = "b" + std::to_string(i), left = body + "l", right = body + "r";
    links += emptyLink(body) + emptyLink(left) + emptyLink(right);
    tree += joint(left, "fixed", body, left) + joint(right, "fixed", body, right);
    if (i == 0) continue;
    const std::string above = "b" + std::to_string(i - 1);
    tree += joint(body, "continuous", above, body);
    for (const char* side : {"l", "r"}) take(body, above + side, 9.75);
  }
  const auto robot = robotFrom(links + tree);
  const RobotPoses poses(buffer_, *robot, "b0");
  const FoundBodies found = poses.newest(10 * SECOND, std::vector<char>(40, 1));
  EXPECT_THAT(found.known, testing::Each(1));
  EXPECT_EQ(found.X_WB[39].translation().x(), -39.0);
}

// As base_footprint, base_stabilized and base_link.
TEST_F(NewestPoses, OfABodyBetweenTwoLinksOfWhichTfHasAnotherFrameAreKnownInThatFrame) {
  take("tool", "level", 9.75);
  take("level", "arm", 9.75);
  take("arm", "base", 9.75);
  take("tool", "wheel", 9.75);
  for (const char* frame : {"level", "arm", "tool", "base"}) {
    const RobotPoses poses(buffer_, *robot_, frame);
    EXPECT_THAT(poses.newest(10 * SECOND, {1, 1, 1}).known, ElementsAre(1, 1, 1)) << frame;
  }
}

TEST_F(NewestPoses, AreThoseOfTheFirstLinkOfTheirBodyThatIsKnown) {
  const auto say = [&](const std::string& link, double x, const std::string& publisher) {
    for (const StampNs stamp : {19 * SECOND / 2, 39 * SECOND / 4}) {
      const Vector3d p(x, 0, 0);
      buffer_.take({"base", link, stamp, p, Eigen::Quaterniond::Identity()}, false, publisher,
                   10 * SECOND);
    }
  };
  say("arm", 1.0, "driver");
  say("tool", 3.0, "tracker");
  EXPECT_EQ(found().X_WB[1].translation().x(), 1.0) << "where TF has the tool is not asked";
  say("arm", 2.0, "other");
  EXPECT_EQ(found().known[1], 1);
  EXPECT_EQ(found().X_WB[1].translation().x(), 3.0) << "the arm is suspect, the tool is not";
}

TEST_F(NewestPoses, FurtherFromEachOtherThanTf2WalksAreUnknown) {
  const auto name = [](int i) { return i == 0 ? std::string("base") : "f" + std::to_string(i); };
  for (int i = 0; i < 9000; ++i) take(name(i), name(i + 1), 9.75);
  take(name(9000), "arm", 9.75);
  EXPECT_EQ(found().problems[1], "its ancestors form a cycle (in 'base')");
  EXPECT_EQ(between("base", name(900), 39 * SECOND / 4), "accepted");
}

}  // namespace collision_pairs::test_robot_poses
