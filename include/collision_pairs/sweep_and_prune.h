// Direct sweep and prune: boxes in, pairs of boxes that are close out.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "collision_pairs/aabb.h"
#include "collision_pairs/pair_filter.h"

namespace collision_pairs {

/// Two box ids, first < second.
struct BoxPair {
  std::uint32_t first;
  std::uint32_t second;
  friend bool operator==(const BoxPair& a, const BoxPair& b) {
    return a.first == b.first && a.second == b.second;
  }
  friend bool operator<(const BoxPair& a, const BoxPair& b) {
    return a.first != b.first ? a.first < b.first : a.second < b.second;
  }
};

/// Boxes that stand still, made ready once when the scene changes and then shared by any number
/// of sweeps and threads. Their ids are 0, 1, … in the order given.
class StaticBoxes {
 public:
  StaticBoxes() = default;
  /// `models[i]` is the collision model of box i. Throws std::invalid_argument that names the
  /// first box that is not finite or inverted.
  StaticBoxes(std::vector<Aabb> boxes, std::vector<std::uint32_t> models);

  std::size_t size() const { return boxes_.size(); }
  const Aabb& box(std::uint32_t id) const { return boxes_[id]; }
  std::uint32_t model(std::uint32_t id) const { return models_[id]; }

 private:
  std::vector<Aabb> boxes_;
  std::vector<std::uint32_t> models_;
};

/// Finds all pairs of boxes whose Euclidean gap is at most the alarm distance (closed: a gap of
/// exactly the alarm distance counts, so touching boxes are found at 0).
///
/// It keeps nothing but memory from one cycle to the next; the pairs depend on this cycle's boxes
/// alone. Left out are pairs of boxes of one model, pairs that the filter forbids, and pairs of
/// static boxes.
///
///   sweep.begin(alarm_distance, &static_boxes, &filter);
///   for (…) sweep.add(box, model);
///   for (const BoxPair& pair : sweep.end()) …
///
/// Not thread safe: one per thread.
class SweepAndPrune {
 public:
  /// Starts a cycle. alarm_distance >= 0, metres. Neither pointer is owned; both must live until
  /// end() and may be null (no static boxes; every pair of two models is allowed).
  void begin(double alarm_distance, const StaticBoxes* static_boxes = nullptr,
             const PairFilter* filter = nullptr);

  /// Adds a moving box and returns its id: ids go on where those of the static boxes end. A box
  /// that is not finite or inverted takes part in no pair and is listed in refused().
  std::uint32_t add(const Aabb& box, std::uint32_t model);

  /// Ends the cycle: all pairs, each once, sorted. Valid until the next begin().
  const std::vector<BoxPair>& end();

  /// Ids of this cycle's boxes that were not finite or inverted.
  const std::vector<std::uint32_t>& refused() const { return refused_; }

  /// The axis of the last sweep: 0, 1 or 2.
  int axis() const { return axis_; }

 private:
  double alarm_distance_ = 0.0;
  const StaticBoxes* static_boxes_ = nullptr;
  const PairFilter* filter_ = nullptr;
  int axis_ = 0;
  std::vector<Aabb> boxes_;
  std::vector<std::uint32_t> models_;
  std::vector<std::uint32_t> order_;
  std::vector<BoxPair> pairs_;
  std::vector<std::uint32_t> refused_;
};

}  // namespace collision_pairs
