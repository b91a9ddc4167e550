#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "demo_scene.h"
#include "joint_states_csv.h"

namespace collision_pairs {
namespace {

std::shared_ptr<const RobotModel> robot() {
  const std::string limit = "<limit lower='-3' upper='3'/>";
  return robotFrom(emptyLink("l0") + emptyLink("l1") + emptyLink("l2") + emptyLink("l3") +
                   emptyLink("l4") + emptyLink("l5") + joint("pan", "revolute", "l0", "l1") +
                   joint("lift", "prismatic", "l1", "l2") + joint("weld", "fixed", "l2", "l3") +
                   joint("follow", "revolute", "l3", "l4", "0 0 0",
                         limit + "<mimic joint='pan' multiplier='2'/>") +
                   joint("loose", "floating", "l4", "l5", "0 0 0", ""));
}

JointStates read(const std::string& csv) { return readJointStates(csv, *robot(), "s.csv"); }

std::string refusal(const std::string& csv) {
  try {
    read(csv);
  } catch (const InputError& error) {
    return error.what();
  }
  return "accepted";
}

TEST(JointStatesCsv, ColumnsMayComeInAnyOrderAndMimicsFollow) {
  const auto model = robot();
  const JointStates states = read("lift,pan\n0.5,0.25\n1,-1\n");
  ASSERT_EQ(states.positions.size(), 2u);
  EXPECT_EQ(states.positions[0][model->findJoint("lift")], 0.5);
  EXPECT_EQ(states.positions[0][model->findJoint("pan")], 0.25);
  EXPECT_EQ(states.positions[0][model->findJoint("follow")], 0.5);
  EXPECT_EQ(states.joints_at_zero, std::vector<std::string>{"loose"});  // floating: has no column
}

TEST(JointStatesCsv, WindowsLineEndsAndBlankLastLinesAreAccepted) {
  EXPECT_EQ(read("pan,lift\r\n1,2\r\n\r\n\n  \n").positions.size(), 1u);
  EXPECT_EQ(read("pan,lift\n1,2").positions.size(), 1u);
  EXPECT_EQ(read(" \"pan\" , lift\n +1e-1 , 2 ").positions.size(), 1u);
  EXPECT_EQ(read("pan,lift\n\" 1 \",2").positions.size(), 1u);
}

TEST(JointStatesCsv, NamesMayBeQuotedAsRfc4180Says) {
  const auto model = robotFrom(emptyLink("a") + emptyLink("b") + emptyLink("c") +
                               joint("x, &quot;y&quot;&#10; z", "revolute", "a", "b") +
                               joint(" q", "revolute", "b", "c"));
  const JointStates states =
      readJointStates("\"x, \"\"y\"\"\n z\" ,\t\" q\"\n0.5,\"0.25\"\n", *model, "s.csv");
  ASSERT_EQ(states.positions.size(), 1u);
  EXPECT_EQ(states.positions[0], (std::vector<double>{0.5, 0.25}));
  EXPECT_THAT(refusal("pan\n1\n\"2\n3\n"),
              testing::HasSubstr("line 3: a quotation mark is not closed"));
  EXPECT_THAT(refusal("\"pan\nlift\"\n1\n"), testing::HasSubstr("line 1: joint 'pan lift'"));
  EXPECT_THAT(refusal("\"pan\"\n1\n\"2\n\"\n3,4\n"), testing::HasSubstr("line 5: 2 fields"));
}

TEST(JointStatesCsv, JointsWithoutColumnAreNamed) {
  EXPECT_EQ(read("pan\n1\n").joints_at_zero, (std::vector<std::string>{"lift", "loose"}));
}

TEST(JointStatesCsv, MimicColumnIsAcceptedWhereItAgrees) {
  EXPECT_EQ(refusal("pan,follow\n0.5,1\n"), "accepted");
  for (const char* elsewhere : {"0.7", "1.3"}) {
    EXPECT_THAT(refusal(std::string("pan,follow\n0.5,") + elsewhere + "\n"),
                testing::HasSubstr("line 2: joint 'follow'"));
  }
}

TEST(JointStatesCsv, WrongColumnsAreRefusedByName) {
  EXPECT_THAT(refusal("pan,elbow\n1,2\n"),
              testing::HasSubstr("s.csv line 1: joint 'elbow' is not in robot"));
  EXPECT_THAT(refusal("weld\n1\n"), testing::HasSubstr("'weld' is fixed"));
  EXPECT_THAT(refusal("loose\n1\n"), testing::HasSubstr("'loose' is fixed, floating or planar"));
  EXPECT_THAT(refusal("pan,pan\n1,1\n"), testing::HasSubstr("joint 'pan' is named twice"));
  EXPECT_THAT(refusal("pan,\n1,1\n"), testing::HasSubstr("joint ''"));
  EXPECT_THAT(refusal("follow\n1\n"), testing::HasSubstr("line 1: joint 'follow' mimics 'pan'"));
  EXPECT_THAT(refusal(""), testing::HasSubstr("no header"));
}

TEST(JointStatesCsv, WrongFieldsAreRefusedWithTheirLine) {
  EXPECT_THAT(refusal("pan,lift\n1,2\n1\n"), testing::HasSubstr("line 3: 1 fields"));
  EXPECT_THAT(refusal("pan,lift\n1,2,3\n"), testing::HasSubstr("3 fields"));
  for (const char* text : {"nan", "inf", "1.0x", "one", "1 2", "0x10", "--1", "+-1", "1.2.3", "1-2",
                           "1e", "1e5e3", "e5", "."}) {
    EXPECT_THAT(refusal("pan\n" + std::string(text) + "\n"),
                testing::HasSubstr("line 2: joint 'pan': '" + std::string(text) + "' is not"))
        << text;
  }
  EXPECT_THAT(refusal("pan\nnan\n"), testing::HasSubstr("'nan' is not a finite number"));
  EXPECT_THAT(refusal("pan,lift\n1,\n"), testing::HasSubstr("joint 'lift': '' is not"));
  EXPECT_THAT(refusal("pan\n1\n\n2\n"), testing::HasSubstr("line 4: a row after the blank line 3"));
}

}  // namespace
}  // namespace collision_pairs
