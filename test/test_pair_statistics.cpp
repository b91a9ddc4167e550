#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "collision_pairs/collision_detector.h"
#include "demo_scene.h"
#include "pair_class.h"
#include "pair_probe.h"
#include "pair_statistics.h"
#include "random_robot.h"

namespace collision_pairs::test_pair_statistics {

std::shared_ptr<const CollisionScene> everyPairOf(const std::shared_ptr<const RobotModel>& robot) {
  return CollisionScene::build(robot, Srdf{}, nullptr);
}

PairEvidence find(const std::vector<PairEvidence>& pairs, const CollisionScene& scene,
                  const std::string& first, const std::string& second) {
  for (const PairEvidence& pair : pairs) {
    if (scene.models()[pair.first].name == first && scene.models()[pair.second].name == second) {
      return pair;
    }
  }
  ADD_FAILURE() << "no pair " << first << '|' << second;
  return {};
}

/// Boxes on rails along x with room for contacts, a shelf fixed to the first, a lid that turns on
/// it.
std::string railsAndLid() {
  const auto rail = [](const std::string& child, const std::string& upper) {
    return joint("rail_" + child, "prismatic", "root", child, "0 0 0",
                 "<axis xyz='1 0 0'/><limit lower='0' upper='" + upper + "'/>");
  };
  return emptyLink("root") + boxLink("a", 1.0) + rail("a", "10") + boxLink("b", 1.0) +
         rail("b", "10") + boxLink("shelf", 1.0) +
         joint("screws", "fixed", "a", "shelf", "0 0 1.5", "") + boxLink("lid", 0.5) +
         joint("hinge", "continuous", "a", "lid", "0 3 0", "<axis xyz='0 0 1'/>");
}

class Counting : public testing::Test {
 protected:
  std::vector<PairEvidence> count(std::uint64_t samples, unsigned threads) const {
    return countContacts(scene_, JointSampler(robot_, 3), {samples, threads, {}});
  }

