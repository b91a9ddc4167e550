// What a check's predicate answered.
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "collision_pairs/collision_detector.h"

namespace collision_pairs {

/// Asks CheckSettings::may_ignore at most once per pair of models and check, or ignore_revision.
class IgnoredPairs {
 public:
  using Pair = std::pair<std::uint32_t, std::uint32_t>;

  /// `may_ignore` must outlive the check; it may be empty. Answers are kept if the revision is not 0
  /// and that of the check before.
  void begin(const MayIgnore& may_ignore, std::uint64_t revision);
  bool isAsking() const { return may_ignore_ != nullptr; }

  /// Whether the two models, in either order, are left out.
  bool has(std::uint32_t model_a, std::uint32_t model_b);

  /// Those left out of this check so far, sorted.
  const std::vector<Pair>& list();

 private:
  struct Answer {
    Pair pair;
    std::uint64_t asked_in = 0;  ///< an entry of another than asking_ is free
    std::uint64_t met_in = 0;    ///< the last check that asked
    bool is_ignored = false;
  };
  Answer& find(const Pair& pair);
  void grow();

  const MayIgnore* may_ignore_ = nullptr;
  std::uint64_t check_ = 0, asking_ = 0, revision_ = 0;
  std::size_t nb_answers_ = 0;
  std::vector<Pair> left_out_;
  std::vector<Answer> answers_;  // a hash table, open addressing; its size is a power of two
};

/// Whether the filter allows a pair that is not in the sorted list. Ends at the first.
bool allowsMoreThan(const std::vector<IgnoredPairs::Pair>& ignored, const CollisionScene& scene,
                    const PairFilter& filter);

}  // namespace collision_pairs
