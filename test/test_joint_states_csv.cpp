#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "demo_scene.h"
#include "joint_limits.h"
#include "joint_states_csv.h"
#include "refusal.h"

namespace collision_pairs::test_joint_states_csv {

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
  return collision_pairs::refusal([&] { read(csv); });
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
  EXPECT_THAT(refusal("\"pan\nlift\"\n1\n"), testing::HasSubstr("line 1: joint 'pan lift'"));
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

TEST(JointStatesCsv, WhatIsWrongIsRefusedInTheseWords) {
  const std::vector<std::pair<std::string, std::string>> cases = {
      {"", "s.csv: no header; it must name the joints"},
      {"\n \t\r\n", "s.csv: no header; it must name the joints"},
      {"\npan,lift\n1\n", "s.csv line 3: 1 fields, but the header has 2"},
      {"pan,lift\n1,2\n1\n", "s.csv line 3: 1 fields, but the header has 2"},
      {"pan,lift\n1,2,3\n", "s.csv line 2: 3 fields, but the header has 2"},
      {"\"pan\"\n1\n\"2\n\"\n3,4\n", "s.csv line 5: 2 fields, but the header has 1"},
      {"pan\n1\n\n \n2\n", "s.csv line 5: a row after the blank line 3"},
      {"pan\n1\n\"2\n3\n", "s.csv line 3: a quotation mark is not closed"},
      {"pan\nnan\n", "s.csv line 2: joint 'pan': 'nan' is not a finite number"},
      {"pan,lift\n1,\n", "s.csv line 2: joint 'lift': '' is not a finite number"},
  };
  for (const auto& [csv, words] : cases) EXPECT_EQ(refusal(csv), words) << csv;
  EXPECT_THAT(refusal("pan,elbow\n1,2\n"),
              testing::StartsWith("s.csv line 1: joint 'elbow' is not in robot"));
  EXPECT_THAT(refusal("weld\n1\n"), testing::HasSubstr("'weld' is fixed"));
  EXPECT_THAT(refusal("loose\n1\n"), testing::HasSubstr("'loose' is fixed, floating or planar"));
  EXPECT_THAT(refusal("pan,pan\n1,1\n"), testing::HasSubstr("joint 'pan' is named twice"));
  EXPECT_THAT(refusal("pan,\n1,1\n"), testing::HasSubstr("joint ''"));
  EXPECT_THAT(refusal("follow\n1\n"), testing::HasSubstr("line 1: joint 'follow' mimics 'pan'"));
}

TEST(JointStatesCsv, ARobotWithoutAPositionHasABlankHeaderAndARowABlankLine) {
  const auto rigid = robotFrom(emptyLink("a") + emptyLink("b") + joint("weld", "fixed", "a", "b"));
  for (const auto& [csv, nb_rows] : {std::pair{"\n", 0}, {"\n\n", 1}, {" \r\n\t\n\n", 2}}) {
    EXPECT_EQ(readJointStates(csv, *rigid, "s.csv").positions.size(), nb_rows) << '"' << csv << '"';
  }
}

// A quotation is a whole field: none of its neighbours makes a number of it.
TEST(JointStatesCsv, WhatStandsBesideAQuotationIsNotTaken) {
  for (const std::string before : {"", " ", "x"}) {
    for (const std::string quoted : {"", " ", "0", "1"}) {
      for (const std::string after : {"", " ", "5", " 5", "\"5\"", " \"5\""}) {
        const std::string field = before + '"' + quoted + '"' + after;
        const bool is_number = before != "x" && quoted.find_first_of("01") == 0 &&
                               after.find('5') == std::string::npos;
        EXPECT_EQ(refusal("pan\n" + field + "\n") == "accepted", is_number) << field;
      }
    }
  }
}

TEST(JointStatesCsv, WrongNumbersAreRefused) {
  for (const char* text : {"nan", "inf", "1.0x", "one", "1 2", "0x10", "--1", "+-1", "1.2.3", "1-2",
                           "1e", "1e5e3", "e5", "."}) {
    EXPECT_THAT(refusal("pan\n" + std::string(text) + "\n"),
                testing::HasSubstr("line 2: joint 'pan': '" + std::string(text) + "' is not"))
        << text;
  }
}

TEST(JointLimits, EachJointOutsideIsSaidOnceWithHowOftenAndWhereFirst) {
  const auto limit = [](const char* range) { return std::string("<limit ") + range + "/>"; };
  const auto model = robotFrom(
      emptyLink("l0") + emptyLink("l1") + emptyLink("l2") + emptyLink("l3") + emptyLink("l4") +
      joint("pan", "revolute", "l0", "l1", "0 0 0", limit("lower='-1' upper='2'")) +
      joint("lift", "prismatic", "l1", "l2", "0 0 0", limit("lower='0' upper='0.5'")) +
      joint("unlimited", "prismatic", "l2", "l3", "0 0 0", limit("lower='0' upper='0'")) +
      joint("spin", "continuous", "l3", "l4", "0 0 0", ""));
  const double just = 0.9e-6, more = 1.1e-6;
  const auto said = [&](const std::vector<std::vector<double>>& states) {
    return outsideLimits(states, *model, "waypoint");
  };
  EXPECT_TRUE(said({}).empty());
  EXPECT_TRUE(
      said(
          {{-1, 0, 9, 9}, {2, 0.5, -9, -9}, {-1 - just, -just, 0, 0}, {2 + just, 0.5 + just, 0, 0}})
          .empty());
  const std::string pan = "joint 'pan' is outside its limits, -1 to 2, at ";
  const std::string lift = "joint 'lift' is outside its limits, 0 to 0.5, at ";
  using testing::ElementsAre;
  EXPECT_THAT(said({{0, 0, 0, 0}, {2 + more, 0, 0, 0}, {-1 - more, -0.25, 0, 0}}),
              ElementsAre(pan + "2 waypoints; the first is waypoint 1, where it is 2",
                          lift + "1 waypoint; it is waypoint 2, where it is -0.25"));
  EXPECT_THAT(said({{-1.5, 0.5 + more, 0, 0}}),
              ElementsAre(pan + "1 waypoint; it is waypoint 0, where it is -1.5",
                          lift + "1 waypoint; it is waypoint 0, where it is 0.500001"));
}

}  // namespace collision_pairs::test_joint_states_csv
