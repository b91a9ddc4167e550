// What the node says of its health.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "node_health.h"

namespace collision_pairs {
namespace {

using diagnostic_msgs::DiagnosticStatus;
using testing::HasSubstr;

constexpr double PERIOD = 0.02;  // s

diagnostic_updater::DiagnosticStatusWrapper diagnosisAfter(NodeHealth& health, int nb_in_time,
                                                           int nb_too_long) {
  const CollisionPairs free;
  for (int i = 0; i < nb_in_time; ++i) health.noteCycle(free, 0.0, 0.5 * PERIOD, PERIOD, 2);
  for (int i = 0; i < nb_too_long; ++i) health.noteCycle(free, 0.0, 1.5 * PERIOD, PERIOD, 2);
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

TEST(NodeHealth, AProblemStaysAnErrorBesideOverruns) {
  NodeHealth health;
  health.noteCycle({}, 0.0, 2.0 * PERIOD, PERIOD, 2);
  health.noteProblem("there is no robot");
  diagnostic_updater::DiagnosticStatusWrapper status;
  health.diagnose(status);
  EXPECT_EQ(status.level, DiagnosticStatus::ERROR);
  EXPECT_THAT(status.message, HasSubstr("there is no robot"));
}

}  // namespace
}  // namespace collision_pairs
