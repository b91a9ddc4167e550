// What the Python class CheckResult holds, and how reports of a batch come into it.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include <pybind11/numpy.h>

#include "bindings.h"
#include "collision_pairs/collision_report.h"
#include "collision_pairs/collision_scene.h"
#include "collision_pairs/distance_gradient.h"

namespace collision_pairs {

/// As in CollisionPair.msg.
enum class DistanceWorth : std::uint8_t { EXACT = 0, LOWER_BOUND = 1, DEPTH_BOUND = 2 };

/// An entry of the structured array `pairs`.
struct PairRow {
  std::int64_t row;                                         ///< of the state
  std::uint32_t first, second;                              ///< in `models`
  std::uint8_t state;                                       ///< PairState
  std::uint8_t certainty;                                   ///< DistanceWorth
  std::uint8_t fidelity;                                    ///< Fidelity
  double distance;                                          ///< m, signed
  std::array<double, 3> first_point, second_point, normal;  ///< NaN with verdict_only
  std::uint32_t first_element, second_element;              ///< index within its model
};

/// What has a state's smallest distance.
struct NearestRow {
  std::int64_t row;
  std::uint32_t first, second;
  double distance;
  std::array<double, 3> first_point, second_point, normal;
  std::uint32_t first_element, second_element;
};

/// A model without a usable pose in a state.
struct LeftOutRow {
  std::int64_t row;
  std::uint32_t model;
};

/// Filled in from several threads, then only read.
struct CheckResult {
  bool is_single = false;  ///< one state was given, without the first dimension
  std::vector<std::uint8_t> verdict, in_collision, min_distance_is_bound;  ///< one a state
  std::vector<double> min_distance;
  std::vector<PairRow> pairs;        ///< by state, then by model
  std::vector<NearestRow> nearest;   ///< by state
  std::vector<LeftOutRow> left_out;  ///< by state, then by model
  bool has_gradient = false;
  std::vector<double> gradient;  ///< nb_joints numbers a pair
  std::size_t nb_joints = 0;
  std::vector<std::string> joints_at_zero;
  std::string unchecked;  ///< CollisionReport::unchecked
  pybind11::array model_names;

  void resize(std::size_t nb_states);
  /// What is one number a state.
  void takeVerdict(std::size_t i, const CollisionReport& report);
};

/// Takes reports in any order, from several threads. Each keeps what varies in number to itself;
/// finish() puts it in the order of the states.
class ResultCollector {
 public:
  /// `result` has its size already. `joints`: null if no gradient is wanted. All must outlive it.
  ResultCollector(const CollisionScene& scene, const JointColumns* joints, CheckResult& result);

  /// Once for each state, from any thread. `X_WB`: as DistanceGradient wants them.
  void take(std::size_t i, const CollisionReport& report,
            const std::vector<Eigen::Isometry3d>& X_WB);
  void finish();

 private:
  struct Part {
    std::vector<PairRow> pairs;
    std::vector<double> gradient;
    std::vector<NearestRow> nearest;
    std::vector<LeftOutRow> left_out;
    std::optional<DistanceGradient> differentiate;
  };
  /// Where a state's rows are.
  struct Place {
    const Part* part = nullptr;
    std::uint32_t nb_pairs = 0, nb_nearest = 0;
    std::size_t first_pair = 0, nearest = 0;
  };

  Part& partOfThisThread();

  const CollisionScene& scene_;
  const JointColumns* joints_;
  CheckResult& result_;
  const std::uint64_t id_;  // no two collectors have the same
  std::vector<Place> places_;
  std::mutex mutex_;  // guards what follows
  std::vector<std::unique_ptr<Part>> parts_;
};

void bindCheckResult(pybind11::module& module);

}  // namespace collision_pairs

COLLISION_PAIRS_BIND(collision_pairs::CheckResult)
