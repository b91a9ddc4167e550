// What a check's predicate answered.
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "collision_pairs/collision_detector.h"

namespace collision_pairs {

/// Asks CheckSettings::may_ignore at most once per pair of models and check. Only memory is kept
/// between checks.
class IgnoredPairs {
 public:
  using Pair = std::pair<std::uint32_t, std::uint32_t>;

  /// `may_ignore` must outlive the check; it may be empty.
  void begin(const MayIgnore& may_ignore) {
    may_ignore_ = may_ignore ? &may_ignore : nullptr;
    ++check_;
    nb_answers_ = 0;
  }
  bool isAsking() const { return may_ignore_ != nullptr; }

  /// Whether the two models, in either order, are left out.
  bool has(std::uint32_t model_a, std::uint32_t model_b);

  /// Those left out so far, sorted.
  void list(std::vector<Pair>& pairs) const;

 private:
  struct Answer {
    Pair pair;
    std::uint64_t check = 0;  ///< for which it was given; an entry of another check is free
    bool is_ignored = false;
  };
  Answer& find(const Pair& pair);
  void grow();

  const MayIgnore* may_ignore_ = nullptr;
  std::uint64_t check_ = 0;
  std::size_t nb_answers_ = 0;
  std::vector<Answer> answers_;  // a hash table, open addressing; its size is a power of two
};

/// Whether the filter allows a pair that is not in the sorted list. Ends at the first.
bool allowsMoreThan(const std::vector<IgnoredPairs::Pair>& ignored, const CollisionScene& scene,
                    const PairFilter& filter);

}  // namespace collision_pairs
