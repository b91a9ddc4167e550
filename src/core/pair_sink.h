// The last step of the sweep: from candidates to the pairs that are reported.
#pragma once

#include <cstdint>
#include <vector>

#include "collision_pairs/sweep_and_prune.h"
#include "sweep_kernel.h"
#include "sweep_record.h"

namespace collision_pairs {

/// What a cycle's candidates are judged by.
struct PairRules {
  const Aabb* boxes = nullptr;
  const std::uint32_t* models = nullptr;
  const PairFilter* filter = nullptr;  // null: everything is allowed
  double squared_reach = 0.0;
  std::uint32_t nb_static = 0;  // ids of moving boxes go on from here

  bool allowed(std::uint32_t model_a, std::uint32_t model_b) const {
    return filter == nullptr || filter->allowed(model_a, model_b);
  }
};

/// Appends the allowed pairs that are close enough. Candidates are two moving boxes.
inline void appendMovingPairs(const Candidates& candidates, const PairRules& rules,
                              std::vector<BoxPair>* pairs) {
  for (std::size_t k = 0; k < candidates.count; ++k) {
    const std::uint32_t a = candidates.first[k];
    const std::uint32_t b = candidates.second[k] & ID_MASK;
    if (!rules.allowed(rules.models[a], rules.models[b])) continue;
    if ((candidates.second[k] & UNSURE) &&
        !(squaredGap(rules.boxes[a], rules.boxes[b]) <= rules.squared_reach)) {
      continue;
    }
    pairs->push_back({rules.nb_static + std::min(a, b), rules.nb_static + std::max(a, b)});
  }
}

/// The same where the first is a moving box and the second a static one.
inline void appendStaticPairs(const Candidates& candidates, const PairRules& rules,
                              const StaticBoxes& fixed, std::vector<BoxPair>* pairs) {
  for (std::size_t k = 0; k < candidates.count; ++k) {
    const std::uint32_t a = candidates.first[k];
    const std::uint32_t b = candidates.second[k] & ID_MASK;
    if (rules.filter && !rules.filter->allowed(rules.models[a], fixed.model(b))) continue;
    if ((candidates.second[k] & UNSURE) &&
        !(squaredGap(rules.boxes[a], fixed.box(b)) <= rules.squared_reach)) {
      continue;
    }
    pairs->push_back({b, rules.nb_static + a});
  }
}

}  // namespace collision_pairs
