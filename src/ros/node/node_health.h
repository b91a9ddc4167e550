// The health of the node for /diagnostics: whether checking works, not the verdict.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <collision_pairs/CollisionPairs.h>
#include <diagnostic_updater/diagnostic_updater.h>

namespace collision_pairs {

/// Used by the cycle's thread only.
class NodeHealth {
 public:
  /// A cycle with a check. Ages and times in seconds; without age, no pose was usable.
  void noteCycle(const CollisionPairs& message, std::optional<double> pose_age, double cycle_time,
                 double cycle_period);
  /// A cycle without a check: there is no scene, or an error.
  void noteProblem(const std::string& problem);
  /// What to say of descriptions that have changed since they were read; empty: none has.
  void noteDescriptions(std::string changed) { changed_ = std::move(changed); }
  /// Of the scene in use: warnings of its parameters, and its meshes that enclose nothing.
  void noteScene(std::vector<std::string> warnings, std::vector<std::string> open_meshes) {
    warnings_ = std::move(warnings);
    open_meshes_ = std::move(open_meshes);
  }
  void noteTransforms(std::vector<std::string> refused, unsigned nb_clock_jumps) {
    refused_ = std::move(refused);
    nb_clock_jumps_ = nb_clock_jumps;
  }

  /// Warns of overruns if more than a tenth of the cycles since the last call took longer than
  /// their period.
  void diagnose(diagnostic_updater::DiagnosticStatusWrapper& status);

 private:
  std::string problem_ = "no cycle yet";
  std::optional<double> pose_age_;
  double cycle_time_ = 0.0, cycle_period_ = 0.0;
  CollisionPairs last_;  // without its pairs
  std::size_t nb_unresolved_ = 0;
  std::uint64_t cycles_ = 0, overruns_ = 0, out_of_time_ = 0;
  std::uint64_t told_cycles_ = 0, told_overruns_ = 0;  // at the last diagnosis
  std::vector<std::string> refused_, warnings_, open_meshes_;
  std::string changed_;
  unsigned nb_clock_jumps_ = 0;
};

}  // namespace collision_pairs
