// The pairs of models that a search could not certify.
#pragma once

#include <cstdint>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "motion_pairs.h"

namespace collision_pairs {

/// The second element of a pair, for all static ones.
constexpr std::uint32_t ALL_STATIC = 0xffffffff;

class UncertifiedPairs {
 public:
  using Models = std::set<std::pair<std::uint32_t, std::uint32_t>>;  ///< first < second

  /// Both must outlive this.
  UncertifiedPairs(const CollisionScene& scene, const MotionPairs& pairs)
      : scene_(scene), pairs_(pairs) {
    clear();
  }

  void clear();
  /// Of elements. `one_will_do`: of all static ones only the first is noted: they may be many.
  void note(const BoxPair& pair, bool one_will_do);
  const Models& models() const { return models_; }
  std::vector<std::string> names() const;

 private:
  const CollisionScene& scene_;
  const MotionPairs& pairs_;
  Models models_;
  std::vector<char> beside_static_noted_;  // by element: noted with all static elements
};

}  // namespace collision_pairs
