// What a check's predicate answered.
#pragma once

#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

#include "collision_pairs/collision_detector.h"

namespace collision_pairs {

/// Asks CheckSettings::may_ignore at most once per pair of models and check, or ignore_revision.
class IgnoredPairs {
 public:
  using Pair = std::pair<std::uint32_t, std::uint32_t>;

  /// `may_ignore` must outlive the check; it may be empty. Answers are kept if the revision is not
  /// 0 and that of the check before.
  void begin(const MayIgnore& may_ignore, std::uint64_t revision);
  bool isAsking() const { return may_ignore_ != nullptr; }

  /// Whether the two models, in either order, are left out.
  bool has(std::uint32_t model_a, std::uint32_t model_b);
  /// Whether has() has said no of any pair of this check.
  bool keepsSome() const { return keeps_some_; }

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
  bool keeps_some_ = false;
  std::vector<Pair> left_out_;
  std::vector<Answer> answers_;  // a hash table, open addressing; its size is a power of two
};

/// Whether the filter allows a pair of models of which is_kept(first, second) is true. Ends at the
/// first.
template <class IsKept>
bool hasPair(const CollisionScene& scene, const PairFilter& filter, const IsKept& is_kept) {
  const auto& models = scene.models();
  for (std::uint32_t a = 0; a < models.size(); ++a) {
    if (models[a].body < 0) continue;  // one of two moves
    for (std::uint32_t b = 0; b < models.size(); ++b) {
      if (filter.allowed(a, b) && is_kept(std::min(a, b), std::max(a, b))) return true;
    }
  }
  return false;
}

}  // namespace collision_pairs
