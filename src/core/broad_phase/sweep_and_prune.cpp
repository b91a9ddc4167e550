#include "collision_pairs/sweep_and_prune.h"

#include <algorithm>
#include <cstring>
#include <limits>
#include <stdexcept>
#include <string>

#include "collision_pairs/input_error.h"
#include "column_sweep.h"
#include "static_tree.h"

namespace collision_pairs {
namespace {

constexpr double MAX_ALARM = 1e150;

}  // namespace

// What a cycle needs besides its boxes: scratch memory only, no state is kept between cycles.
struct SweepAndPrune::Engine {
  explicit Engine(const SweepTuning& chosen) : tuning(chosen) {}

  void testDirectly(const std::vector<Aabb>& boxes, const std::uint64_t* allowed,
                    std::vector<BoxPair>* pairs) const;
  void meetStatic(const std::vector<Aabb>& boxes, std::vector<BoxPair>* pairs);
  void sweepAllowed(const std::vector<Aabb>& boxes, const std::vector<std::uint64_t>& allowed,
                    std::vector<BoxPair>* pairs);
  void sweepPacked(const std::vector<Aabb>& boxes, std::vector<BoxPair>* pairs);
  void sweepColumns(const std::vector<Aabb>& boxes, const std::vector<std::uint32_t>& refused,
                    std::vector<BoxPair>* pairs);
  void narrow(const std::vector<Aabb>& boxes, const NarrowMap& map);
  void pack(const std::vector<Aabb>& boxes, const NarrowMap& map);

  SweepTuning tuning;
  bool always_sweeps = false;
  const SweepKernel* kernel = sweepKernels().front();
  double alarm_distance = 0.0;
  const StaticBoxes* fixed = nullptr;
  const AllowedBoxPairs* moving = nullptr;
  PairTest test;
  // Without an alarm distance, strict overlap in float is proof; with one the Euclidean gap
  // decides, and each candidate is tested in double.
  std::uint32_t unsure = 0;

