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

/// The state of a pair in the given SRDF.
enum class Given { NOTHING, SWITCHED_OFF, SWITCHED_ON };

struct PairVerdict {
  std::string first_link;  ///< first < second
  std::string second_link;
  PairEvidence evidence;
  PairClass pair_class;
  Given given = Given::NOTHING;
  std::string reason;  ///< of the line added for it; empty if none
};

/// One per entry of the evidence. Only pairs not in `given` get a line: adjacent, always and never
/// ones, and with `disable_default` also those that touch at zero.
std::vector<PairVerdict> decide(const std::vector<PairEvidence>& evidence,
                                const CollisionScene& scene, const std::optional<Srdf>& given,
                                const ClassRules& rules, bool disable_default);

/// The lines to add, and a comment for each pair that stays enabled although it was always or never
/// in contact in random states.
std::vector<SrdfLine> srdfLines(const std::vector<PairVerdict>& verdicts, const ClassRules& rules);

/// Warnings that need human review, one line per kind.
void warnOf(const std::vector<PairVerdict>& verdicts, const ClassRules& rules);

/// "55 pairs: 10 Adjacent, …, 23 stay checked, …"
std::string summaryOf(const std::vector<PairVerdict>& verdicts);

/// CSV, one row per pair; docs/scenes.md describes the columns. `contact_state` is a state
/// in which the two touch, as "joint=position;…" of the joints that change their relative pose,
/// with all digits.
void writePairTable(const std::vector<PairVerdict>& verdicts, const CollisionScene& scene,
                    const JointSampler& sampler, const ClassRules& rules, std::ostream& out);

}  // namespace collision_pairs
