// What the broad phase has to find, by looking at every pair.
#pragma once

#include <cstdint>
#include <vector>

#include "collision_pairs/sweep_and_prune.h"
#include "column_sweep.h"

namespace collision_pairs {

/// One cycle's input. Box i belongs to models[i]; the first `nb_static` boxes stand still.
struct BroadPhaseScene {
  std::vector<Aabb> boxes;
  std::vector<std::uint32_t> models;
  std::size_t nb_static = 0;
  double alarm_distance = 0.0;
  const PairFilter* filter = nullptr;

  void add(const Aabb& box) {
    models.push_back(static_cast<std::uint32_t>(boxes.size()));
    boxes.push_back(box);
  }
};

inline std::vector<BoxPair> pairsByBruteForce(const BroadPhaseScene& scene) {
  std::vector<BoxPair> pairs;
  for (std::uint32_t i = 0; i < scene.boxes.size(); ++i) {
    for (std::uint32_t j = i + 1; j < scene.boxes.size(); ++j) {
      if (j < scene.nb_static || scene.models[i] == scene.models[j]) continue;
      if (!scene.boxes[i].valid() || !scene.boxes[j].valid()) continue;
      if (scene.filter && !scene.filter->allowed(scene.models[i], scene.models[j])) continue;
      const double gap = squaredGap(scene.boxes[i], scene.boxes[j]);
      if (gap <= squaredReach(scene.alarm_distance)) pairs.push_back({i, j});
    }
  }
  return pairs;
}

/// One cycle; the static boxes must be valid. `is_told`: the sweep gets the allowed pairs, too, of
/// the scene's filter, which must not be null.
inline std::vector<BoxPair> pairsBySweep(const BroadPhaseScene& scene, SweepAndPrune* sweep,
                                         bool is_told = false) {
  const auto nb_static = static_cast<std::ptrdiff_t>(scene.nb_static);
  const StaticBoxes fixed({scene.boxes.begin(), scene.boxes.begin() + nb_static},
                          {scene.models.begin(), scene.models.begin() + nb_static});
  AllowedBoxPairs allowed;
  if (is_told) {
    allowed =
        AllowedBoxPairs({scene.models.begin() + nb_static, scene.models.end()}, *scene.filter);
  }
  sweep->begin(scene.alarm_distance, &fixed, scene.filter, is_told ? &allowed : nullptr);
  for (std::size_t i = scene.nb_static; i < scene.boxes.size(); ++i) {
    sweep->add(scene.boxes[i], scene.models[i]);
  }
  return sweep->end();
}

/// Tunings that take every path through the sweep even with few boxes.
inline std::vector<SweepTuning> allPaths() {
  SweepTuning usual;
  SweepTuning packed;
  packed.direct_up_to = 0;
  SweepTuning one_sweep = packed;
  one_sweep.packed_up_to = 0;
  SweepTuning columns = one_sweep;
  columns.column_size = 8;
  columns.tests_per_box = 2;
  return {usual, packed, one_sweep, columns};
}

}  // namespace collision_pairs