  std::vector<Record> records;
  PackedStorage packed;
  CandidateStorage candidates;
  std::vector<std::uint32_t> row_end;
  ColumnSweep sweeper{kernel};
  PairSorter sorter;
};

const char* broadPhaseName(BroadPhase broad_phase) {
  return broad_phase == BroadPhase::SWEEP ? "sweep" : "auto";
}

BroadPhase parseBroadPhase(const std::string& name) {
  for (const BroadPhase known : {BroadPhase::AUTO, BroadPhase::SWEEP}) {
    if (name == broadPhaseName(known)) return known;
  }
  throw InputError("unknown broad phase '" + name + "'; known are auto and sweep");
}

AllowedBoxPairs::AllowedBoxPairs(const std::vector<std::uint32_t>& models, const PairFilter& filter)
    : nb_boxes_(models.size()) {
  const std::size_t words = (nb_boxes_ + 63) / 64;
  bits_.assign(nb_boxes_ * words, 0);
  for (std::size_t i = 0; i < nb_boxes_; ++i) {
    for (std::size_t j = i + 1; j < nb_boxes_; ++j) {
      const std::uint64_t allowed = filter.allowed(models[i], models[j]);
      bits_[i * words + j / 64] |= allowed << j % 64;
    }
  }
}

SweepAndPrune::SweepAndPrune() : SweepAndPrune(SweepTuning()) {}
SweepAndPrune::SweepAndPrune(const SweepTuning& tuning)
    : engine_(std::make_unique<Engine>(tuning)) {}
SweepAndPrune::~SweepAndPrune() = default;
SweepAndPrune::SweepAndPrune(SweepAndPrune&&) noexcept = default;
SweepAndPrune& SweepAndPrune::operator=(SweepAndPrune&&) noexcept = default;

void SweepAndPrune::setBroadPhase(BroadPhase broad_phase) {
  engine_->always_sweeps = broad_phase == BroadPhase::SWEEP;
}

void SweepAndPrune::begin(double alarm_distance, const StaticBoxes* static_boxes,
                          const PairFilter* filter, const AllowedBoxPairs* moving) {
  if (!(alarm_distance >= 0.0 && alarm_distance <= MAX_ALARM)) {
    throw std::invalid_argument("alarm distance " + std::to_string(alarm_distance) +
                                " m: it must be 0 or more, and at most 1e150");
  }
  nb_static_ = static_boxes ? static_boxes->size() : 0;
  boxes_.clear();
  models_.clear();
  pairs_.clear();
  refused_.clear();
  engine_->alarm_distance = alarm_distance;
  engine_->fixed = static_boxes;
  engine_->moving = moving;
  engine_->test.filter = filter;
}

void SweepAndPrune::refuse(std::uint32_t id) {
  // Infinitely far from every other box, and not NaN.
  boxes_.back().min.setConstant(std::numeric_limits<double>::infinity());
  boxes_.back().max.setConstant(-std::numeric_limits<double>::infinity());
  refused_.push_back(id);
}

const std::vector<BoxPair>& SweepAndPrune::end() {
  if (nb_static_ + boxes_.size() > ID_MASK) throw std::length_error("2^29 boxes or more");
  Engine& engine = *engine_;
  engine.test.boxes = boxes_.data();
  engine.test.models = models_.data();
  engine.test.nb_static = static_cast<std::uint32_t>(nb_static_);
  engine.test.squared_reach = squaredReach(engine.alarm_distance);
  engine.unsure = engine.alarm_distance > 0.0 ? UNSURE : 0;
  pairs_.clear();
  const std::size_t nb_tests = boxes_.size() * (boxes_.size() / 2 + nb_static_);
  if (engine.moving && engine.moving->nbBoxes() != boxes_.size()) {
    throw std::invalid_argument("allowed pairs of " + std::to_string(engine.moving->nbBoxes()) +
                                " moving boxes, but " + std::to_string(boxes_.size()) + " boxes");
  }
  if (nb_tests <= engine.tuning.direct_up_to && !engine.always_sweeps) {
    const bool in_one_word = engine.moving && boxes_.size() <= 64;
    engine.testDirectly(boxes_, in_one_word ? engine.moving->bits_.data() : nullptr, &pairs_);
    return pairs_;
  }

  // Static ids come first, so these pairs, once sorted, precede all others.
  if (nb_static_ > 0) engine.meetStatic(boxes_, &pairs_);
  const bool few = !engine.always_sweeps &&
                   boxes_.size() <= engine.tuning.packed_up_to.value_or(engine.kernel->each_up_to);
  const std::size_t nb_ids = nb_static_ + boxes_.size();
  if (few) {
    if (nb_static_ > 0) engine.sorter.sort(*engine.kernel, nb_ids, &pairs_);
    if (engine.moving) {
      engine.sweepAllowed(boxes_, engine.moving->bits_, &pairs_);
    } else {
      engine.sweepPacked(boxes_, &pairs_);
    }
  } else {
    engine.sweepColumns(boxes_, refused_, &pairs_);
    engine.sorter.sort(*engine.kernel, nb_ids, &pairs_);
  }
  return pairs_;
}

// Very few boxes: any preparation would take longer. The pairs are found in sorted order.
void SweepAndPrune::Engine::testDirectly(const std::vector<Aabb>& boxes,
                                         const std::uint64_t* allowed,
                                         std::vector<BoxPair>* pairs) const {
  const auto count = static_cast<std::uint32_t>(boxes.size());
  const auto meet = [&](const Aabb& box, std::uint32_t model, std::uint32_t id, std::uint32_t j) {
    if (!(squaredGap(box, boxes[j]) <= test.squared_reach)) return;
    if (model == test.models[j] || !test.allowed(model, test.models[j])) return;
    pairs->push_back({id, test.nb_static + j});
  };
  for (std::uint32_t i = 0; i < test.nb_static; ++i) {
    for (std::uint32_t j = 0; j < count; ++j) {
      meet(fixed->tree_->box(i), fixed->tree_->model(i), i, j);
    }
  }
  for (std::uint32_t i = 0; i < count; ++i) {
    if (allowed) {
      for (std::uint64_t bits = allowed[i]; bits != 0; bits &= bits - 1) {
        const auto j = static_cast<std::uint32_t>(__builtin_ctzll(bits));
        if (squaredGap(boxes[i], boxes[j]) <= test.squared_reach) {
          pairs->push_back({test.nb_static + i, test.nb_static + j});
        }
      }
      continue;
    }
    for (std::uint32_t j = i + 1; j < count; ++j) {
      meet(boxes[i], test.models[i], test.nb_static + i, j);
    }
  }
}

// The boxes as packed records.
void SweepAndPrune::Engine::pack(const std::vector<Aabb>& boxes, const NarrowMap& map) {
  narrow(boxes, map);
  packed.resize(boxes.size());
  const PackedStorage::Writer write = packed.writer();
  for (std::size_t i = 0; i < boxes.size(); ++i) write(i, records[i]);
}

void SweepAndPrune::Engine::narrow(const std::vector<Aabb>& boxes, const NarrowMap& map) {
  if (records.size() < boxes.size()) records.resize(boxes.size() + boxes.size() / 4);
  narrowBoxes(*kernel, map, boxes, test.models, records.data());
}

// Each moving box against the tree of static ones, enlarged by the whole reach.
void SweepAndPrune::Engine::meetStatic(const std::vector<Aabb>& boxes,
                                       std::vector<BoxPair>* pairs) {
  pack(boxes, makeNarrowMap(fixed->tree_->origin(), axisReach(alarm_distance)));
  Candidates* found = candidates.clear();
  kernel->query(fixed->tree_->view(), packed.view(), static_cast<std::uint32_t>(boxes.size()),
                unsure, found);
  appendStaticPairs(*found, test, *fixed->tree_, pairs);
}

// Few boxes: each against all that follow. Rows in order of ids give sorted pairs.
void SweepAndPrune::Engine::sweepPacked(const std::vector<Aabb>& boxes,
                                        std::vector<BoxPair>* pairs) {
  const auto count = static_cast<std::uint32_t>(boxes.size());
  pack(boxes, makeNarrowMap(sceneOrigin(boxes), 0.5 * axisReach(alarm_distance)));
  row_end.assign(count, count);
  Candidates* found = candidates.clear();
  kernel->sweep(packed.view(), row_end.data(), count, unsure, found);
  appendMovingPairs(*found, test, pairs);
}

// The same, of pairs known to be allowed. Those that overlap are so few that each is tested in
// double.
void SweepAndPrune::Engine::sweepAllowed(const std::vector<Aabb>& boxes,
                                         const std::vector<std::uint64_t>& bits,
                                         std::vector<BoxPair>* pairs) {
  if (boxes.empty()) return;
  const auto count = static_cast<std::uint32_t>(boxes.size());
  const NarrowMap map = makeNarrowMap(sceneOrigin(boxes), 0.5 * axisReach(alarm_distance));
  packed.pack(*kernel, map, boxes);
  Candidates* found = candidates.clear();
  kernel->sweepAllowed(packed.view(), bits.data(), static_cast<std::uint32_t>(bits.size()) / count,
                       count, found);
  for (std::size_t k = 0; k < found->count; ++k) {
    const std::uint32_t a = found->first[k], b = found->second[k];
    const bool near = squaredGap(boxes[a], boxes[b]) <= test.squared_reach;
    if (near) pairs->push_back({test.nb_static + a, test.nb_static + b});
  }
}

// Many boxes: sorted, and in columns where the sweep would be long.
void SweepAndPrune::Engine::sweepColumns(const std::vector<Aabb>& boxes,
                                         const std::vector<std::uint32_t>& refused,
                                         std::vector<BoxPair>* pairs) {
  std::size_t count = boxes.size();
  if (count == 0) return;
  narrow(boxes, makeNarrowMap(sceneOrigin(boxes), 0.5 * axisReach(alarm_distance)));
  if (!refused.empty()) {  // left in one place, thousands of them would all overlap each other
    const auto is_refused = [&](const Record& record) {
      return std::binary_search(refused.begin(), refused.end(), test.nb_static + record.tag);
    };
    const auto end = records.begin() + static_cast<std::ptrdiff_t>(count);
    count = static_cast<std::size_t>(std::remove_if(records.begin(), end, is_refused) -
                                     records.begin());
    if (count == 0) return;
  }
  sweeper.begin(tuning, test, unsure);
  sweeper.sweep(records.data(), count);
  if (pairs->empty()) {
    pairs->swap(sweeper.pairs());
  } else {
    pairs->insert(pairs->end(), sweeper.pairs().begin(), sweeper.pairs().end());
  }
}

}  // namespace collision_pairs
