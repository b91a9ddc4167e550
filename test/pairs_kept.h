// Reports of some of a scene's pairs beside one of all.
#pragma once

#include <cstdint>
#include <utility>

#include <gtest/gtest.h>

#include "collision_pairs/collision_detector.h"

namespace collision_pairs {

using ModelPair = std::pair<std::uint32_t, std::uint32_t>;

inline CheckSettings alarm(double distance) {
  CheckSettings settings;
  settings.alarm_distance = distance;
  return settings;
}

/// Whether `kept` is the whole report without some pairs, to the last bit.
template <class IsKept>
void expectPairsWhere(const IsKept& is_kept, const CollisionReport& whole,
                      const CollisionReport& kept) {
  std::size_t next = 0;
  Verdict verdict = whole.left_out.empty() ? Verdict::FREE : Verdict::UNKNOWN;
  for (const PairReport& pair : whole.pairs) {
    if (!is_kept(pair.first, pair.second)) continue;
    ASSERT_LT(next, kept.pairs.size());
    const PairReport& found = kept.pairs[next++];
    EXPECT_EQ(ModelPair(found.first, found.second), ModelPair(pair.first, pair.second));
    EXPECT_EQ(found.distance, pair.distance);
    EXPECT_EQ(found.state, pair.state);
    EXPECT_EQ(found.nb_contacts, pair.nb_contacts);
    if (pair.mayTouch() && verdict != Verdict::COLLISION) verdict = Verdict::UNKNOWN;
    if (pair.state == PairState::CONTACT) verdict = Verdict::COLLISION;
  }
  EXPECT_EQ(next, kept.pairs.size());
  EXPECT_EQ(kept.verdict, kept.unchecked.empty() ? verdict : Verdict::UNKNOWN);
}

}  // namespace collision_pairs
