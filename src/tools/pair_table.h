// The table of all pairs that generate_srdf writes.
#pragma once

#include <ostream>
#include <vector>

#include "joint_sampler.h"
#include "pair_verdicts.h"

namespace collision_pairs {

/// CSV, a row a pair; docs/generate_srdf.md says what the columns are. `contact_state` is a state
/// in which the two touch, as "joint=position;…" of the joints that move them against each other,
/// to the last digit.
void writePairTable(const std::vector<PairVerdict>& verdicts, const CollisionScene& scene,
                    const JointSampler& sampler, const ClassRules& rules, std::ostream& out);

}  // namespace collision_pairs