  std::shared_ptr<const RobotModel> robot_ = robotFrom(railsAndLid());
  std::shared_ptr<const CollisionScene> scene_ = everyPairOf(robot_);
};

TEST_F(Counting, CountsAreThoseOfACheckOfEachState) {
  const std::uint64_t samples = 3000;
  const JointSampler sampler(robot_, 3);
  CollisionDetector detector(scene_);
  std::vector<double> positions;
  std::vector<Eigen::Isometry3d> X_RB;
  BodyPoses poses;
  CheckSettings contacts_only;
  contacts_only.alarm_distance = 0.0;
  std::uint64_t expected = 0, first_contact = samples;
  for (std::uint64_t i = 0; i < samples; ++i) {
    sampler.draw(i, positions);
    robot_->forwardKinematics(positions, X_RB);
    scene_->gatherPoses(X_RB, poses);
    for (const PairReport& pair : detector.detect(poses, contacts_only).pairs) {
      if (scene_->models()[pair.first].name != "a") continue;
      if (scene_->models()[pair.second].name != "b" || pair.distance > 0.0) continue;
      ++expected;
      first_contact = std::min(first_contact, i);
    }
  }
  const PairEvidence ab = find(count(samples, 0), *scene_, "a", "b");
  EXPECT_EQ(ab.trials, samples);
  EXPECT_EQ(ab.contacts, expected);
  EXPECT_EQ(ab.nearest, 0.0);
  EXPECT_EQ(ab.nearest_state, first_contact);
  // Two points on [0, 10] are no further than 1 apart with probability 0.19: six deviations.
  EXPECT_NEAR(static_cast<double>(ab.contacts), 0.19 * 3000, 130);
}

TEST_F(Counting, NumberOfThreadsMakesNoDifference) {
  const auto one = count(5000, 1);
  for (const unsigned threads : {2u, 7u, 0u}) {
    const auto many = count(5000, threads);
    ASSERT_EQ(many.size(), one.size());
    for (std::size_t i = 0; i < one.size(); ++i) {
      EXPECT_EQ(many[i].contacts, one[i].contacts);
      EXPECT_EQ(many[i].trials, one[i].trials);
      EXPECT_EQ(many[i].nearest, one[i].nearest);
      EXPECT_EQ(many[i].nearest_state, one[i].nearest_state);
    }
  }
}

TEST_F(Counting, RigidAndAdjacentPairsAreKnownAsSuch) {
  const auto pairs = count(3000, 0);
  const PairEvidence rigid = find(pairs, *scene_, "a", "shelf");
  EXPECT_TRUE(rigid.rigid && rigid.adjacent);
  EXPECT_EQ(rigid.trials, 1u);
  const PairEvidence hinged = find(pairs, *scene_, "a", "lid");
  EXPECT_TRUE(hinged.adjacent && !hinged.rigid);
  EXPECT_EQ(hinged.trials, MEASURED_STATES);
  EXPECT_FALSE(find(pairs, *scene_, "lid", "shelf").adjacent);
}

// At one turn of the motor the arm, geared down, has made half a turn, and the lift a hundredth.
TEST(Counted, APairIsNotProvedWhereOneTurnOfAJointWithoutLimitsIsNotAllThatItsMimicsDo) {
  const auto classWith = [](const std::string& type, const std::string& multiplier) {
    const std::string follows =
        "<axis xyz='0 0 1'/><limit lower='-9' upper='9'/>"
        "<mimic joint='motor' multiplier='" +
        multiplier + "'/>";
    const auto robot = robotFrom(
        emptyLink("root") + boxLink("rotor", 0.1) + boxLink("arm", 0.1) + boxLink("post", 0.1) +
        joint("motor", "continuous", "root", "rotor", "0 0 5", "<axis xyz='0 0 1'/>") +
        joint("gear", type, "root", "arm", "1 0 0", follows) + emptyLink("mid") +
        joint("bolt", "fixed", "root", "mid", "0 0 0", "") +
        joint("hinge", "revolute", "mid", "post", "-3 0 0",
              "<axis xyz='0 0 1'/><limit lower='-0.1' upper='0.1'/>"));
    const auto scene = everyPairOf(robot);
    const auto evidence = countContacts(scene, JointSampler(robot, 3), {100, 1, {}});
    return std::string(className(classify(find(evidence, *scene, "arm", "post"), {0.9, 0.1, 0.0})));
  };
  EXPECT_EQ(classWith("revolute", "0.5"), "Unproven");
  EXPECT_EQ(classWith("continuous", "-1.5"), "Unproven");
  EXPECT_EQ(classWith("prismatic", "0.01"), "Unproven");
  EXPECT_EQ(classWith("prismatic", "1"), "Unproven");
  EXPECT_EQ(classWith("revolute", "-2"), "Never") << "the same after each turn";
  EXPECT_EQ(classWith("prismatic", "0"), "Never") << "stands";
}

TEST_F(Counting, TouchingAtZeroIsToldApartFromTouchingInRandomStates) {
  const auto pairs = count(1, 1);
  EXPECT_TRUE(find(pairs, *scene_, "a", "b").touches_at_zero);
  EXPECT_FALSE(find(pairs, *scene_, "b", "lid").touches_at_zero);
}

// In reality the kite, and what the guide carries, are anywhere.
TEST(Counted, APairWithAJointThatWasNotMovedIsNeitherNeverNorAlways) {
  const auto robot =
      robotFrom(railsAndLid() + boxLink("kite", 0.1) + boxLink("tail", 0.1) + boxLink("far", 1.0) +
                joint("string", "floating", "root", "kite", "0 0 9", "") +
                joint("knot", "fixed", "kite", "tail", "0 0 1", "") + boxLink("fin", 0.1) +
                joint("seam", "fixed", "kite", "fin", "0 0 2", "") +
                joint("guide", "prismatic", "a", "far", "0 0 0.6",
                      "<axis xyz='1 0 0'/><limit lower='0' upper='0'/>"));
  const auto scene = everyPairOf(robot);
  const ClassRules rules{0.9, 0.1, 0.0};
  const auto evidence = countContacts(scene, JointSampler(robot, 3), {100, 1, {}});
  const auto classOf = [&](const std::string& first, const std::string& second) {
    return std::string(className(classify(find(evidence, *scene, first, second), rules)));
  };
  EXPECT_EQ(classOf("a", "kite"), "Unproven") << "apart in all states";
  EXPECT_EQ(classOf("far", "kite"), "Unproven");
  EXPECT_EQ(classOf("far", "shelf"), "Unproven") << "in contact in all states";
  EXPECT_EQ(classOf("a", "far"), "Adjacent");
  EXPECT_EQ(classOf("fin", "tail"), "Never") << "rigid";
  const PairEvidence pair = find(evidence, *scene, "far", "kite");
  EXPECT_EQ(lowerBound(pair, 0.9), 0.0);
  EXPECT_EQ(upperBound(pair, 0.9), 1.0);
}

TEST_F(Counting, NearestIsAtMostAHundredthTooLarge) {
  // The lid is 3 beside the rail in y and turns about its middle, 0.25 √2 wide at most.
  const JointSampler sampler(robot_, 3);
  const PairEvidence b_lid = find(count(200, 0), *scene_, "b", "lid");
  std::vector<double> positions;
  double nearest = 1e9;
  for (std::uint64_t i = 0; i < 200; ++i) {
    sampler.draw(i, positions);
    const double along =
        std::abs(positions[robot_->findJoint("rail_a")] - positions[robot_->findJoint("rail_b")]);
    const double turn = positions[robot_->findJoint("hinge")];
    const double reach = 0.25 * (std::abs(std::cos(turn)) + std::abs(std::sin(turn)));
    // Beside each other, only y counts: b ends at 0.5.
    if (along < 0.5) nearest = std::min(nearest, 3.0 - 0.5 - reach);
  }
  EXPECT_LE(b_lid.nearest, nearest / 0.99);
  EXPECT_GE(b_lid.nearest, 3.0 - 0.5 - 0.25 * std::sqrt(2.0) - 1e-9);
  EXPECT_EQ(b_lid.contacts, 0u);
}

// The state may come after those of which distances are measured otherwise.
TEST_F(Counting, AStateWithinTheClearanceIsNoticedWhicheverItIs) {
  const std::uint64_t samples = 3000;
  const JointSampler sampler(robot_, 3);
  double least = std::numeric_limits<double>::infinity();
  PairProbe probe(scene_);
  const PairEvidence pair = find(count(1, 1), *scene_, "b", "lid");
  std::vector<double> positions;
  for (std::uint64_t state = 0; state < samples; ++state) {
    sampler.draw(state, positions);
    probe.place(positions);
    least = std::min(least, probe.distance(pair.first, pair.second, 99.0));
  }
  for (const double clearance : {least, 0.99999 * least}) {
    for (const unsigned threads : {1, 2}) {
      const auto found = countContacts(scene_, sampler, {samples, threads, {}, clearance});
      const PairClass is = classify(find(found, *scene_, "b", "lid"), {0.9, 0.1, clearance});
      EXPECT_STREQ(className(is), clearance == least ? "Near" : "Never") << clearance;
    }
  }
}

TEST(Counted, AtZeroAPairMayComeNearerThanAtRandom) {
  const auto robot = robotFrom(
      emptyLink("root") + boxLink("hub", 0.1) + boxLink("tip", 0.1) + boxLink("post", 0.1) +
      joint("hinge", "continuous", "root", "hub", "0 0 0", "<axis xyz='0 0 1'/>") +
      joint("bolt", "fixed", "hub", "tip", "1 0 0", "") + emptyLink("mid") +
      joint("screw", "fixed", "root", "mid", "0 0 0", "") +
      joint("rail", "prismatic", "mid", "post", "2 0 0",
            "<axis xyz='1 0 0'/><limit lower='0' upper='1'/>"));
  const auto scene = everyPairOf(robot);
  const auto classWith = [&](double clearance) {
    const auto found = countContacts(scene, JointSampler(robot, 3), {100, 1, {}, clearance});
    const PairEvidence pair = find(found, *scene, "post", "tip");
    EXPECT_GT(pair.nearest, 0.9 + 1e-6);
    return std::string(className(classify(pair, {0.9, 0.1, clearance})));
  };
  EXPECT_EQ(classWith(0.9 + 1e-9), "Near");
  EXPECT_EQ(classWith(0.9 - 1e-9), "Never");
}

TEST(PairProbe, OfSeveralElementsTheNearestCounts) {
  const auto boxAlong = [](const char* x) {
    return "<collision><origin xyz='" + std::string(x) +
           " 0 0'/><geometry><box size='1 1 1'/></geometry></collision>";
  };
  const auto robot =
      robotFrom("<link name='a'>" + boxAlong("-5") + boxAlong("0") + boxAlong("-3") + "</link>" +
                boxLink("b", 1.0) + joint("j", "fixed", "a", "b", "4 0 0", ""));
  const auto scene = everyPairOf(robot);
  PairProbe probe(scene);
  probe.place({0.0});
  EXPECT_NEAR(probe.distance(0, 1, 100.0), 3.0, 1e-12);
}

TEST(PairProbe, APairPlacedAloneIsWhereAllPlacedTogetherHaveIt) {
  RandomInputs random;
  for (int round = 0; round < 20; ++round) {
    const auto robot = randomRobot(random, 20);
    const auto scene = everyPairOf(robot);
    PairProbe together(scene), alone(scene);
    const auto nb_models = static_cast<std::uint32_t>(scene->models().size());
    for (int i = 0; i < 200; ++i) {
      const std::vector<double> positions = randomPositions(random, *robot);
      const auto first =
          static_cast<std::uint32_t>(random.integer(0, static_cast<int>(nb_models) - 2));
      const auto second = static_cast<std::uint32_t>(
          random.integer(static_cast<int>(first) + 1, static_cast<int>(nb_models) - 1));
      together.place(positions);
      for (int again = 0; again < 2; ++again) {  // with the bodies of the pair known already
        alone.placePair(first, second, positions);
        ASSERT_EQ(alone.distance(first, second, 10.0), together.distance(first, second, 10.0));
        ASSERT_EQ(alone.touches(first, second), together.touches(first, second));
      }
    }
  }
}

TEST_F(Counting, ProgressEndsWithAllStatesOnce) {
  for (const std::uint64_t samples : {1, 256, 257, 1000}) {
    std::vector<std::uint64_t> progress;
    countContacts(scene_, JointSampler(robot_, 3),
                  {samples, 2, [&](std::uint64_t done) { progress.push_back(done); }});
    EXPECT_TRUE(std::is_sorted(progress.begin(), progress.end()));
    EXPECT_EQ(progress.size(), (samples + 255) / 256);
    EXPECT_EQ(progress.back(), samples);
  }
}

TEST_F(Counting, ASearchLeavesAloneWhatTouchedAndWhatNoSearchIsFor) {
  const JointSampler sampler(robot_, 3);
  const std::vector<PairEvidence> before = count(300, 1);
  std::vector<PairEvidence> after = before;
  std::vector<std::uint64_t> progress;
  searchContacts(scene_, sampler,
                 {2, 300, 2, [&](std::uint64_t done) { progress.push_back(done); }}, after);
  int left_alone = 0;
  for (std::size_t i = 0; i < before.size(); ++i) {
    EXPECT_EQ(progress[i], i + 1);
    const bool touched = before[i].contacts > 0 || before[i].touches_at_zero;
    if (touched || before[i].adjacent || before[i].rigid) {
      ++left_alone;
      EXPECT_TRUE(after[i].found_state.empty());
      EXPECT_EQ(after[i].nearest, before[i].nearest);
    } else {
      EXPECT_LE(after[i].nearest, before[i].nearest);
      EXPECT_EQ(after[i].found_state.empty(), after[i].nearest > 0.0);
    }
  }
  EXPECT_EQ(progress.size(), before.size());
  EXPECT_GE(left_alone, 3);
}

TEST_F(Counting, ALinkWithoutAFiniteBoxIsRefused) {
  const auto far = robotFrom(
      emptyLink("root") + boxLink("a", 1.0) + boxLink("b", 1.0) +
      joint("j", "prismatic", "root", "a", "0 0 0", "<limit lower='1e308' upper='1.7e308'/>") +
      joint("k", "prismatic", "a", "b", "0 0 0", "<limit lower='1e308' upper='1.7e308'/>"));
  EXPECT_THROW(countContacts(everyPairOf(far), JointSampler(far, 1), {10, 2, {}}), InputError);
}

/// Two small balls, each on the end of a crank of length 1; the cranks' axes are 2.0005 apart, so
/// they meet only where both point at each other within about a degree.
std::string cranks(double apart, const std::string& joint_a = "continuous",
                   const std::string& limit_a = "") {
  const std::string ball = "<sphere radius='0.0005'/>";
  return emptyLink("root") + emptyLink("arm_a") + emptyLink("arm_b") + linkWith("a", ball) +
         linkWith("b", ball) +
         joint("crank_a", joint_a, "root", "arm_a", "0 0 0", "<axis xyz='0 0 1'/>" + limit_a) +
         joint("crank_b", "continuous", "root", "arm_b", std::to_string(apart) + " 0 0",
               "<axis xyz='0 0 1'/>") +
         joint("fix_a", "fixed", "arm_a", "a", "1 0 0", "") +
         joint("fix_b", "fixed", "arm_b", "b", "1 0 0", "");
}

PairEvidence searchedPair(const std::string& links, unsigned searches = 10, unsigned threads = 0) {
  const auto robot = robotFrom(links);
  const auto scene = everyPairOf(robot);
  const JointSampler sampler(robot, 1);
  auto pairs = countContacts(scene, sampler, {500, threads, {}});
  EXPECT_EQ(find(pairs, *scene, "a", "b").contacts, 0u);
  searchContacts(scene, sampler, {searches, 500, threads, {}}, pairs);
  return find(pairs, *scene, "a", "b");
}

TEST(Search, FindsAContactThatRandomStatesMiss) {
  const PairEvidence found = searchedPair(cranks(2.0005));
  ASSERT_FALSE(found.found_state.empty());
  EXPECT_EQ(found.nearest, 0.0);
  // The balls' centres, by hand.
  const auto robot = robotFrom(cranks(2.0005));
  const double a = found.found_state[robot->findJoint("crank_a")];
  const double b = found.found_state[robot->findJoint("crank_b")];
  const double dx = 2.0005 + std::cos(b) - std::cos(a), dy = std::sin(b) - std::sin(a);
  EXPECT_LE(std::hypot(dx, dy), 0.001 + 1e-12);
}

TEST(Search, ComesCloseToTheLeastDistanceWhereThereIsNoContact) {
  const PairEvidence found = searchedPair(cranks(2.1));
  EXPECT_TRUE(found.found_state.empty());
  EXPECT_GE(found.nearest, 0.099 - 1e-9);
  EXPECT_LE(found.nearest, 0.0991);
}

TEST(Search, StaysWithinTheLimitsOfTheJoints) {
  const PairEvidence found =
      searchedPair(cranks(2.0005, "revolute", "<limit lower='0.5' upper='3'/>"));
  EXPECT_TRUE(found.found_state.empty());
  // Ball a is at best at 0.5 rad, the circle of ball b is around (2.0005, 0).
  const double dx = 2.0005 - std::cos(0.5), dy = std::sin(0.5);
  EXPECT_NEAR(found.nearest, std::hypot(dx, dy) - 1.0 - 0.001, 1e-3);
}

TEST(Search, MoreSearchesAreNeverWorse) {
  for (const double apart : {2.002, 2.01, 2.05, 2.1, 2.2, 2.4}) {
    EXPECT_LE(searchedPair(cranks(apart), 6).nearest, searchedPair(cranks(apart), 1).nearest);
    EXPECT_LE(searchedPair(cranks(apart), 7).nearest, searchedPair(cranks(apart), 6).nearest);
  }
}

TEST(Search, NumberOfThreadsMakesNoDifference) {
  EXPECT_EQ(searchedPair(cranks(2.1), 10, 1).nearest, searchedPair(cranks(2.1), 10, 2).nearest);
}

}  // namespace collision_pairs::test_pair_statistics
