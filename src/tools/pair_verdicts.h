// What generate_srdf decides for each pair of links.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "collision_pairs/collision_scene.h"
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

}  // namespace collision_pairs
