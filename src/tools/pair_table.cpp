#include "pair_table.h"

#include <cmath>
#include <cstdio>

namespace collision_pairs {
namespace {

const char* givenName(Given given) {
  switch (given) {
    case Given::NOTHING:
      return "";
    case Given::SWITCHED_OFF:
      return "off";
    case Given::SWITCHED_ON:
      return "on";
  }
  return "";
}

std::string printed(const char* format, double value) {
  char text[32];
  std::snprintf(text, sizeof text, format, value);
  return text;
}

std::string contactState(const PairEvidence& e, const CollisionScene& scene,
                         const JointSampler& sampler) {
  std::vector<double> positions = e.found_state;
  if (e.contacts > 0) {
    sampler.draw(e.nearest_state, positions);
  } else if (e.touches_at_zero) {
    positions = sampler.robot().zeroPositions();
  } else if (positions.empty()) {
    return "";
  }
  const auto bodyOf = [&](std::uint32_t model) {
    return scene.bodies()[scene.models()[model].body].body;
  };
  std::string text;
  for (const int joint : sampler.jointsBetween(bodyOf(e.first), bodyOf(e.second))) {
    if (!text.empty()) text += ';';
    text += sampler.robot().joints()[joint].name + '=' + printed("%.17g", positions[joint]);
  }
  return text;
}

}  // namespace

void writePairTable(const std::vector<PairVerdict>& verdicts, const CollisionScene& scene,
                    const JointSampler& sampler, const ClassRules& rules, std::ostream& out) {
  out << "link1,link2,class,given,switched_off,trials,contacts,probability_above,"
         "probability_below,nearest,touches_at_zero,found_by_search,contact_state\n";
  for (const PairVerdict& v : verdicts) {
    const PairEvidence& e = v.evidence;
    const bool off = v.given == Given::SWITCHED_OFF || !v.reason.empty();
    out << v.first_link << ',' << v.second_link << ',' << className(v.pair_class) << ','
        << givenName(v.given) << ',' << off << ',' << e.trials << ',' << e.contacts << ','
        << printed("%.4g", lowerBound(e, rules.confidence)) << ','
        << printed("%.4g", upperBound(e, rules.confidence)) << ','
        << (std::isfinite(e.nearest) ? printed("%.4g", e.nearest) : "") << ',' << e.touches_at_zero
        << ',' << !e.found_state.empty() << ',' << contactState(e, scene, sampler) << '\n';
  }
}

}  // namespace collision_pairs
