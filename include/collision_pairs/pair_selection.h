// The pairs of a scene that a check is limited to.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "collision_pairs/collision_scene.h"
#include "collision_pairs/pair_filter.h"
#include "collision_pairs/scene_settings.h"

namespace collision_pairs {

/// Limits checks of a scene (CheckSettings::selection) to some of its pairs, in place of a scene of
/// its own for these. What is in no selected pair gets no box and needs no pose. Verdicts, pairs
/// and distances are those of a scene with the same Restriction, except that boxes (AABB, OBB) stay
/// enlarged by the pair_padding of pairs that are not selected, so their distances may be smaller.
/// A check with an empty selection is not FREE, unless SceneSettings::allow_empty_scene permits it.
///
/// Immutable: one serves all threads. Cost: 20 ns per model and 5 ns per pair of classes of the
/// scene's filter, once.
class PairSelection {
 public:
  enum class Among {
    ALL,
    SELF,  ///< pairs of which both move: links of robots, and objects attached to them
    WORLD  ///< pairs of which one is static: world, static objects, clouds
  };

  /// Throws InputError as CollisionScene::build() does for a restriction, and for a name that is
  /// neither a link of a robot nor a model of the scene.
  PairSelection(std::shared_ptr<const CollisionScene> scene, const Restriction& restriction,
                Among among = Among::ALL);

  const CollisionScene& scene() const { return *scene_; }
  /// The selected pairs, by model of the scene.
  const PairFilter& filter() const { return filter_; }
  /// Whether the model is in a selected pair.
  bool uses(std::uint32_t model) const { return uses_class_[filter_.classOf(model)]; }
  bool empty() const { return is_empty_; }

 private:
  std::shared_ptr<const CollisionScene> scene_;
  PairFilter filter_;
  std::vector<char> uses_class_;
  bool is_empty_ = true;
};

}  // namespace collision_pairs
