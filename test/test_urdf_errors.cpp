#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "demo_scene.h"

namespace collision_pairs {
namespace {

std::string refusal(const std::string& xml) {
  try {
    RobotModel::fromUrdf(xml, noMeshes);
  } catch (const InputError& error) {
    return error.what();
  }
  return "accepted";
}

std::string refusalOf(const std::string& links_and_joints) {
  return refusal("<robot name='r'>\n" + links_and_joints + "</robot>");
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
        Case{"NoSize", shape("<box/>"), "link 'arm': box: <box> has no size"},
        Case{"TextSize", shape("<box size='1 one 1'/>"), "'1 one 1' must be three finite numbers"},
        Case{"TwoNumbers", shape("<box size='1 1'/>"), "three finite numbers"},
        Case{"FourNumbers", shape("<box size='1 1 1 1'/>"), "three finite numbers"},
        Case{"NegativeSize", shape("<box size='1 -1 1'/>"), "is negative"},
        Case{"NanRadius", shape("<sphere radius='nan'/>"), "not a finite number"},
        Case{"InfiniteRadius", shape("<sphere radius='inf'/>"), "not a finite number"},
        Case{"HugeRadius", shape("<sphere radius='1e999'/>"), "not a finite number"},
        Case{"NegativeRadius", shape("<sphere radius='-0.1'/>"), "is negative"},
        Case{"NoLength", shape("<cylinder radius='1'/>"), "has no length"},
        Case{"NegativeLength", shape("<cylinder radius='1' length='-1'/>"), "is negative"},
        Case{"UnknownShape", shape("<cone/>"), "unknown shape <cone>"},
        Case{"TwoShapes", shape("<sphere radius='1'/><box size='1 1 1'/>"),
             "<box> is one too many"},
        Case{"AStrayChildAfterAShape", shape("<sphere radius='1'/><origin xyz='0 0 1'/>"),
             "<origin> in <geometry> is not read; it belongs in <collision>"},
        Case{"AStrayChildBeforeAShape", shape("<material name='red'/><sphere radius='1'/>"),
             "<material> is one too many"},
        Case{"NoShape", shape(""), "<geometry> is empty"},
        Case{"NoGeometry", "<link name='arm'><collision/></link>", "without <geometry>"},
        Case{"NoFilename", shape("<mesh/>"), "has no filename"},
        Case{"FlatScale", shape("<mesh filename='x' scale='1 0 1'/>"), "flattens"},
        Case{"MissingMesh", shape("<mesh filename='file:///x.stl'/>"),
             "link 'arm': mesh 'file:///x.stl'"},
        Case{"BadOrigin", linkWith("arm", "<sphere radius='1'/>", "<origin xyz='0 0'/>"),
             "origin: xyz '0 0'"},
        Case{"NanRpy", linkWith("arm", "<sphere radius='1'/>", "<origin rpy='0 nan 0'/>"), "rpy"}),
    caseName);

INSTANTIATE_TEST_SUITE_P(
    Tree, UrdfError,
    testing::Values(
        Case{"NoLinks", "", "has no <link>"},
        Case{"TwoRoots", emptyLink("a") + emptyLink("b"), "two root links, 'a' and 'b'"},
        Case{"Cycle", twoLinks(joint("x", "fixed", "a", "b") + joint("y", "fixed", "b", "a")),
             "cycle"},
        Case{"CycleBesideTheRoot",
             emptyLink("root") +
                 twoLinks(joint("x", "fixed", "a", "b") + joint("y", "fixed", "b", "a")),
             "cycle"},
        Case{"OwnParent", emptyLink("root") + emptyLink("a") + joint("x", "fixed", "a", "a"),
             "cycle"},
        Case{"TwoParents",
             emptyLink("c") +
                 twoLinks(joint("x", "fixed", "a", "b") + joint("y", "fixed", "c", "b")),
             "link 'b' has two parents"},
        Case{"SameLinkTwice", emptyLink("a") + emptyLink("a"), "a second link 'a'"},
        Case{"SameJointTwice",
             emptyLink("c") +
                 twoLinks(joint("x", "fixed", "a", "b") + joint("x", "fixed", "a", "c")),
             "a second joint 'x'"},
        Case{"UnknownChild", twoLinks(joint("x", "fixed", "a", "nobody")),
             "'nobody', which does not exist"},
        Case{"UnknownParent", twoLinks(joint("x", "fixed", "nobody", "b")),
             "'nobody', which does not exist"},
        Case{"NoName", "<link/>", "<link> has no name"},
        Case{"EmptyName", "<link name=''/>", "<link> has no name"},
        Case{"UnknownType", twoLinks(joint("x", "ball", "a", "b")), "unknown joint type 'ball'"},
        Case{"NoLimit", twoLinks(joint("x", "revolute", "a", "b", "0 0 0", "")), "has no <limit>"},
        Case{"CrossedLimits",
             twoLinks(joint("x", "revolute", "a", "b", "0 0 0", "<limit lower='1' upper='0'/>")),
             "lower limit is above"},
        Case{"ZeroAxis",
             twoLinks(joint("x", "continuous", "a", "b", "0 0 0", "<axis xyz='0 0 0'/>")),
             "axis is zero"},
        Case{"TextMultiplier",
             twoLinks(joint("x", "continuous", "a", "b", "0 0 0",
                            "<mimic joint='y' multiplier='two'/>")),
             "joint 'x': mimic: multiplier 'two' is not a finite number"},
        Case{"TextOffset",
             twoLinks(joint("x", "continuous", "a", "b", "0 0 0",
                            "<mimic joint='y' offset='nan'/>")),
             "joint 'x': mimic: offset 'nan' is not a finite number"}),
    caseName);

TEST(UrdfText, ThatIsNoUrdfIsRefused) {
  EXPECT_THAT(refusal(""), testing::HasSubstr("empty"));
  EXPECT_THAT(refusal("hello"), testing::HasSubstr("not well-formed"));
  EXPECT_THAT(refusal("<robot name='r'><link name='a'>"), testing::HasSubstr("not well-formed"));
  EXPECT_THAT(refusal("<robot name='r'/><robot name='s'/>"),
              testing::HasSubstr("second root element"));
  EXPECT_THAT(refusal("<sdf/>"), testing::HasSubstr("must be <robot>"));
  EXPECT_THAT(refusal("<robot><link name='a'/></robot>"),
              testing::HasSubstr("<robot> has no name"));
  EXPECT_THAT(refusal(std::string("<robot name='r'>\0</robot>", 25)), testing::HasSubstr("NUL"));
}

TEST(UrdfText, NestedTooDeeplyIsRefused) {
  std::string xml = "<robot name='r'>";
  for (int i = 0; i < 100000; ++i) xml += "<a>";
  EXPECT_THAT(refusal(xml), testing::HasSubstr("nested too deeply"));
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
  EXPECT_THAT(refusalOf(twoLinks(joint("x", "floating", "a", "b", "0 0 0", "<mimic joint='x'/>"))),
              testing::HasSubstr("a floating joint has no position that could follow"));
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
  EXPECT_THAT(refusalOf(shape("<box size='1e400 1 1'/>")), testing::HasSubstr("finite"));
  EXPECT_THAT(refusalOf(shape("<sphere radius='1e-400x'/>")), testing::HasSubstr("finite"));
}

TEST(UrdfText, EntitiesAreNotExpanded) {
  const std::string bomb =
      "<!DOCTYPE robot [<!ENTITY a 'aaaaaaaaaa'><!ENTITY b '&a;&a;&a;&a;&a;&a;&a;&a;'>]>"
      "<robot name='&b;'><link name='l'/></robot>";
  EXPECT_LT(refusal(bomb).size(), 500u);
}

TEST(UrdfText, LineOfTheFaultIsNamed) {
  EXPECT_THAT(refusal("<robot name='r'>\n\n" + shape("<box size='x'/>") + "</robot>"),
              testing::HasSubstr("URDF line 3"));
}

TEST(UrdfText, WhatNobodyReadsCannotMakeItFail) {
  EXPECT_EQ(refusal("<robot name='r' version='nonsense'><material name=''/><gazebo><x/></gazebo>"
                    "<link name='a'><inertial><mass value='heavy'/></inertial>"
                    "<visual><geometry><cone/></geometry></visual></link></robot>"),
            "accepted");
}

}  // namespace
}  // namespace collision_pairs
