// How generate_srdf tells what it decided.
#pragma once

#include <string>
#include <vector>

#include "generated_srdf.h"
#include "pair_verdicts.h"

namespace collision_pairs {

/// The lines to add, and a comment for each pair that stays checked although random states showed
/// it always or never in contact.
std::vector<SrdfLine> srdfLines(const std::vector<PairVerdict>& verdicts, const ClassRules& rules);

/// Warns of what a person should look at, a line for each kind.
void warnOf(const std::vector<PairVerdict>& verdicts, const ClassRules& rules);

/// "55 pairs: 10 Adjacent, …, 23 stay checked, …"
std::string summaryOf(const std::vector<PairVerdict>& verdicts);

}  // namespace collision_pairs
