// What is known of a robot, and what a request asks for. Without a master.
#include <cmath>

#include <collision_pairs/CheckCollisions.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "monitored_robot.h"
#include "query_services.h"

namespace collision_pairs::test_monitor {

using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;

/// Spheres a, b and c of radius 0.5 that float along x.
class TheMonitor : public testing::Test {
 protected:
  TheMonitor() {
    for (const std::string link : {"a", "b", "c"}) {
      urdf_ += linkWith(link, "<sphere radius='0.5'/>") +
               joint("to_" + link, "floating", "root", link, "0 0 0", "");
    }
    load(monitor_, parametersOf(urdf_));
    settings_.alarm_distance = 2.0;
  }

  void loadStanding() {
    SceneParameters parameters = parametersOf(urdf_);
    parameters.sources.config.static_joints = {"to_a", "to_b", "to_c"};
    load(monitor_, std::move(parameters));
  }
  void publish(const std::string& link, double stamp, double x, bool is_static = false) {
    monitor_.advance(now_);
    monitor_.take(transformOf("root", link, ros::Time(stamp), x), is_static, "");
  }
  /// From `x` at 999.5 s on at `speed`, seen twice.
  void slide(const std::string& link, double x, double speed) {
    publish(link, 999.5, x);
    publish(link, 1000.0, x + 0.5 * speed);
  }
  Snapshot snapshot() {
    monitor_.advance(now_);
    return monitor_.at(monitor_.scenes().active());
  }
  Checked check() { return collision_pairs::check(monitor_, snapshot(), settings_); }

