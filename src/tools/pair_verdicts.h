// Decisions of generate_srdf for each pair of links, and their output.
#pragma once

#include <optional>
#include <ostream>
#include <string>
#include <vector>

#include "collision_pairs/collision_scene.h"
#include "generated_srdf.h"
#include "joint_sampler.h"
#include "pair_class.h"
#include "pair_statistics.h"

namespace collision_pairs {

/// What the given SRDF says of a pair.
enum class Given { NOTHING, SWITCHED_OFF, SWITCHED_ON };

struct PairVerdict {
  std::string first_link;  ///< first < second
  std::string second_link;
  PairEvidence evidence;
  PairClass pair_class;
  Given given = Given::NOTHING;
  std::string reason;  ///< of the line that is added for it; empty: none
};

/// One for each piece of evidence. Only pairs that `given` says nothing of get a line: adjacent,
/// always and never ones, and with `disable_default` those that touch at zero too.
std::vector<PairVerdict> decide(const std::vector<PairEvidence>& evidence,
                                const CollisionScene& scene, const std::optional<Srdf>& given,
                                const ClassRules& rules, bool disable_default);

/// The lines to add, and a comment for each pair that stays checked although random states showed
/// it always or never in contact.
std::vector<SrdfLine> srdfLines(const std::vector<PairVerdict>& verdicts, const ClassRules& rules);

/// Warns of what a person should look at, a line for each kind.
void warnOf(const std::vector<PairVerdict>& verdicts, const ClassRules& rules);

/// "55 pairs: 10 Adjacent, …, 23 stay checked, …"
std::string summaryOf(const std::vector<PairVerdict>& verdicts);

/// CSV, a row a pair; docs/generate_srdf.md says what the columns are. `contact_state` is a state
/// in which the two touch, as "joint=position;…" of the joints that move them against each other,
/// to the last digit.
void writePairTable(const std::vector<PairVerdict>& verdicts, const CollisionScene& scene,
                    const JointSampler& sampler, const ClassRules& rules, std::ostream& out);

}  // namespace collision_pairs
