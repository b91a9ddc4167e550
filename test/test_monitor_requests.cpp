// What requests ask of a monitor: joints that move what TF alone places, members, stamps. Without a
// master.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "monitored_robot.h"
#include "refusal.h"

namespace collision_pairs::test_monitor_requests {

using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;

/// An arm that slides, and a gripper with a URDF of its own, which TF hangs on the arm's tool.
class MonitorOfAGripperOnAnArm : public testing::Test {
 protected:
  void SetUp() override {
    ros::Time::init();
    monitor_.advance({now_, 1.0});
    SceneParameters parameters;
    const auto add = [&](const std::string& links, const std::string& prefix) {
      parameters.sources.robots.push_back(
          {std::make_unique<RobotSource>("<robot name='r'>" + links + "</robot>", noMeshes),
           std::nullopt, prefix});
    };
    const std::string limit = "<axis xyz='1 0 0'/><limit lower='-9' upper='9'/>";
    add(emptyLink("base") + boxLink("tool", 0.1) +
            joint("x", "prismatic", "base", "tool", "0 0 0", limit),
        "arm");
    add(emptyLink("root") + boxLink("finger", 0.1) +
            joint("y", "prismatic", "root", "finger", "0 5 0", limit),
        "grip");
    add(emptyLink("flange"), "changer");
    parameters.fixed_frame = "arm/base";
    load(monitor_, std::move(parameters));
    monitor_.take(transformOf("arm/base", "arm/tool", now_, 0.5), false, "rsp");
    monitor_.take(transformOf("grip/root", "grip/finger", now_, 0.0), false, "rsp");
  }
  /// By a frame of no robot, or by a robot of which nothing is checked.
  void hangTheGripper(const std::string& by = "plate") {
    monitor_.take(transformOf("arm/tool", by, now_, 0.0), true, "plate");
    monitor_.take(transformOf(by, "grip/root", now_, 0.1), true, "plate");
  }
  std::vector<std::string> reasonsFor(const std::vector<std::string>& names) const {
    return monitor_.withJoints(monitor_.scenes().active(), names, {}).poses.unknown_because;
  }

  const ros::Time now_{1000.0};
  Monitor monitor_{TransformSettings{}};
};

TEST_F(MonitorOfAGripperOnAnArm, WhereTheGripperIsWhenTheArmMovesIsNotKnown) {
  hangTheGripper();
  const auto is_unknown = ElementsAre(
      "link 'grip/root': TF hangs it on 'arm/tool', which joint 'arm/x' moves, and no URDF says "
      "so: where it is then is not known; make one URDF of both");
  EXPECT_THAT(reasonsFor({"arm/x"}), is_unknown);
  EXPECT_THAT(reasonsFor({"grip/y", "arm/x"}), is_unknown);
  EXPECT_THAT(reasonsFor({}), testing::IsEmpty());
  EXPECT_THAT(reasonsFor({"grip/y"}), testing::IsEmpty());
  const auto measured = [&](const std::vector<std::string>& moved) {
    const auto scene = monitor_.scenes().active();
    return monitor_.withMeasured(scene, {"arm/x", "grip/y"}, moved).poses.unknown_because;
  };
  EXPECT_THAT(measured({"arm/x", "grip/y"}), is_unknown);
  EXPECT_THAT(measured({"grip/y"}), testing::IsEmpty()) << "the arm stands";
}

TEST_F(MonitorOfAGripperOnAnArm, NorIsItWhereAThirdRobotIsBetweenThem) {
  hangTheGripper("changer/flange");
  EXPECT_THAT(reasonsFor({"grip/y"}), testing::IsEmpty());
  EXPECT_THAT(
      reasonsFor({"arm/x"}),
      ElementsAre(HasSubstr("'grip/root': TF hangs it on 'arm/tool', which joint 'arm/x'")));
}

TEST_F(MonitorOfAGripperOnAnArm, ARequestThatNamesWhatIsNotCheckedIsRefused) {
  const auto refused = [&](const std::string& pattern) {
    return refusal([&] {
      Restriction restriction;
      restriction.names = {"arm/tool", pattern};
      monitor_.scenes().restrictedTo(restriction).run();
    });
  };
  EXPECT_EQ(refused("grip/*"), "accepted");
  for (const std::string none : {"gripp*", "arm/base"}) {
    EXPECT_EQ(refused(none), "links: '" + none + "' is nothing that is checked");
  }
}

TEST_F(MonitorOfAGripperOnAnArm, RequestsOfBeforeTheSceneWasChangedAreSuspect) {
  hangTheGripper();
  const auto changed = Contains(HasSubstr("the scene was changed after the stamp"));
  const auto reasonsAt = [&](double stamp) {
    return monitor_.at(monitor_.scenes().active(), ros::Time(stamp)).poses.unknown_because;
  };
  EXPECT_THAT(reasonsAt(1000.0), testing::IsEmpty());
  monitor_.take(transformOf("arm/base", "arm/tool", ros::Time(999.5), 0.5), false, "rsp");
  monitor_.take(transformOf("grip/root", "grip/finger", ros::Time(999.5), 0.0), false, "rsp");
  EXPECT_THAT(reasonsAt(999.75), ElementsAre(HasSubstr("the scene was changed after the stamp")));
  const Snapshot asked = monitor_.withJoints(monitor_.scenes().active(), {}, ros::Time(999.75));
  EXPECT_THAT(asked.poses.unknown_because, changed);
  monitor_.advance({ros::Time(990.0), 2.0});
  EXPECT_THAT(reasonsAt(989.9), testing::Not(changed))
      << "it is that of before the clock went back";
}

}  // namespace collision_pairs::test_monitor_requests