  std::string urdf_ = emptyLink("root");
  ros::Time now_{1000.0};
  Monitor monitor_{TransformSettings()};
  CheckSettings settings_;
};

TEST_F(TheMonitor, TheTimeToContactIsThatOfTheFirstPairToMeet) {
  slide("b", 0.0, 0.0);
  slide("a", -3.0, 2.0);  // ends 1 m before b: half a second
  slide("c", 2.5, -0.5);  // ends 1.25 m behind b: two and a half
  const Checked checked = check();
  ASSERT_EQ(checked.closing.pairs.size(), 2u);
  EXPECT_NEAR(checked.closing.pairs[0].closing_speed, 2.0, 1e-9);
  EXPECT_NEAR(checked.closing.pairs[1].closing_speed, 0.5, 1e-9);
  EXPECT_TRUE(checked.closing.time_to_contact_is_known);
  EXPECT_NEAR(checked.closing.time_to_contact, 0.5, 1e-4);
}

TEST_F(TheMonitor, TheTimeToContactIsNotKnownWhereOneOfThePairsWasNotSeenBefore) {
  publish("a", 1000.0, -2.0);
  slide("b", 0.0, 0.0);
  slide("c", 2.5, -0.5);
  const Checked checked = check();
  ASSERT_EQ(checked.closing.pairs.size(), 2u);
  EXPECT_FALSE(checked.closing.pairs[0].known);
  EXPECT_TRUE(checked.closing.pairs[1].known);
  EXPECT_FALSE(checked.closing.time_to_contact_is_known);
  EXPECT_EQ(checked.closing.time_to_contact, 0.0);
}

TEST_F(TheMonitor, ReportsWhatNeverMovesAsOfNow) {
  loadStanding();
  double x = 0.0;
  for (const char* link : {"a", "b", "c"}) publish(link, 1.0, x += 5.0, true);
  EXPECT_EQ(check().report.verdict, Verdict::FREE);
  EXPECT_EQ(snapshot().stamp, now_);
}

// Only what the scene of the cycle checks is followed from cloud to cloud.
TEST_F(TheMonitor, IsSuspectOfCloudsBesideLinksThatTheCycleDoesNotCheck) {
  SceneParameters parameters = parametersOf(urdf_);
  parameters.sources.readSettings({"settings", "clouds: [{topic: points}]\nlinks: [b]"});
  load(monitor_, std::move(parameters));
  for (const auto& [link, is_followed] : {std::pair<std::string, bool>("a", false), {"b", true}}) {
    Restriction restriction;
    restriction.names = {link};
    SceneJob job = monitor_.scenes().restrictedTo(restriction);
    job.run();
    ASSERT_TRUE(monitor_.scenes().take(job));
    const auto names_a = HasSubstr("what clouds show beside a is not followed");
    const auto reasons = monitor_.at(job.scene()).poses.unknown_because;
    if (is_followed) {
      EXPECT_THAT(reasons, testing::Not(Contains(names_a)));
    } else {
      EXPECT_THAT(reasons, Contains(names_a));
    }
  }
}

TEST_F(TheMonitor, TheClosingSpeedIsThatOfTheLastTenthOfASecond) {
  slide("b", 0.0, 0.0);
  publish("a", 999.5, -2.5);
  publish("a", 999.9, -2.5);
  publish("a", 999.95, -2.25);
  publish("a", 1000.0, -1.5);
  const Checked checked = check();
  ASSERT_EQ(checked.closing.pairs.size(), 1u);
  EXPECT_NEAR(checked.closing.pairs[0].closing_speed, 10.0, 1e-6);
}

TEST_F(TheMonitor, TheClosingSpeedIsNotKnownBeforeTheFirstTenthOfASecondOfTheClock) {
  for (const double now : {0.05, 0.5}) {
    now_ = ros::Time(now);
    for (const double earlier : {0.2, 0.0}) {
      publish("a", now - earlier * now, -1.5);
      publish("b", now - earlier * now, 0.0);
    }
    const Checked checked = check();
    ASSERT_EQ(checked.closing.pairs.size(), 1u);
    EXPECT_EQ(checked.closing.pairs[0].known, now > 0.1) << now;
  }
}

TEST_F(TheMonitor, HasAReasonOfEveryReportWhereThereIsOneOfTheScene) {
  double x = 0.0;
  for (const char* link : {"a", "b", "c"}) slide(link, x += 5.0, 0.0);
  EXPECT_EQ(check().report.verdict, Verdict::FREE);
  SceneParameters parameters = parametersOf(urdf_);
  parameters.sources.config.restriction.names = {"d*"};
  load(monitor_, std::move(parameters));
  const Checked checked = check();
  EXPECT_EQ(checked.report.verdict, Verdict::UNKNOWN);
  EXPECT_THAT(checked.report.unknown_because, ElementsAre(HasSubstr("leave no pair")));
}

TEST_F(TheMonitor, SeesThatWhatNeverMovesStands) {
  loadStanding();
  double x = 0.0;
  for (const char* link : {"a", "b", "c"}) publish(link, 1.0, x += 1.5, true);
  const Checked checked = check();
  ASSERT_EQ(checked.closing.pairs.size(), 3u);
  for (const ClosingMotion& pair : checked.closing.pairs) {
    EXPECT_TRUE(pair.known);
    EXPECT_EQ(pair.closing_speed, 0.0);
  }
}

/// A tool on an arm that slides on a base; reports are in the tool's frame, which lags.
class MonitorInAToolFrame : public testing::Test {
 protected:
  MonitorInAToolFrame() {
    SceneParameters parameters = parametersOf(
        emptyLink("base") + linkWith("arm", "<sphere radius='0.1'/>") +
        linkWith("tool", "<sphere radius='0.1'/>") + linkWith("cup", "<sphere radius='0.1'/>") +
        joint("slide", "prismatic", "base", "arm", "0 0 0", ALONG_X) +
        joint("lift", "prismatic", "arm", "tool", "0 0 0", ALONG_X) +
        joint("tilt", "prismatic", "base", "cup", "0 0 0", ALONG_X));
    parameters.fixed_frame = "tool";
    load(monitor_, std::move(parameters));
  }
  void publish(const std::string& parent, const std::string& child, double stamp, double x) {
    monitor_.take(transformOf(parent, child, ros::Time(stamp), x), false, "");
  }
  /// The tool was heard of that long before the others [s].
  void publishAll(double lag) {
    monitor_.advance(ros::Time(1000.0));
    publish("arm", "tool", 1000.0 - lag, 1.0);
    publish("base", "arm", 1000.0 - lag, 1.0);
    publish("base", "cup", 1000.0 - lag, 5.0);
    publish("base", "arm", 1000.0, 2.0);
    publish("base", "cup", 1000.0, 6.0);
  }
  Snapshot asked() const { return monitor_.withJoints(monitor_.scenes().active(), {}, {}); }

