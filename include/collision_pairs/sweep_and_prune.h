// Direct sweep and prune: finds the pairs of boxes that are close to each other.
#pragma once

#include <cstdint>
#include <limits>
#include <memory>
#include <string>
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

/// Defines "no further apart than the alarm distance" numerically: a pair of boxes is a candidate
/// if and only if, computed in double,
///   squaredGap(a, b) <= squaredReach(alarm_distance), in square metres.
/// The right-hand side is alarm^2 enlarged by 8 units in the last place and by 4 of the smallest
/// doubles. The error of squaredGap() is smaller, so no pair whose gap is <= alarm in exact
/// arithmetic is lost, and none is found that is further apart than
/// alarm (1 + 2e-15) + 1e-161 metres.
inline double squaredReach(double alarm_distance) {
  constexpr double ROUNDING = 1.0 + 8.0 * std::numeric_limits<double>::epsilon();
  constexpr double UNDERFLOW_BOUND = 4.0 * std::numeric_limits<double>::denorm_min();
  return alarm_distance * alarm_distance * ROUNDING + UNDERFLOW_BOUND;
}

/// How the pairs of moving boxes are found. Both find the same pairs.
enum class BroadPhase {
  AUTO,  ///< few boxes each against each, many by direct sweep and prune: what is faster
  SWEEP  ///< direct sweep and prune for any number of boxes
};

const char* broadPhaseName(BroadPhase broad_phase);
/// Throws InputError that lists the known names.
BroadPhase parseBroadPhase(const std::string& name);

class StaticTree;

/// Static boxes, prepared once when the scene changes and then shared by any number
/// of sweeps and threads. Their ids are 0, 1, … in the given order. Copies share their memory.
///
/// They are packed into a tree of nodes of 16 boxes (the packing of a k-d tree, as in bulk-loaded
/// R-trees), so that the cost of a cycle depends on what its moving boxes touch and not on the
/// number of static boxes. The tree is independent of the alarm distance. Cost: O(n log n) to
/// build, 100 bytes per box.
class StaticBoxes {
 public:
  StaticBoxes() = default;
  /// `models[i]` is the collision model of box i. Throws std::invalid_argument that names the
  /// first box that is not finite or inverted, or the two sizes if they differ.
  StaticBoxes(std::vector<Aabb> boxes, std::vector<std::uint32_t> models);

  /// The same, from others that are alike: `new_ids[i]` is the id here of box i of `before`, or
  /// GONE. Their order in the tree is kept, and new boxes come last, until they are a sixteenth.
  /// Cost: O(n) in most cases, 10 ns per box.
  StaticBoxes(std::vector<Aabb> boxes, std::vector<std::uint32_t> models, const StaticBoxes& before,
              const std::vector<std::uint32_t>& new_ids);
  static constexpr std::uint32_t GONE = 0xffffffff;

  std::size_t size() const { return nb_boxes_; }
  const Aabb& box(std::uint32_t id) const;
  std::uint32_t model(std::uint32_t id) const;
  /// The box of all boxes; inverted if there are none.
  const Aabb& bounds() const { return bounds_; }

 private:
  friend class SweepAndPrune;
  /// `order`: of the ids, or empty.
  void build(std::vector<Aabb> boxes, std::vector<std::uint32_t> models,
             const std::vector<std::uint32_t>& order);
  std::size_t nb_boxes_ = 0;
  std::size_t nb_changed_ = 0;  ///< since the tree was ordered
  Aabb bounds_ = noBox();
  std::shared_ptr<const StaticTree> tree_;
};

/// A bit for each pair of moving boxes that the filter allows, made once for boxes that come in the
/// same order in each cycle. Cost: 2 ns a pair; n^2 / 8 bytes.
class AllowedBoxPairs {
 public:
  AllowedBoxPairs() = default;
  /// `models`: of the moving boxes, in the order of SweepAndPrune::add().
  AllowedBoxPairs(const std::vector<std::uint32_t>& models, const PairFilter& filter);
  std::size_t nbBoxes() const { return nb_boxes_; }

 private:
  friend class SweepAndPrune;
  std::size_t nb_boxes_ = 0;
  std::vector<std::uint64_t> bits_;  // of the later boxes, a row for each box
};

struct SweepTuning;

