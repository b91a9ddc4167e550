#include "pair_verdicts.h"

#include <set>

namespace collision_pairs {
namespace {

std::string reasonFor(const PairVerdict& v, bool disable_default) {
  if (v.given != Given::NOTHING) return "";
  switch (v.pair_class) {
    case PairClass::ADJACENT:
    case PairClass::ALWAYS:
    case PairClass::NEVER:
      return className(v.pair_class);
    default:
      return disable_default && v.evidence.touches_at_zero ? "Default" : "";
  }
}

}  // namespace

std::vector<PairVerdict> decide(const std::vector<PairEvidence>& evidence,
                                const CollisionScene& scene, const std::optional<Srdf>& given,
                                const ClassRules& rules, bool disable_default) {
  std::vector<std::string> links;
  for (const CollisionModel& model : scene.models()) links.push_back(model.name);
  std::set<Srdf::LinkPair> off, on;
  if (given) {
    off = given->switchedOff(links);
    on = {given->enabled_pairs.begin(), given->enabled_pairs.end()};
  }
  std::vector<PairVerdict> verdicts;
  for (const PairEvidence& e : evidence) {
    PairVerdict v{links[e.first], links[e.second], e, classify(e, rules), Given::NOTHING, {}};
    const Srdf::LinkPair pair(v.first_link, v.second_link);
    if (on.count(pair)) v.given = Given::SWITCHED_ON;
    if (off.count(pair)) v.given = Given::SWITCHED_OFF;
    v.reason = reasonFor(v, disable_default);
    verdicts.push_back(std::move(v));
  }
  return verdicts;
}

}  // namespace collision_pairs