  static constexpr const char* ALONG_X = "<axis xyz='1 0 0'/><limit lower='-9' upper='9'/>";
  Monitor monitor_{[] {
    TransformSettings settings;
    settings.limits = {0.0, 0.5, 0.5};
    return settings;
  }()};
};

TEST_F(MonitorInAToolFrame, ARequestIsSuspectWhereTheReportIsForATransformThatLags) {
  publishAll(0.75);
  const ActiveScenePtr scene = monitor_.scenes().active();
  EXPECT_THAT(monitor_.at(scene).poses.unknown_because,
              Contains(HasSubstr("older than the newest of all")));
  const auto lags = Contains(HasSubstr("its newest transform is 0.75 s older"));
  EXPECT_THAT(asked().poses.unknown_because, lags);
  EXPECT_THAT(monitor_.withMeasured(scene, {}, {}).poses.unknown_because, lags);
}

TEST_F(MonitorInAToolFrame, ARequestHasAllPosesAtOneInstantAsTheReport) {
  publishAll(0.25);
  const Snapshot report = monitor_.at(monitor_.scenes().active()), request = asked();
  EXPECT_THAT(request.poses.unknown_because, testing::IsEmpty());
  EXPECT_EQ(request.stamp, ros::Time(999.75));
  BodyPoses poses;
  poses.resize(report.poses.known.size());
  request.joints->posesAt({}, poses);
  for (std::size_t i = 0; i < poses.X_WB.size(); ++i) {
    EXPECT_TRUE(poses.X_WB[i].isApprox(report.poses.X_WB[i])) << i;
  }
}

TEST_F(TheMonitor, NamesTenSuspectLinksCountsTheRestAndSaysWhatIsRefused) {
  std::string urdf = emptyLink("root");
  for (char link = 'a'; link < 'm'; ++link) {
    urdf += linkWith({link}, "<sphere radius='0.5'/>") +
            joint(std::string("to_") + link, "floating", "root", {link}, "0 0 0", "");
  }
  load(monitor_, parametersOf(urdf));
  for (int i = 0; i < 12; ++i) publish(std::string("f") + static_cast<char>('a' + i), 0.0, 1.0);
  const std::vector<std::string> reasons = snapshot().poses.unknown_because;
  ASSERT_EQ(reasons.size(), 10u + 1u + 10u);
  for (int i = 0; i < 10; ++i) {
    EXPECT_THAT(reasons[i], HasSubstr(std::string("link '") + static_cast<char>('a' + i)));
  }
  EXPECT_EQ(reasons[10], "and 2 more links");
  EXPECT_EQ(reasons[11], "refused " + monitor_.transforms().refused()[0]);
}

TEST_F(TheMonitor, NamesTenLinksWithoutGeometryAndCountsTheRest) {
  const auto reasonFor = [&](int count) {
    std::string urdf = emptyLink("root");
    for (int i = 0; i < count; ++i) {
      const std::string name = "l" + std::to_string(100 + i);
      urdf += linkWith(name, "<mesh filename='package://nowhere/mesh.stl'/>") +
              joint("to_" + name, "fixed", "root", name, "0 0 0", "");
    }
    load(monitor_, parametersOf(urdf));
    return snapshot().poses.unknown_because.front();
  };
  EXPECT_EQ(reasonFor(10),
            "geometry that could not be read: l100, l101, l102, l103, l104, l105, l106, l107, "
            "l108, l109");
  EXPECT_EQ(reasonFor(12), reasonFor(10) + " and 2 more");
}

TEST_F(TheMonitor, DoesNotMindWhatIsRefusedOfOthers) {
  double x = 0.0;
  for (const char* link : {"a", "b", "c"}) slide(link, x += 5.0, 0.0);
  publish("of_nobody", 0.0, 1.0);
  ASSERT_EQ(monitor_.transforms().refused().size(), 1u);
  EXPECT_THAT(snapshot().poses.unknown_because, testing::IsEmpty());
}

TEST_F(TheMonitor, SuspectsASceneThatWasReplacedMeanwhile) {
  double x = 0.0;
  for (const char* link : {"a", "b", "c"}) slide(link, x += 5.0, 0.0);
  const ActiveScenePtr old = monitor_.scenes().active();
  EXPECT_THAT(monitor_.at(old).poses.unknown_because, testing::IsEmpty());
  load(monitor_, parametersOf(urdf_));
  EXPECT_THAT(monitor_.at(old).poses.unknown_because,
              ElementsAre("the scene was replaced meanwhile"));
  EXPECT_THAT(snapshot().poses.unknown_because, testing::IsEmpty());
}

TEST_F(TheMonitor, TakesNoSceneThatWasNotBuiltOrIsOfAnOldOne) {
  SceneJob first = monitor_.scenes().load(parametersOf(urdf_)), second = first;
  EXPECT_FALSE(monitor_.scenes().take(first)) << "it was not run";
  first.run();
  second.run();
  EXPECT_TRUE(monitor_.scenes().take(first));
  EXPECT_FALSE(monitor_.scenes().take(second));
  EXPECT_EQ(monitor_.scenes().active(), first.scene());
}

// before the suspect span begins b is known, at an instant that a was heard of last.
TEST_F(TheMonitor, SuspectsALinkThatIsBehindOneThatIsSuspect) {
  for (const bool are_two : {false, true}) {
    Monitor monitor({{0.0, 1.0, 0.5}, false, false});
    std::string urdf = emptyLink("root");
    for (const std::string link : {"a", "b"}) {
      urdf += linkWith(link, "<sphere radius='0.5'/>") +
              joint("to_" + link, "floating", "root", link, "0 0 0", "");
    }
    load(monitor, parametersOf(urdf));
    const auto publish = [&](const std::string& link, double stamp, double x,
                             const std::string& by) {
      monitor.advance(ros::Time(stamp));
      monitor.take(transformOf("root", link, ros::Time(stamp), x), false, by);
    };
    for (double stamp = 999.9; stamp < 1001.28; stamp += 0.05) {
      if (std::abs(stamp - 1000.0) < 0.01) publish("a", stamp, 0.0, "one");
      publish("b", stamp, 5.0, "one");
      if (are_two && stamp > 1001.1) publish("b", stamp + 0.02, 7.0, "other");
    }
    monitor.advance(ros::Time(1001.3));
    const Snapshot snapshot = monitor.at(monitor.scenes().active());
    EXPECT_THAT(snapshot.poses.unknown_because, testing::Contains(HasSubstr("link 'a'")))
        << are_two;
  }
}

/// Who says that the root hangs on a link makes a cycle.
TEST_F(TheMonitor, KnowsNoLinkOfACycleWhereAllThatIsKnownStands) {
  loadStanding();
  for (const char* const link : {"a", "b", "c"}) publish(link, 0.0, 2.0 * (link[0] - 'a'), true);
  ASSERT_EQ(check().report.verdict, Verdict::FREE);
  monitor_.take(transformOf("a", "root", ros::Time(999.9), 50.0), false, "calibration");
  EXPECT_THAT(check().report.unknown_because, Contains(HasSubstr("form a cycle")));
}

TEST_F(TheMonitor, PlacesNoSuspectLinkByTheRootThatHangsOnIt) {
  slide("b", 2.0, 0.0);
  slide("c", 4.0, 0.0);
  for (const double stamp : {999.7, 999.8, 1000.0}) publish("a", stamp, 0.0);
  ASSERT_EQ(check().report.verdict, Verdict::FREE);
  monitor_.take(transformOf("root", "a", ros::Time(999.9), -20.0), false, "another");
  for (const double stamp : {999.9, 1000.0}) {
    monitor_.take(transformOf("a", "root", ros::Time(stamp), 50.0), false, "calibration");
  }
  EXPECT_EQ(check().report.verdict, Verdict::UNKNOWN);
}

TEST_F(TheMonitor, SaysThatNothingIsKnownBeforeTheFirstClock) {
  now_ = ros::Time();
  EXPECT_EQ(snapshot().poses.unknown_because.front(), NO_CLOCK);
}

TEST(Request, IsRefusedForANumberThatIsNotFinite) {
  CheckCollisions::Request request;
  for (double* number : {&request.alarm_distance, &request.tolerance, &request.time_budget}) {
    for (const double value : {HUGE_VAL, -HUGE_VAL, std::nan("")}) {
      *number = value;
      EXPECT_THROW(settingsFor(request, CheckSettings()), InputError);
    }
    *number = 0.0;
  }
  CheckSettings node;
  node.tolerance = 0.25;
  EXPECT_EQ(settingsFor(request, node).tolerance, 0.25);
  request.tolerance = -1.0;  // none
  EXPECT_EQ(settingsFor(request, node).tolerance, 0.0);
  request.tolerance = 0.5;
  EXPECT_EQ(settingsFor(request, node).tolerance, 0.5);
}

TEST(Request, SaysWhatIsOtherThanTheNodesSettings) {
  CheckSettings node;
  node.alarm_distance = 0.1;
  node.time_budget = 0.01;
  node.fidelity = Fidelity::CONVEX;
  node.verdict_only = node.min_distance = true;
  CheckCollisions::Request request;
  CheckSettings settings = settingsFor(request, node);
  EXPECT_EQ(settings.alarm_distance, 0.1);
  EXPECT_EQ(settings.time_budget, 0.01);
  EXPECT_EQ(settings.fidelity, Fidelity::CONVEX);
  EXPECT_FALSE(settings.verdict_only) << "that is the request's alone";
  EXPECT_FALSE(settings.min_distance);
  request.alarm_distance = request.time_budget = -1.0;  // none
  request.fidelity = "obb";
  request.verdict_only = request.min_distance = true;
  settings = settingsFor(request, node);
  EXPECT_EQ(settings.alarm_distance, 0.0);
  EXPECT_EQ(settings.time_budget, 0.0);
  EXPECT_EQ(settings.fidelity, Fidelity::OBB);
  EXPECT_TRUE(settings.verdict_only);
  EXPECT_TRUE(settings.min_distance);
  request.alarm_distance = 0.3;
  request.time_budget = 0.5;
  settings = settingsFor(request, node);
  EXPECT_EQ(settings.alarm_distance, 0.3);
  EXPECT_EQ(settings.time_budget, 0.5);
}

}  // namespace collision_pairs::test_monitor
