#include "node_health.h"

#include <algorithm>
#include <utility>

#include "user_text.h"

namespace collision_pairs {
namespace {

constexpr double FREQUENT = 0.1;  // of the cycles that overrun

}  // namespace

void NodeHealth::noteCycle(const CollisionPairs& message, std::optional<double> pose_age,
                           double cycle_time, double cycle_period) {
  problem_.clear();
  pose_age_ = pose_age;
  cycle_time_ = cycle_time;
  cycle_period_ = cycle_period;
  nb_unresolved_ = static_cast<std::size_t>(
      std::count_if(message.pairs.begin(), message.pairs.end(),
                    [](const CollisionPair& p) { return p.state == CollisionPair::UNRESOLVED; }));
  last_ = message;
  last_.pairs.clear();
  ++cycles_;
  if (message.budget_spent) ++out_of_time_;
  if (cycle_time > cycle_period) ++overruns_;
}

void NodeHealth::noteProblem(const std::string& problem) {
  problem_ = problem;
  pose_age_.reset();
  last_ = CollisionPairs();
  nb_unresolved_ = 0;
}

void NodeHealth::diagnose(diagnostic_updater::DiagnosticStatusWrapper& status) {
  using diagnostic_msgs::DiagnosticStatus;
  if (!problem_.empty()) {
    status.summary(DiagnosticStatus::ERROR, "not checking: " + problem_);
  } else {
    status.summary(DiagnosticStatus::OK, "checking");
  }
  if (problem_.empty() && last_.verdict == CollisionPairs::UNKNOWN) {
    status.mergeSummary(DiagnosticStatus::WARN,
                        "the verdict is UNKNOWN: " + joined(last_.unknown_because, "; "));
  }
  if (!last_.left_out.empty()) status.mergeSummary(DiagnosticStatus::WARN, "links are left out");
  if (!changed_.empty()) status.mergeSummary(DiagnosticStatus::WARN, changed_);
  if (nb_unresolved_ > 0) status.mergeSummary(DiagnosticStatus::WARN, "unresolved pairs");
  if (!refused_.empty()) status.mergeSummary(DiagnosticStatus::WARN, "transforms are refused");
  if (last_.verdict != CollisionPairs::UNKNOWN && !last_.unchecked.empty()) {
    status.mergeSummary(DiagnosticStatus::WARN, last_.unchecked);
  }
  for (const std::string& warning : warnings_) {
    status.mergeSummary(DiagnosticStatus::WARN, warning);
  }
  const std::uint64_t new_cycles = cycles_ - std::exchange(told_cycles_, cycles_);
  const std::uint64_t new_overruns = overruns_ - std::exchange(told_overruns_, overruns_);
  if (static_cast<double>(new_overruns) > FREQUENT * static_cast<double>(new_cycles)) {
    status.mergeSummaryf(DiagnosticStatus::WARN,
                         "%llu of %llu cycles took longer than their period of %g s: lower rate or "
                         "fidelity, or set time_budget",
                         static_cast<unsigned long long>(new_overruns),
                         static_cast<unsigned long long>(new_cycles), cycle_period_);
  }
  static const char* const VERDICTS[] = {"FREE", "COLLISION", "UNKNOWN"};
  status.add("verdict", problem_.empty() ? VERDICTS[last_.verdict] : "UNKNOWN");
  if (pose_age_) {
    status.add("transform age [s]", *pose_age_);
  } else {
    status.add("transform age [s]", "no usable transform");
  }
  status.add("cycle time [s]", cycle_time_);
  status.add("cycles", cycles_);
  status.add("overruns", overruns_);
  status.add("cycles out of time", out_of_time_);
  status.add("times the clock went back", nb_clock_jumps_);
  status.add("links left out", joined(last_.left_out, " "));
  status.add("transforms refused", joined(refused_, "; "));
  status.add("open meshes", joined(open_meshes_, "; "));
  status.add("nb_boxes", last_.nb_boxes);
  status.add("nb_pairs", last_.nb_pairs);
  status.add("degraded pairs", last_.nb_degraded);
  status.add("unresolved pairs", nb_unresolved_);
}

}  // namespace collision_pairs
