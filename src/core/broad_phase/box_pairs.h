// The last steps of the sweep: candidates tested on the true boxes, and the pairs sorted.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "collision_pairs/sweep_and_prune.h"
#include "static_tree.h"

namespace collision_pairs {

/// What the exact test of a cycle's candidates needs.
struct PairTest {
  const Aabb* boxes = nullptr;
  const std::uint32_t* models = nullptr;
  const PairFilter* filter = nullptr;  // null: everything is allowed
  double squared_reach = 0.0;
  std::uint32_t nb_static = 0;  // ids of moving boxes start here

  bool allowed(std::uint32_t model_a, std::uint32_t model_b) const {
    return filter == nullptr || filter->allowed(model_a, model_b);
  }
};

/// Appends the candidates whose boxes are close enough and whose models are allowed to meet.
/// `second` knows the boxes, models and ids behind the second ids. Each pair is written and then
/// kept or not, so that there is no branch that is hard to predict.
template <class Second>
void appendPairs(const Candidates& candidates, const PairTest& test, const Second& second,
                 std::vector<BoxPair>* pairs) {
  std::size_t kept = pairs->size();
  pairs->resize(kept + candidates.count);
  BoxPair* const out = pairs->data();
  for (std::size_t k = 0; k < candidates.count; ++k) {
    const std::uint32_t a = candidates.first[k];
    const std::uint32_t b = candidates.second[k] & ID_MASK;
    out[kept] = second.pair(a, b);
    bool keep = true;
    if (candidates.second[k] & UNSURE) {
      keep = squaredGap(test.boxes[a], second.box(b)) <= test.squared_reach;
    }
    if (test.filter) keep = keep && test.filter->allowed(test.models[a], second.model(b));
    kept += keep;
  }
  pairs->resize(kept);
}

/// Candidates of two moving boxes.
inline void appendMovingPairs(const Candidates& candidates, const PairTest& test,
                              std::vector<BoxPair>* pairs) {
  struct Moving {
    const PairTest& test;
    const Aabb& box(std::uint32_t id) const { return test.boxes[id]; }
    std::uint32_t model(std::uint32_t id) const { return test.models[id]; }
    BoxPair pair(std::uint32_t a, std::uint32_t b) const {
      const std::uint32_t swap = (a ^ b) & (0u - static_cast<std::uint32_t>(b < a));  // no branch
      return {test.nb_static + (a ^ swap), test.nb_static + (b ^ swap)};
    }
  };
  appendPairs(candidates, test, Moving{test}, pairs);
}

/// Candidates whose first is a moving box and whose second is a static one.
inline void appendStaticPairs(const Candidates& candidates, const PairTest& test,
                              const StaticTree& fixed, std::vector<BoxPair>* pairs) {
  struct Static {
    const PairTest& test;
    const StaticTree& fixed;
    const Aabb& box(std::uint32_t id) const { return fixed.box(id); }
    std::uint32_t model(std::uint32_t id) const { return fixed.model(id); }
    BoxPair pair(std::uint32_t a, std::uint32_t b) const { return {b, test.nb_static + a}; }
  };
  appendPairs(candidates, test, Static{test, fixed}, pairs);
}

/// Sorts pairs, without a branch that depends on them. Keeps its memory.
class PairSorter {
 public:
  /// All ids are below `nb_ids`; no pair occurs twice. O(pairs): rows of the pairs of each first
  /// id, each row then sorted by the kernel. Pairs that are few for so many ids: radix sort of both
  /// ids as one number, least significant digit first.
  void sort(const SweepKernel& kernel, std::size_t nb_ids, std::vector<BoxPair>* pairs);

 private:
  void fillRows(std::size_t nb_ids, std::vector<BoxPair>* pairs);
  void sortLongRows(std::vector<BoxPair>* pairs);

  std::vector<std::uint32_t> row_ends_, seconds_;
  std::uint32_t longest_row_ = 0;
  std::vector<BoxPair> scratch_;
};

}  // namespace collision_pairs