/// Finds all pairs of boxes whose Euclidean gap is at most the alarm distance (closed: a gap of
/// exactly the alarm distance counts, so touching boxes are found at 0; see squaredReach()).
///
/// Only memory is kept between cycles: the pairs depend on this cycle's boxes alone, and the same
/// boxes in another order give the same pairs. Pairs of boxes of one model,
/// pairs that the filter forbids, and pairs of static boxes are not reported.
///
///   sweep.begin(alarm_distance, &static_boxes, &filter);
///   for (…) sweep.add(box, model);
///   for (const BoxPair& pair : sweep.end()) …
///
/// Method: D. Baraff, "Dynamic Simulation of Non-Penetrating Rigid Bodies" (1992): sort the boxes
/// along one axis and sweep. F. Liu, T. Harada, Y. Lee, Y. J. Kim, "Real-time collision culling
/// of a million bodies on graphics processing units" (2010): the axis of greatest variance, and
/// subdivision of the other axes, since a sweep along one axis alone grows like n^(5/3).
/// Deviations: nothing is kept and sorted again by insertion; the order is a counting sort into
/// bins, not exact within a bin, since the SIMD test compares all six sides anyway; the widths of
/// the columns come from a sample; a column that is still crowded is split again; a pair that
/// shares several columns is reported from the first of them. With BroadPhase::AUTO few boxes are
/// tested each against each. Static boxes wait in a tree, which each moving box is compared with.
///
/// Exactness: boxes are converted to float relative to an origin in their midst. One monotone map
/// converts both ends of every interval, so the order of ends is kept and no pair is lost. A pair
/// that is not clearly separated in float is decided with the original boxes in double.
///
/// Cost: O(n + pairs) for boxes of similar size, in any distribution; O(n^2 / 16) for up to 160
/// (with AVX2 / 8; O(n^2 / 4) for up to 110 with neither AVX2 nor AVX-512); moving against static
/// O(log n_static + pairs) per box. No heap allocation once warm. Memory: about 200 bytes per box
/// and 16 per pair.
///
/// Not thread safe: use one per thread. Movable, not copyable.
class SweepAndPrune {
 public:
  SweepAndPrune();
  /// For tests and benchmarks; the default tuning is the best known.
  explicit SweepAndPrune(const SweepTuning& tuning);
  void setBroadPhase(BroadPhase broad_phase);
  ~SweepAndPrune();
  SweepAndPrune(SweepAndPrune&&) noexcept;
  SweepAndPrune& operator=(SweepAndPrune&&) noexcept;

  /// Starts a cycle. alarm_distance in metres, 0 to 1e150, otherwise throws std::invalid_argument.
  /// The pointers are borrowed until end() and may be null (no static boxes; every pair of two
  /// models is allowed). `moving`: what the filter says of the boxes that will be added; up to 160
  /// boxes then take two thirds of the time.
  void begin(double alarm_distance, const StaticBoxes* static_boxes = nullptr,
             const PairFilter* filter = nullptr, const AllowedBoxPairs* moving = nullptr);

  /// Adds a moving box and returns its id; ids continue after those of the static boxes. A box that
  /// is not finite or is inverted is in no pair, and is listed in refused(). Models must be known
  /// to the filter, if there is one.
  std::uint32_t add(const Aabb& box, std::uint32_t model) {
    const auto id = static_cast<std::uint32_t>(nb_static_ + boxes_.size());
    boxes_.push_back(box);
    models_.push_back(model);
    if (!isSound(box)) refuse(id);
    return id;
  }

  /// Ends the cycle and returns all pairs, each once, sorted; valid until the next begin(). Throws
  /// std::length_error for 2^29 or more moving boxes, and std::invalid_argument if `moving` was
  /// made for another number of boxes.
  const std::vector<BoxPair>& end();

  /// Ids of this cycle's boxes that were not finite or inverted, ascending.
  const std::vector<std::uint32_t>& refused() const { return refused_; }

 private:
  struct Engine;

  static bool isSound(const Aabb& box) {
    constexpr double LARGEST = std::numeric_limits<double>::max();
    const Eigen::Vector3d size = box.max - box.min;
    const double sum = size[0] + size[1] + size[2];
    const int is_ordered = int(size[0] >= 0.0) & int(size[1] >= 0.0) & int(size[2] >= 0.0);
    if ((is_ordered & int(sum <= LARGEST)) != 0) return true;  // nearly always; without branches
    int sound = 1;
    for (int k = 0; k < 3; ++k) {
      sound &= box.min[k] >= -LARGEST;
      sound &= box.min[k] <= box.max[k];
      sound &= box.max[k] <= LARGEST;
    }
    return sound != 0;
  }
  void refuse(std::uint32_t id);

  std::size_t nb_static_ = 0;
  std::vector<Aabb> boxes_;  // moving boxes only; refused ones are inverted and infinite
  std::vector<std::uint32_t> models_;
  std::vector<BoxPair> pairs_;
  std::vector<std::uint32_t> refused_;
  std::unique_ptr<Engine> engine_;
};

}  // namespace collision_pairs
