// What the node says of its health, and that its services' threads do not delay its cycle.
#include <algorithm>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>

#include "node_health.h"
#include "printed.h"
#include "thread_priority.h"

namespace collision_pairs::test_node_health {

using diagnostic_msgs::DiagnosticStatus;
using testing::HasSubstr;

constexpr double PERIOD = 0.02;  // s

diagnostic_updater::DiagnosticStatusWrapper diagnosisAfter(NodeHealth& health, int nb_in_time,
                                                           int nb_too_long) {
  const CollisionPairs free;
  for (int i = 0; i < nb_in_time; ++i) health.noteCycle(free, 0.0, 0.5 * PERIOD, PERIOD);
  for (int i = 0; i < nb_too_long; ++i) health.noteCycle(free, 0.0, 1.5 * PERIOD, PERIOD);
  diagnostic_updater::DiagnosticStatusWrapper status;
  health.diagnose(status);
  return status;
}

TEST(NodeHealth, OverrunsAreWarnedOfOnlyWhereTheyAreFrequent) {
  NodeHealth health;
  EXPECT_EQ(diagnosisAfter(health, 45, 5).level, DiagnosticStatus::OK);  // a tenth
  const auto status = diagnosisAfter(health, 44, 6);
  EXPECT_EQ(status.level, DiagnosticStatus::WARN);
  EXPECT_THAT(status.message, HasSubstr("6 of 50 cycles took longer than their period of 0.02 s"));
  EXPECT_THAT(status.message, HasSubstr("lower rate or fidelity, or set time_budget"));
}

TEST(NodeHealth, OverrunsCountSinceTheLastDiagnosis) {
  NodeHealth health;
  EXPECT_EQ(diagnosisAfter(health, 0, 1).level, DiagnosticStatus::WARN);
  EXPECT_EQ(diagnosisAfter(health, 10, 0).level, DiagnosticStatus::OK);
  EXPECT_EQ(diagnosisAfter(health, 0, 0).level, DiagnosticStatus::OK);
  EXPECT_EQ(diagnosisAfter(health, 1000, 0).level, DiagnosticStatus::OK);
  EXPECT_EQ(diagnosisAfter(health, 0, 100).level, DiagnosticStatus::WARN);
}

TEST(NodeHealth, AParameterThatIsNoneIsWarnedOfForAsLongAsTheSceneHasIt) {
  NodeHealth health;
  health.noteScene({"parameter /node/max_pos_age is not a parameter of this node"}, {});
  for (int i = 0; i < 2; ++i) {
    const auto status = diagnosisAfter(health, 10, 0);
    EXPECT_EQ(status.level, DiagnosticStatus::WARN);
    EXPECT_THAT(status.message, HasSubstr("/node/max_pos_age"));
  }
  health.noteScene({}, {"'a': open"});
  EXPECT_EQ(diagnosisAfter(health, 10, 0).level, DiagnosticStatus::OK);
}

TEST(NodeHealth, AProblemStaysAnErrorBesideOverruns) {
  NodeHealth health;
  health.noteCycle({}, 0.0, 2.0 * PERIOD, PERIOD);
  health.noteProblem("there is no robot");
  diagnostic_updater::DiagnosticStatusWrapper status;
  health.diagnose(status);
  EXPECT_EQ(status.level, DiagnosticStatus::ERROR);
  EXPECT_THAT(status.message, HasSubstr("there is no robot"));
}

class Health : public testing::Test {
 protected:
  void noteCycle(std::uint8_t verdict, double cycle_time = 0.001) {
    CollisionPairs message;
    message.verdict = verdict;
    if (verdict == CollisionPairs::UNKNOWN) message.unknown_because = {"no usable pose: arm"};
    health_.noteCycle(message, 0.01, cycle_time, 0.02);
  }
  DiagnosticStatus status() {
    diagnostic_updater::DiagnosticStatusWrapper status;
    health_.diagnose(status);
    return status;
  }
  std::string value(const std::string& key) {
    for (const auto& entry : status().values) {
      if (entry.key == key) return entry.value;
    }
    return "there is no " + key;
  }
  NodeHealth health_;
};

TEST_F(Health, IsWellWhateverTheVerdictIfThereIsOne) {
  for (const std::uint8_t verdict : {CollisionPairs::FREE, CollisionPairs::COLLISION}) {
    noteCycle(verdict);
    EXPECT_EQ(status().level, DiagnosticStatus::OK);
    EXPECT_EQ(status().message, "checking");
  }
  EXPECT_EQ(value("verdict"), "COLLISION");
  noteCycle(CollisionPairs::UNKNOWN);
  EXPECT_EQ(status().level, DiagnosticStatus::WARN);
  EXPECT_THAT(status().message, HasSubstr("no usable pose: arm"));
}

TEST_F(Health, WarnsWhileTransformsAreRefused) {
  noteCycle(CollisionPairs::FREE);
  health_.noteTransforms({"transform of 'arm': its stamp is zero"}, 0);
  EXPECT_EQ(status().level, DiagnosticStatus::WARN);
  EXPECT_THAT(value("transforms refused"), HasSubstr("'arm'"));
  health_.noteTransforms({}, 0);
  EXPECT_EQ(status().level, DiagnosticStatus::OK);
}

TEST_F(Health, WarnsOfDescriptionsThatHaveChanged) {
  noteCycle(CollisionPairs::FREE);
  health_.noteDescriptions("/robot_description has changed");
  EXPECT_EQ(status().level, DiagnosticStatus::WARN);
  EXPECT_THAT(status().message, HasSubstr("/robot_description has changed"));
  health_.noteDescriptions("");
  EXPECT_EQ(status().level, DiagnosticStatus::OK);
}

TEST_F(Health, TellsHowOftenTheClockWentBackSinceTheStart) {
  for (const unsigned nb_clock_jumps : {1u, 1u, 2u}) health_.noteTransforms({}, nb_clock_jumps);
  EXPECT_EQ(value("times the clock went back"), "2");
}

TEST_F(Health, IsAnErrorWithoutAVerdictWhereNothingIsChecked) {
  CollisionPairs message;
  message.verdict = CollisionPairs::COLLISION;
  message.left_out = {"arm"};
  message.nb_pairs = 7;
  message.pairs.resize(1);
  message.pairs[0].state = CollisionPair::UNRESOLVED;
  health_.noteCycle(message, 0.01, 0.001, 0.02);
  EXPECT_EQ(value("unresolved pairs"), "1");
  EXPECT_EQ(status().message, "links are left out; unresolved pairs");
  health_.noteProblem("there is no robot");
  EXPECT_EQ(status().level, DiagnosticStatus::ERROR);
  EXPECT_THAT(status().message, HasSubstr("there is no robot"));
  EXPECT_EQ(value("verdict"), "UNKNOWN");
  EXPECT_EQ(value("transform age [s]"), "no usable transform");
  EXPECT_EQ(value("links left out"), "") << "that was an earlier cycle's";
  EXPECT_EQ(value("nb_pairs"), "0");
  EXPECT_EQ(value("unresolved pairs"), "0");
}

TEST(NodeHealth, HasCountedNothingBeforeTheFirstCycle) {
  NodeHealth health;
  diagnostic_updater::DiagnosticStatusWrapper status;
  health.diagnose(status);
  EXPECT_EQ(printed(static_cast<DiagnosticStatus&>(status)),
            "level 2 message not checking: no cycle yet values[0] key verdict value UNKNOWN "
            "values[1] key transform age [s] value no usable transform values[2] key cycle time "
            "[s] values[3] key cycles values[4] key overruns values[5] key cycles out of time "
            "values[6] key times the clock went back values[7] key links left out values[8] key "
            "transforms refused values[9] key open meshes values[10] key nb_boxes values[11] key "
            "nb_pairs values[12] key degraded pairs values[13] key unresolved pairs");
}

TEST(LowPriority, IsOfTheThreadAndOfThoseThatItStartsAndRaisesNone) {
  const auto priority = [] { return getpriority(PRIO_PROCESS, 0); };
  const int before = priority();
  std::thread([&] {
    setpriority(PRIO_PROCESS, 0,
                0);  // may not be allowed, if the test itself runs with a lower one
    const int expected = std::max(priority(), 10);
    lowerThreadPriority();
    EXPECT_EQ(priority(), expected);
    std::thread([&] { EXPECT_EQ(priority(), expected); }).join();
    setpriority(PRIO_PROCESS, 0, 15);
    lowerThreadPriority();
    EXPECT_EQ(priority(), 15);
  }).join();
  EXPECT_EQ(priority(), before);
}

/// Every sentence and number at once.
TEST(NodeHealth, SaysAllThatItKnows) {
  NodeHealth health;
  CollisionPairs message;
  message.verdict = CollisionPairs::UNKNOWN;
  message.unknown_because = {"no usable pose: arm", "a cloud"};
  message.left_out = {"arm", "hand"};
  message.nb_boxes = 11;
  message.nb_pairs = 12;
  message.nb_degraded = 13;
  message.budget_spent = true;
  message.pairs.resize(3);
  message.pairs[1].state = message.pairs[2].state = CollisionPair::UNRESOLVED;
  for (int i = 0; i < 3; ++i) health.noteCycle(message, 0.125, 0.5, 0.25);
  message.budget_spent = false;
  health.noteCycle(message, 0.125, 0.25, 0.25);  // as long as the period is in time
  health.noteScene({"a parameter is none", "another"}, {"'a': open", "'b': open"});
  health.noteTransforms({"'a' refused", "'b' refused"}, 7);
  health.noteDescriptions("/robot_description has changed");
  diagnostic_updater::DiagnosticStatusWrapper status;
  health.diagnose(status);
  EXPECT_EQ(
      printed(static_cast<DiagnosticStatus&>(status)),
      "level 1 message the verdict is UNKNOWN: no usable pose: arm; a cloud; links are left out; "
      "/robot_description has changed; unresolved pairs; transforms are refused; a parameter is "
      "none; another; 3 of 4 cycles took longer than their period of 0.25 s: lower rate or "
      "fidelity, or set time_budget values[0] key verdict value UNKNOWN values[1] key transform "
      "age [s] value 0.125 values[2] key cycle time [s] value 0.25 values[3] key cycles value 4 "
      "values[4] key overruns value 3 values[5] key cycles out of time value 3 values[6] key times "
      "the clock went back value 7 values[7] key links left out value arm hand values[8] key "
      "transforms refused value 'a' refused; 'b' refused values[9] key open meshes value 'a': "
      "open; 'b': open values[10] key nb_boxes value 11 values[11] key nb_pairs value 12 "
      "values[12] key degraded pairs value 13 values[13] key unresolved pairs value 2");
  message.verdict = CollisionPairs::FREE;
  message.unchecked = "nothing is checked";
  health.noteCycle(message, std::nullopt, 0.125, 0.25);
  health.diagnose(status);
  EXPECT_THAT(status.message, HasSubstr("; nothing is checked; "));
  health.noteProblem("why");
  health.diagnose(status);
  EXPECT_EQ(status.message.substr(0, 50), "not checking: why; /robot_description has changed;");
}

}  // namespace collision_pairs::test_node_health
