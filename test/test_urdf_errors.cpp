#include <atomic>
#include <thread>

#include <console_bridge/console.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "demo_scene.h"
#include "refusal.h"

namespace collision_pairs::test_urdf_errors {

std::string refusalOfUrdf(const std::string& xml) {
  return refusal([&] { RobotModel::fromUrdf(xml, noMeshes); });
}

std::string refusalOf(const std::string& links_and_joints) {
  return refusalOfUrdf("<robot name='r'>\n" + links_and_joints + "</robot>");
}

struct Case {
  const char* name;
  std::string xml;  // inside <robot>
  const char* says;
};

std::string caseName(const testing::TestParamInfo<Case>& info) { return info.param.name; }

class UrdfError : public testing::TestWithParam<Case> {};

TEST_P(UrdfError, IsOneLineThatNamesTheThing) {
  const std::string message = refusalOf(GetParam().xml);
  EXPECT_THAT(message, testing::HasSubstr(GetParam().says));
  EXPECT_EQ(message.find('\n'), std::string::npos);
}

std::string shape(const std::string& geometry) { return linkWith("arm", geometry); }

std::string twoLinks(const std::string& joint_xml) {
  return emptyLink("a") + emptyLink("b") + joint_xml;
}

INSTANTIATE_TEST_SUITE_P(
    Geometry, UrdfError,
    testing::Values(
        Case{"NoSize", shape("<box/>"), "link 'arm': <box>: Box shape has no size"},
        Case{"TextSize", shape("<box size='1 one 1'/>"), "<box>: Unable to parse component [one]"},
        Case{"TwoNumbers", shape("<box size='1 1'/>"), "2 elements but 3 expected"},
        Case{"FourNumbers", shape("<box size='1 1 1 1'/>"), "4 elements but 3 expected"},
        Case{"NegativeSize", shape("<box size='1 -1 1'/>"), "box: a size is -1.0"},
        Case{"NanRadius", shape("<sphere radius='nan'/>"), "[nan] is not a valid float"},
        Case{"InfiniteRadius", shape("<sphere radius='inf'/>"), "[inf] is not a valid float"},
        Case{"HugeRadius", shape("<sphere radius='1e999'/>"), "[1e999] is not a valid float"},
        Case{"NegativeRadius", shape("<sphere radius='-0.1'/>"), "sphere: the radius is -0.1"},
        Case{"NoLength", shape("<cylinder radius='1'/>"), "must have both length and radius"},
        Case{"NegativeLength", shape("<cylinder radius='1' length='-1'/>"), "the length is -1.0"},
        Case{"UnknownShape", shape("<cone/>"), "Unknown geometry type 'cone'"},
        Case{"TwoShapes", shape("<sphere radius='1'/><box size='1 1 1'/>"),
             "<box> is one too many"},
        Case{"AStrayChildAfterAShape", shape("<sphere radius='1'/><origin xyz='0 0 1'/>"),
             "<origin> in <geometry> is not read; it belongs in <collision>"},
        Case{"AStrayChildBeforeAShape", shape("<material name='red'/><sphere radius='1'/>"),
             "<sphere> is one too many"},
        Case{"NoShape", shape(""), "Geometry tag contains no child element"},
        Case{"NoGeometry", "<link name='arm'><collision/></link>", "without <geometry>"},
        Case{"NoFilename", shape("<mesh/>"), "Mesh must contain a filename"},
        Case{"FlatScale", shape("<mesh filename='x' scale='1 0 1'/>"), "flattens"},
        Case{"MissingMesh", shape("<mesh filename='file:///x.stl'/>"),
             "link 'arm': mesh 'file:///x.stl'"},
        Case{"SecondOrigin", linkWith("arm", "<sphere radius='1'/>", "<origin/><origin/>"),
             "link 'arm': a second <origin> in one <collision>"},
        Case{"SecondGeometry",
             "<link name='arm'><collision><geometry><sphere radius='1'/></geometry><geometry>"
             "<sphere radius='2'/></geometry></collision></link>",
             "a second <geometry> in one <collision>; give it a <collision> of its own"},
        // urdfdom gives what it quotes to printf() as a format.
        Case{"WhatPrintfWouldExpand", shape("<box size='%n%s%n 1 1'/>"),
             "<box>: size '%n%s%n 1 1' holds more than numbers"},
        Case{"BadOrigin", linkWith("arm", "<sphere radius='1'/>", "<origin xyz='0 0'/>"),
             "<origin>: Parser found 2 elements"},
        Case{"NanRpy", linkWith("arm", "<sphere radius='1'/>", "<origin rpy='0 nan 0'/>"),
             "<origin>: Unable to parse component [nan]"}),
    caseName);

INSTANTIATE_TEST_SUITE_P(
    Tree, UrdfError,
    testing::Values(
        Case{"NoLinks", "", "No link elements found"},
        Case{"TwoRoots", emptyLink("a") + emptyLink("b"), "Two root links found: [a] and [b]"},
        Case{"Cycle", twoLinks(joint("x", "fixed", "a", "b") + joint("y", "fixed", "b", "a")),
             "No root link found"},
        Case{"CycleBesideTheRoot",
             emptyLink("root") +
                 twoLinks(joint("x", "fixed", "a", "b") + joint("y", "fixed", "b", "a")),
             "cycle"},
        Case{"OwnParent", emptyLink("root") + emptyLink("a") + joint("x", "fixed", "a", "a"),
             "cycle"},
        Case{"TwoParents",
             emptyLink("c") +
                 twoLinks(joint("w", "fixed", "a", "c") + joint("x", "fixed", "a", "b") +
                          joint("y", "fixed", "c", "b")),
             "link 'b' has two parents"},
        Case{"SameLinkTwice", emptyLink("a") + emptyLink("a"), "link 'a' is not unique"},
        Case{"SameJointTwice",
             emptyLink("c") +
                 twoLinks(joint("x", "fixed", "a", "b") + joint("x", "fixed", "a", "c")),
             "joint 'x' is not unique"},
        Case{"UnknownChild", twoLinks(joint("x", "fixed", "a", "nobody")),
             "child link [nobody] of joint [x] not found"},
        Case{"UnknownParent", twoLinks(joint("x", "fixed", "nobody", "b")),
             "parent link [nobody] of joint [x] not found"},
        Case{"NoName", "<link/>", "<link> has no name"},
        Case{"EmptyName", "<link name=''/>", "<link> has no name"},
        Case{"UnknownType", twoLinks(joint("x", "ball", "a", "b")), "no known type [ball]"},
        Case{"NoLimit", twoLinks(joint("x", "revolute", "a", "b", "0 0 0", "")),
             "does not specify limits"},
        Case{"CrossedLimits",
             twoLinks(joint("x", "revolute", "a", "b", "0 0 0", "<limit lower='1' upper='0'/>")),
             "lower limit is above"},
        Case{"ZeroAxis",
             twoLinks(joint("x", "continuous", "a", "b", "0 0 0", "<axis xyz='0 0 0'/>")),
             "axis is zero"},
        Case{"TextMultiplier",
             twoLinks(joint("x", "continuous", "a", "b", "0 0 0",
                            "<mimic joint='y' multiplier='two'/>")),
             "joint 'x': <mimic>: multiplier value (two) is not a valid float"},
        Case{"TextOffset",
             twoLinks(joint("x", "continuous", "a", "b", "0 0 0",
                            "<mimic joint='y' offset='nan'/>")),
             "joint 'x': <mimic>: offset value (nan) is not a valid float"}),
    caseName);

TEST(UrdfText, ThatIsNoUrdfIsRefused) {
  EXPECT_THAT(refusalOfUrdf(""), testing::HasSubstr("empty"));
  EXPECT_THAT(refusalOfUrdf("hello"), testing::HasSubstr("not well-formed"));
  EXPECT_THAT(refusalOfUrdf("<robot name='r'><link name='a'>"),
              testing::HasSubstr("not well-formed"));
  EXPECT_THAT(refusalOfUrdf("<robot name='r'/><robot name='s'/>"),
              testing::HasSubstr("second root element"));
  EXPECT_THAT(refusalOfUrdf("<sdf/>"), testing::HasSubstr("must be <robot>"));
  EXPECT_THAT(refusalOfUrdf("<robot><link name='a'/></robot>"),
              testing::HasSubstr("<robot> has no name"));
  EXPECT_THAT(refusalOfUrdf(std::string("<robot name='r'>\0</robot>", 25)),
              testing::HasSubstr("NUL"));
}

TEST(UrdfText, NestedTooDeeplyIsRefused) {
  std::string xml = "<robot name='r'>";
  for (int i = 0; i < 100000; ++i) xml += "<a>";
  EXPECT_THAT(refusalOfUrdf(xml), testing::HasSubstr("nested too deeply"));
}

TEST(UrdfText, AMimicOnAFixedJointMeansNothingAndIsWarnedOf) {
  const auto robot = RobotModel::fromUrdf(
      "<robot name='r'>\n" + emptyLink("root") +
          twoLinks(joint("turn", "continuous", "root", "a") + "\n" +
                   joint("weld", "fixed", "a", "b", "0 0 0", "<mimic joint='nobody'/>")) +
          "</robot>",
      noMeshes);
  EXPECT_FALSE(robot->joints()[robot->findJoint("weld")].mimic);
  EXPECT_THAT(robot->warnings(),
              testing::ElementsAre(testing::AllOf(testing::HasSubstr("URDF line 3: joint 'weld'"),
                                                  testing::HasSubstr("mimic"))));
  const auto two = RobotModel::merge({{robot, "left"}, {robot, "right"}});
  EXPECT_EQ(two->warnings().size(), 2u);
  EXPECT_THAT(
      refusalOf(twoLinks(joint("x", "floating", "a", "b", "0 0 0", "<mimic joint='x'/>"))),
      testing::HasSubstr("joint 'x': it mimics another, but has no position that could follow"));
}

// What is too small for a double is as good as zero; what is too large has no value.
TEST(UrdfText, ANumberThatUnderflowsIsZero) {
  const auto robot = RobotModel::fromUrdf(
      "<robot name='r'>" +
          linkWith("a", "<box size='1e-400 1 0.' />", "<origin xyz='-1e-400 1 +1e-999'/>") +
          "</robot>",
      noMeshes);
  const Element& element = robot->links()[0].elements[0];
  EXPECT_EQ(std::get<Box>(element.shape).size, Eigen::Vector3d(0.0, 1.0, 0.0));
  EXPECT_EQ(element.X_LE.translation(), Eigen::Vector3d(0.0, 1.0, 0.0));
  EXPECT_THAT(refusalOf(shape("<box size='1e400 1 1'/>")), testing::HasSubstr("[1e400]"));
  EXPECT_THAT(refusalOf(shape("<sphere radius='1e-400x'/>")), testing::HasSubstr("[1e-400x]"));
}

TEST(UrdfText, EntitiesAreNotExpanded) {
  const std::string bomb =
      "<!DOCTYPE robot [<!ENTITY a 'aaaaaaaaaa'><!ENTITY b '&a;&a;&a;&a;&a;&a;&a;&a;'>]>"
      "<robot name='&b;'><link name='l'/></robot>";
  EXPECT_LT(refusalOfUrdf(bomb).size(), 500u);
}

// urdfdom tells no line, so each fault stands on one of its own, between others that are sound.
TEST(UrdfText, LineOfTheFaultIsNamed) {
  const std::vector<std::string> LINES = {"<robot name='r'>",
                                          "<link name='a'><collision><geometry>",
                                          "<box size='1 1 1'/></geometry>",
                                          "<origin xyz='0 0 1'/>",
                                          "</collision><collision><geometry><sphere",
                                          "radius='1'/></geometry></collision></link>",
                                          "<link name='b'/>",
                                          "<joint name='x' type='revolute'>",
                                          "<parent link='a'/>",
                                          "<child link='b'/>",
                                          "<axis xyz='0 0 1'/>",
                                          "<limit lower='-1' upper='1'/></joint>",
                                          "</robot>"};
  const auto with = [&](std::size_t line, const std::string& from, const std::string& to) {
    std::string xml;
    for (std::size_t i = 0; i < LINES.size(); ++i) {
      std::string text = LINES[i];
      if (i + 1 == line) text.replace(text.find(from), from.size(), to);
      xml += text + "\n";
    }
    return refusalOfUrdf(xml);
  };
  ASSERT_EQ(with(1, "r", "r"), "accepted");
  EXPECT_THAT(with(3, "1 1 1", "1 x 1"), testing::StartsWith("URDF line 3: link 'a': <box>"));
  EXPECT_THAT(with(3, "size", "name"), testing::StartsWith("URDF line 3: "));
  EXPECT_THAT(with(4, "0 0 1", "0 0"), testing::StartsWith("URDF line 4: link 'a': <origin>"));
  EXPECT_THAT(with(6, "1", "one"), testing::StartsWith("URDF line 5: link 'a': <sphere>"));
  EXPECT_THAT(with(7, "'b'", "'a'"), testing::StartsWith("URDF line 7: link 'a'"));
  EXPECT_THAT(with(8, "revolute", "ball"), testing::StartsWith("URDF line 8: joint 'x'"));
  EXPECT_THAT(with(9, "'a'", "'c'"), testing::StartsWith("URDF line 8: joint 'x'"));
  EXPECT_THAT(with(11, "1", "0"), testing::StartsWith("URDF line 8: joint 'x'"));
  EXPECT_THAT(with(11, "1", "up"), testing::StartsWith("URDF line 11: joint 'x': <axis>"));
  EXPECT_THAT(with(12, "-1", "low"), testing::StartsWith("URDF line 12: joint 'x': <limit>"));
}

// Of a joint between others, whose own links would be missing first in a part of the file.
TEST(UrdfText, LineOfAJointWhoseLinkDoesNotExistIsNamedAmongMany) {
  std::string xml = "<robot name='r'>\n";
  for (int i = 0; i < 9; ++i) xml += emptyLink("l" + std::to_string(i)) + "\n";
  for (int i = 1; i < 9; ++i) {
    const std::string above = i == 4 ? "nobody" : "l" + std::to_string(i - 1);
    xml += joint("j" + std::to_string(9 - i), "fixed", above, "l" + std::to_string(i)) + "\n";
  }
  EXPECT_THAT(refusalOfUrdf(xml + "</robot>"), testing::StartsWith("URDF line 14: joint 'j5': "));
}

TEST(UrdfText, NumbersMayStandBetweenAnyBlanks) {
  const auto robot =
      RobotModel::fromUrdf("<robot name='r'>" + shape("<box size=' 1\t2\n 3 '/>") +
                               linkWith("round", "<sphere radius=' 0.5 '/>") +
                               joint("x", "fixed", "arm", "round", "0\t0  1") + "</robot>",
                           noMeshes);
  EXPECT_EQ(std::get<Box>(robot->links()[0].elements[0].shape).size, Eigen::Vector3d(1, 2, 3));
  EXPECT_EQ(std::get<Sphere>(robot->links()[1].elements[0].shape).radius, 0.5);
  EXPECT_EQ(robot->joints()[0].X_PJ.translation(), Eigen::Vector3d(0, 0, 1));
}

// The names are text: what urdfdom or XML could read otherwise in them comes back as it was.
TEST(UrdfText, ALinkMayHaveAnyName) {
  for (const std::string name :
       {" a  b ", "100 %s %n", "&lt;&amp;&quot;", "caf\xc3\xa9", "\xff\xfe"}) {
    const auto robot =
        RobotModel::fromUrdf("<robot name='r'>" + linkWith(name, "<sphere radius='1'/>") +
                                 emptyLink("end") + joint(name, "fixed", name, "end") + "</robot>",
                             noMeshes);
    const std::string as_read = name.front() == '&' ? "<&\"" : name;
    EXPECT_EQ(robot->links()[0].name, as_read);
    EXPECT_EQ(robot->joints()[0].name, as_read);
  }
}

// urdfdom says on console_bridge what it leaves out, and goes on.
TEST(UrdfText, WhatUrdfdomLeavesOutIsRefusedAlsoWhereItsMessagesAreOff) {
  const auto level = console_bridge::getLogLevel();
  console_bridge::setLogLevel(console_bridge::CONSOLE_BRIDGE_LOG_NONE);
  const std::string message = refusalOf(shape("<box size='1 1'/>"));
  console_bridge::setLogLevel(level);
  EXPECT_THAT(message, testing::HasSubstr("link 'arm': urdfdom does not read all of it"));
}

TEST(UrdfText, MessagesOfOtherThreadsGoWhereTheyWent) {
  struct Kept : console_bridge::OutputHandler {
    void log(const std::string& text, console_bridge::LogLevel, const char*, int) override {
      if (text == "of another thread") ++nb;
    }
    std::atomic<int> nb{0};
  } kept;
  console_bridge::useOutputHandler(&kept);
  std::atomic<bool> is_done{false};
  int nb_said = 0;
  std::thread other([&] {
    for (; !is_done || nb_said == 0; ++nb_said) CONSOLE_BRIDGE_logError("of another thread");
  });
  for (int i = 0; i < 200; ++i) {
    EXPECT_EQ(refusalOf(emptyLink("a")), "accepted");
    EXPECT_THAT(refusalOf(shape("<box size='1'/>")), testing::HasSubstr("1 elements"));
  }
  is_done = true;
  other.join();
  console_bridge::restorePreviousOutputHandler();
  EXPECT_EQ(kept.nb, nb_said);
}

TEST(UrdfText, WhatNobodyReadsCannotMakeItFail) {
  EXPECT_EQ(
      refusalOfUrdf("<robot name='r' version='nonsense'><material name=''/><gazebo><x/></gazebo>"
                    "<link name='a'><inertial><mass value='heavy'/></inertial>"
                    "<visual><geometry><cone/></geometry></visual></link></robot>"),
      "accepted");
}

}  // namespace collision_pairs::test_urdf_errors
