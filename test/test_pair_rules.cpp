// Which pairs a scene looks at: every rule by itself, then all of them against a plain reading.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "arm_scene.h"
#include "random_robot.h"

namespace collision_pairs::test_pair_rules {

using testing::HasSubstr;
using Verdict = PairRule::Verdict;

TEST(PairRules, DenyTakesPairsOutInEitherOrderOfNames) {
  SceneDescription description = armScene("");
  const std::size_t before = allowedPairs(description).size();
  description.settings.pair_rules = {{Verdict::DENY, "head", "finger_*"}};
  const Names denied = allowedPairs(description);
  description.settings.pair_rules = {{Verdict::DENY, "finger_*", "head"}};
  EXPECT_EQ(allowedPairs(description), denied);
  EXPECT_EQ(denied.size(), before - 2);
  EXPECT_EQ(denied.count({"finger_1", "head"}), 0u);
}

TEST(PairRules, AllowBringsBackWhatTheSrdfSwitchesOff) {
  SceneDescription description = armScene(
      "<disable_default_collisions link='head'/>"
      "<disable_collisions link1='elbow' link2='base'/>");
  EXPECT_EQ(allowedPairs(description).count({"base", "head"}), 0u);
  description.settings.pair_rules = {{Verdict::ALLOW, "head", "*"}};
  EXPECT_EQ(allowedPairs(description).count({"base", "head"}), 1u);
  EXPECT_EQ(allowedPairs(description).count({"base", "elbow"}), 0u);
}

TEST(PairRules, TheLastThatMatchesDecides) {
  SceneDescription description = armScene("");
  description.settings.pair_rules = {{Verdict::DENY, "*", "*"},
                                     {Verdict::ALLOW, "head", "finger_*"},
                                     {Verdict::DENY, "finger_2", "*"}};
  EXPECT_EQ(allowedPairs(description), (Names{{"finger_1", "head"}}));
}

TEST(PairRules, HoldForObjectsThatComeLater) {
  SceneDescription description = armScene("");
  description.settings.pair_rules = {{Verdict::DENY, "crate_*", "finger_*"}};
  description.objects = {ball("crate_7"), ball("table")};
  const Names names = allowedPairs(description);
  EXPECT_EQ(names.count({"crate_7", "finger_1"}), 0u);
  EXPECT_EQ(names.count({"crate_7", "elbow"}), 1u);
  EXPECT_EQ(names.count({"finger_1", "table"}), 1u);
}

TEST(PairRules, AnUnknownNameIsRefusedWithTheNearestOne) {
  const auto withRule = [](const std::string& name) {
    SceneDescription description = armScene("");
    description.settings.pair_rules = {{Verdict::DENY, name, "head"}};
    return description;
  };
  EXPECT_THAT(refusal(withRule("elbo")),
              HasSubstr("pair_rules names 'elbo', which is not a link of robot"));
  EXPECT_THAT(refusal(withRule("elbo")), HasSubstr("did you mean 'elbow'?"));
  EXPECT_EQ(refusal(withRule("elbo*")), "accepted");
}

TEST(Ignore, TakesALinkOutAltogether) {
  SceneDescription description = armScene("");
  description.settings.ignored_links = {"finger_*"};
  EXPECT_EQ(CollisionScene::build(description)->findModel("finger_1"), -1);
  description.settings.ignored_links = {"hed"};
  EXPECT_THAT(refusal(description), HasSubstr("did you mean 'head'?"));
}

class Groups : public testing::TestWithParam<std::pair<const char*, std::set<std::string>>> {};

// Of the pairs that are left, one link at least is in what the group moves.
TEST_P(Groups, MoveTheLinksBelowTheirJoints) {
  const auto& [inner, moved] = GetParam();
  SceneDescription description = armScene(
      "<virtual_joint name='world_joint' type='planar' parent_frame='odom' "
      "child_link='base'/>"
      "<group name='other'><joint name='to_wrist'/></group>"
      "<group name='g'>" +
      std::string(inner) + "</group>");
  const Names all = allowedPairs(description);
  description.restriction.group = "g";
  Names expected;
  for (const auto& pair : all) {
    if (moved.count(pair.first) || moved.count(pair.second)) expected.insert(pair);
  }
  EXPECT_EQ(allowedPairs(description), expected);
}

const std::set<std::string> HAND = {"wrist", "finger_1", "finger_2"};
INSTANTIATE_TEST_SUITE_P(
    AsInMoveIt, Groups,
    testing::Values(std::make_pair("<joint name='to_wrist'/>", HAND),
                    std::make_pair("<link name='wrist'/>", HAND),
                    std::make_pair("<chain base_link='elbow' tip_link='wrist'/>", HAND),
                    std::make_pair("<chain base_link='wrist' tip_link='finger_2'/>",
                                   std::set<std::string>{"finger_2"}),
                    std::make_pair("<group name='other'/>", HAND),
                    std::make_pair("<group name='g'/><group name='other'/>", HAND),
                    std::make_pair("<joint name='to_head'/><link name='finger_1'/>",
                                   std::set<std::string>{"head", "finger_1"}),
                    std::make_pair("<joint name='world_joint'/>",
                                   std::set<std::string>{"base", "shoulder", "elbow", "wrist",
                                                         "finger_1", "finger_2", "head"})));

/// Of each link in the root.
std::vector<Eigen::Isometry3d> linkPoses(const RobotModel& robot,
                                         const std::vector<double>& positions) {
  std::vector<Eigen::Isometry3d> X_RB, X_RL;
  robot.forwardKinematics(positions, X_RB);
  for (const Link& link : robot.links()) X_RL.push_back(X_RB[link.body] * link.X_BL);
  return X_RL;
}

TEST(GroupsOfRandomRobots, MoveWhateverMovesWhenTheirJointsDoByMimicryToo) {
  RandomInputs random;
  int nb_by_mimicry = 0;
  for (int i = 0; i < 300; ++i) {
    const auto robot = randomRobot(random, random.integer(3, 8));
    SceneDescription description;
    description.robots.push_back({robot, Srdf(), ""});
    Srdf::Group group;
    group.name = "g";
    std::vector<double> positions = randomPositions(random, *robot);
    const auto before = linkPoses(*robot, positions);
    for (const Joint& joint : robot->joints()) {
      if (!joint.hasPosition() || joint.mimic || random.integer(0, 1)) continue;
      group.joints.push_back(joint.name);
      positions[static_cast<std::size_t>(robot->findJoint(joint.name))] += 0.1;
    }
    if (group.joints.empty()) continue;
    robot->applyMimics(positions);
    const auto after = linkPoses(*robot, positions);
    const Names all = allowedPairs(description);
    description.robots[0].srdf->groups = {group};
    description.restriction.group = "g";
    const Names checked = allowedPairs(description);
    const auto moves = [&](const std::string& link) {
      const auto at = static_cast<std::size_t>(robot->findLink(link));
      return !before[at].isApprox(after[at], 1e-9);
    };
    for (const auto& pair : all) {
      if (!moves(pair.first) && !moves(pair.second)) continue;
      EXPECT_EQ(checked.count(pair), 1u)
          << "case " << i << ": " << pair.first << " " << pair.second;
    }
    for (const Joint& joint : robot->joints()) {
      nb_by_mimicry += joint.mimic && moves(robot->links()[joint.child_link].name);
    }
  }
  EXPECT_GT(nb_by_mimicry, 30);
}

TEST(Restriction, NamesAnUnknownGroupOrLinkWithTheNearest) {
  SceneDescription description = armScene(
      "<group name='arm'><link name='elbow'/></group>"
      "<group name='wrong'><joint name='nowhere'/><link name='head'/></group>"
      "<group name='empty'/>");
  description.restriction.group = "wrong";
  EXPECT_THAT(refusal(description), HasSubstr("group 'wrong' names joint 'nowhere'"));
  description.restriction.group = "amr";
  EXPECT_THAT(refusal(description), HasSubstr("no group 'amr'"));
  EXPECT_THAT(refusal(description), HasSubstr("did you mean 'arm'?"));
  description.restriction.group = "empty";
  EXPECT_THAT(refusal(description), HasSubstr("moves no link"));
  description.restriction = {"", {"hand"}};
  EXPECT_THAT(refusal(description), HasSubstr("did you mean 'head'?"));
  description.robots[0].srdf.reset();
  description.restriction = {"arm", {}};
  EXPECT_THAT(refusal(description), HasSubstr("has no SRDF"));
}

// That of the robot without a prefix begins with any name.
TEST(Restriction, AGroupIsOfTheRobotWhosePrefixItBeginsWith) {
  const auto robot = robotFrom(slidingBoxes(2));
  const Srdf srdf = Srdf::fromXml(
      "<robot name='r'><group name='g'><link name='a'/></group>"
      "<group name='right/g'><link name='a'/></group></robot>");
  for (const bool plain_first : {true, false}) {
    SceneDescription description;
    description.robots.push_back({robot, srdf, plain_first ? "" : "right"});
    description.robots.push_back({robot, srdf, plain_first ? "right" : ""});
    description.restriction.group = "right/g";
    const auto scene = CollisionScene::build(description);
    const auto allowed = [&](const char* first, const char* second) {
      return scene->filter().allowed(static_cast<std::uint32_t>(scene->findModel(first)),
                                     static_cast<std::uint32_t>(scene->findModel(second)));
    };
    EXPECT_TRUE(allowed("right/a", "b"));
    EXPECT_FALSE(allowed("a", "b"));
  }
}

TEST(Restriction, TakesWhatHangsOnItsLinksAlong) {
  SceneDescription description = armScene("");
  description.objects = {ball("tool", "wrist"), ball("table")};
  description.restriction.names = {"wrist"};
  const Names names = allowedPairs(description);
  EXPECT_EQ(names.count({"table", "tool"}), 1u);
  EXPECT_EQ(names.count({"head", "tool"}), 1u);
  EXPECT_EQ(names.count({"head", "table"}), 0u);
}

TEST(Restriction, TakesWhatHangsOnItsLinksAlongWhereTheyHaveNoGeometry) {
  SceneDescription description;
  description.robots.push_back(
      {robotFrom(boxLink("base", 1) + boxLink("arm", 1) + "<link name='tool0'/>" +
                 joint("turn", "continuous", "base", "arm", "0 0 1", "<axis xyz='0 1 0'/>") +
                 joint("mount", "fixed", "arm", "tool0", "0 0 1")),
       std::nullopt, ""});
  description.objects = {ball("gripper", "tool0"), ball("table")};
  const Names of_gripper = {{"base", "gripper"}, {"arm", "gripper"}, {"gripper", "table"}};
  for (const char* name : {"tool0", "tool?"}) {
    description.restriction.names = {name};
    EXPECT_EQ(allowedPairs(description), of_gripper) << name;
  }
  description.restriction.names = {"arm"};
  description.settings.ignored_links = {"arm"};
  description.objects[0].attached_link = "arm";
  EXPECT_EQ(allowedPairs(description), (Names{{"base", "gripper"}, {"gripper", "table"}}));
}

TEST(PassiveJoints, AreCheckedAsAllOthers) {
  EXPECT_EQ(allowedPairs(armScene("<passive_joint name='to_head'/>")), allowedPairs(armScene("")));
}

TEST(AttachedObjects, AreCheckedAgainstAllButTheirLinkAndWhatTheyMayTouch) {
  SceneDescription description = armScene("<disable_default_collisions link='wrist'/>");
  description.objects = {ball("tool", "wrist", {"finger_1", "box"}), ball("box"), ball("table"),
                         ball("sensor", "wrist"), ball("hat", "head")};
  const Names names = allowedPairs(description);
  for (const char* partner : {"wrist", "finger_1", "box", "sensor"}) {
    EXPECT_EQ(names.count(std::minmax(std::string("tool"), std::string(partner))), 0u) << partner;
  }
  for (const char* partner : {"finger_2", "elbow", "base", "table", "hat"}) {
    EXPECT_EQ(names.count(std::minmax(std::string("tool"), std::string(partner))), 1u) << partner;
  }
}

TEST(TouchLinks, OfWhatStandsDoNotSpeakForWhatTheyName) {
  SceneDescription description = armScene("");
  description.objects = {ball("tool", "wrist", {"shelf"}),
                         ball("shelf"),
                         ball("tray", "", {"shelf"}),
                         ball("table"),
                         ball("a box", "", {"a", "b"}),
                         ball("a"),
                         ball("b")};
  const Names names = allowedPairs(description);
  EXPECT_EQ(names.count({"shelf", "tool"}), 0u);
  for (const char* partner : {"tray", "table", "a box"}) {
    EXPECT_EQ(names.count(std::minmax(std::string("tool"), std::string(partner))), 1u) << partner;
  }
}

TEST(TouchLinks, OfNamesWithSpacesAreNotTakenForOthers) {
  SceneDescription description = armScene("");
  description.objects = {ball("tool", "wrist"), ball("hat", "head"), ball("hat tool", "elbow"),
                         ball("box", "", {"hat", "tool"}), ball("crate", "", {"hat tool"})};
  const Names names = allowedPairs(description);
  EXPECT_EQ(names.count({"crate", "tool"}), 1u);
  EXPECT_EQ(names.count({"crate", "hat tool"}), 0u);
  EXPECT_EQ(names.count({"box", "hat tool"}), 1u);
}

/// The same, read as plainly as it can be written.
bool plainlyAllowed(const SceneDescription& description, const std::string& a,
                    const std::string& b) {
  const auto objectNamed = [&](const std::string& name) -> const RigidObject* {
    for (const RigidObject& object : description.objects) {
      if (object.name == name) return &object;
    }
    return nullptr;
  };
  const RigidObject *of_a = objectNamed(a), *of_b = objectNamed(b);
  const auto stands = [](const RigidObject* object) {
    return object && object->attached_link.empty();
  };
  if (stands(of_a) && stands(of_b)) return false;
  if (of_a && of_b && of_a->attached_link == of_b->attached_link) return false;
  const auto touches = [](const RigidObject* object, const std::string& other) {
    if (!object) return false;
    const auto& links = object->touch_links;
    return object->attached_link == other ||
           std::find(links.begin(), links.end(), other) != links.end();
  };
  if (touches(of_a, b) || touches(of_b, a)) return false;
  bool allowed = true;
  if (!of_a && !of_b) {
    const Srdf& srdf = *description.robots[0].srdf;
    const auto has = [&](const std::vector<Srdf::LinkPair>& pairs) {
      const Srdf::LinkPair pair = std::minmax(a, b);
      return std::find(pairs.begin(), pairs.end(), pair) != pairs.end();
    };
    for (const std::string& link : srdf.disabled_links) {
      if (link == a || link == b) allowed = false;
    }
    if (has(srdf.enabled_pairs)) allowed = true;
    if (has(srdf.disabled_pairs)) allowed = false;
  }
  for (const PairRule& rule : description.settings.pair_rules) {
    if ((matches(rule.first, a) && matches(rule.second, b)) ||
        (matches(rule.first, b) && matches(rule.second, a))) {
      allowed = rule.verdict == Verdict::ALLOW;
    }
  }
  return allowed;
}

TEST(PairRules, AllTogetherAreAsTheyReadPairByPair) {
  RandomInputs random;
  const std::vector<std::string> links = {"base",     "shoulder", "elbow", "wrist",
                                          "finger_1", "finger_2", "head"};
  const std::vector<std::string> objects = {"crate_1", "crate_2", "table", "tool", "hat"};
  const std::vector<std::string> patterns = {"*",     "finger_*", "crate_*", "head",
                                             "elbow", "t*",       "?at",     "base"};
  const auto anyOf = [&](const std::vector<std::string>& names) {
    return names[static_cast<std::size_t>(random.integer(0, static_cast<int>(names.size()) - 1))];
  };
  std::size_t nb_allowed = 0, nb_pairs = 0;
  for (int round = 0; round < 200; ++round) {
    SceneDescription description = armScene("");
    Srdf& srdf = *description.robots[0].srdf;
    for (int i = random.integer(0, 2); i > 0; --i) srdf.disabled_links.push_back(anyOf(links));
    for (int i = random.integer(0, 6); i > 0; --i) {
      srdf.disabled_pairs.push_back(std::minmax(anyOf(links), anyOf(links)));
      srdf.enabled_pairs.push_back(std::minmax(anyOf(links), anyOf(links)));
    }
    for (const std::string& name : objects) {
      RigidObject object = ball(name, random.integer(0, 1) ? anyOf(links) : "");
      if (random.integer(0, 1)) object.touch_links = {anyOf(links), anyOf(objects)};
      description.objects.push_back(object);
    }
    for (int i = random.integer(0, 4); i > 0; --i) {
      description.settings.pair_rules.push_back(
          {random.integer(0, 1) ? Verdict::ALLOW : Verdict::DENY, anyOf(patterns),
           anyOf(patterns)});
    }
    std::set<std::string> names(links.begin(), links.end());
    names.insert(objects.begin(), objects.end());
    Names expected;
    for (const std::string& a : names) {
      for (const std::string& b : names) {
        if (a < b && plainlyAllowed(description, a, b)) expected.emplace(a, b);
      }
    }
    ASSERT_EQ(allowedPairs(description), expected) << "round " << round;
    nb_allowed += expected.size();
    nb_pairs += names.size() * (names.size() - 1) / 2;
  }
  EXPECT_GT(nb_allowed, nb_pairs / 10);
  EXPECT_LT(nb_allowed, nb_pairs * 9 / 10);
}

}  // namespace collision_pairs::test_pair_rules
