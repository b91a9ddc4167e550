#include "pair_verdicts.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <set>

#include "command_line.h"
#include "csv.h"
#include "pair_class.h"
#include "user_text.h"

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

/// Three digits, rounded up: for an upper bound.
std::string roundedUp(double bound) {
  const double digit = std::pow(10.0, std::floor(std::log10(bound)) - 2.0);
  return formatted("%.3g", digit * std::ceil(bound / digit * (1.0 - 1e-12)));
}

std::string millimetres(double metres) { return formatted("%.1f mm", 1e3 * metres); }

std::string nameOf(const PairVerdict& v) { return v.first_link + '|' + v.second_link; }

std::string countOf(const PairEvidence& e) {
  return std::to_string(e.contacts) + " of " + std::to_string(e.trials);
}

std::string notMovedText(const PairEvidence& e) {
  return "in contact in " + countOf(e) +
         " states, but joints between the two were not moved in all of their range: " +
         firstOf({e.not_moved.begin(), e.not_moved.end()});
}

std::string evidenceText(const PairEvidence& e, const ClassRules& rules) {
  if (e.rigid) return std::string("on one rigid body: ") + (e.contacts ? "in contact" : "apart");
  if (!e.not_moved.empty()) return notMovedText(e);
  const std::string text = "in contact in " + countOf(e) + " states; probability ";
  if (e.contacts > 0 && e.contacts == e.trials) {
    const double apart = upperContactProbability(0, e.trials, rules.confidence);
    return text + "of being apart below " + roundedUp(apart);
  }
  const std::string bound = "below " + roundedUp(upperBound(e, rules.confidence));
  if (e.contacts > 0 || e.adjacent) return text + bound;
  return text + bound + "; nearest found " + millimetres(e.nearest);
}

/// Why a pair stays enabled although it was never, or always, in contact in random states; empty
/// for all others.
std::string whyChecked(const PairVerdict& v, const ClassRules& rules) {
  const PairEvidence& e = v.evidence;
  const std::string seen = "in contact in " + countOf(e) + " states, ";
  if (v.pair_class == PairClass::UNPROVEN) {
    if (!e.not_moved.empty()) return notMovedText(e);
    return seen + "which are too few; " +
           std::to_string(trialsNeeded(rules.max_probability, rules.confidence)) + " are needed";
  }
  if (v.pair_class == PairClass::NEAR) {
    return seen + "but came as close as " + millimetres(e.nearest);
  }
  if (e.contacts == e.trials) return seen + "but apart with all joints at zero";
  if (e.contacts > 0) return "";
  return seen + (e.touches_at_zero ? "but in contact with all joints at zero"
                                   : "but a search found a contact");
}

/// One warning that names the pairs concerned, if there are any: those most often in contact.
void warnOfPairs(const std::vector<PairVerdict>& verdicts, const std::string& what,
                 const std::function<bool(const PairVerdict&)>& concerned) {
  std::vector<const PairVerdict*> pairs;
  for (const PairVerdict& v : verdicts) {
    if (concerned(v)) pairs.push_back(&v);
  }
  if (pairs.empty()) return;
  std::stable_sort(pairs.begin(), pairs.end(), [](const PairVerdict* a, const PairVerdict* b) {
    return a->evidence.contacts > b->evidence.contacts;
  });
  std::vector<std::string> names;
  for (const PairVerdict* pair : pairs) {
    names.push_back(nameOf(*pair) + " (" + countOf(pair->evidence) + ')');
  }
  warn(std::to_string(pairs.size()) + (pairs.size() == 1 ? " pair " : " pairs ") + what + ": " +
       firstOf(names));
}

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
  const auto bodyOf = [&](auto model) { return scene.robotBody(scene.models()[model]); };
  std::vector<std::string> words;
  for (const int joint : sampler.jointsBetween(bodyOf(e.first), bodyOf(e.second))) {
    words.push_back(listedName(sampler.robot().joints()[joint].name) + '=' +
                    allDigits(positions[joint]));
  }
  return joined(words, ";");
}

}  // namespace

std::vector<PairVerdict> decide(const std::vector<PairEvidence>& evidence,
                                const CollisionScene& scene, const std::optional<Srdf>& given,
                                const ClassRules& rules, bool disable_default) {
  const std::vector<std::string> links = namesOf(scene.models());
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

std::vector<SrdfLine> srdfLines(const std::vector<PairVerdict>& verdicts, const ClassRules& rules) {
  std::vector<SrdfLine> lines;
  for (const PairVerdict& v : verdicts) {
    if (!v.reason.empty()) {
      lines.push_back({evidenceText(v.evidence, rules), v.first_link, v.second_link, v.reason});
      continue;
    }
    const std::string why = v.given == Given::NOTHING ? whyChecked(v, rules) : "";
    if (!why.empty()) lines.push_back({"checked: " + nameOf(v) + ": " + why, "", "", ""});
  }
  return lines;
}

void warnOf(const std::vector<PairVerdict>& verdicts, const ClassRules& rules) {
  const auto isOpen = [](const PairVerdict& v) {
    return v.given == Given::NOTHING && v.reason.empty();
  };
  const auto isUnproven = [&](const PairVerdict& v, bool all_moved) {
    return isOpen(v) && v.pair_class == PairClass::UNPROVEN &&
           v.evidence.not_moved.empty() == all_moved;
  };
  warnOfPairs(
      verdicts,
      "stay checked because there are too few states to conclude never or always; --samples " +
          std::to_string(trialsNeeded(rules.max_probability, rules.confidence)) +
          " are needed for --max-probability " + roundedUp(rules.max_probability),
      [&](const PairVerdict& v) { return isUnproven(v, true); });
  std::set<std::string> not_moved;
  for (const PairVerdict& v : verdicts) {
    const std::set<std::string>& joints = v.evidence.not_moved;
    if (isUnproven(v, false)) not_moved.insert(joints.begin(), joints.end());
  }
  warnOfPairs(verdicts,
              "stay checked because joints between the two were not moved in all of their range (" +
                  firstOf({not_moved.begin(), not_moved.end()}) + ")",
              [&](const PairVerdict& v) { return isUnproven(v, false); });
  warnOfPairs(verdicts,
              "stay checked although they touch with all joints at zero, because in other states "
              "they do not (--disable-default disables them)",
              [&](const PairVerdict& v) {
                return isOpen(v) && v.pair_class == PairClass::SOMETIMES &&
                       v.evidence.touches_at_zero;
              });
  warnOfPairs(verdicts,
              "are disabled because their links are adjacent, but are in contact in some states "
              "(<enable_collisions> in a given SRDF keeps a check)",
              [](const PairVerdict& v) {
                return v.pair_class == PairClass::ADJACENT && !v.reason.empty() &&
                       v.evidence.contacts > 0 && v.evidence.contacts < v.evidence.trials;
              });
  warnOfPairs(verdicts,
              "that the given SRDF disables are in contact in some states; they stay disabled",
              [](const PairVerdict& v) {
                return v.given == Given::SWITCHED_OFF && v.pair_class == PairClass::SOMETIMES;
              });
}

std::string summaryOf(const std::vector<PairVerdict>& verdicts) {
  std::map<std::string, std::size_t> added;
  std::size_t given_off = 0, checked = 0, found_by_search = 0;
  for (const PairVerdict& v : verdicts) {
    if (!v.reason.empty()) {
      ++added[v.reason];
    } else if (v.given == Given::SWITCHED_OFF) {
      ++given_off;
    } else {
      ++checked;
      found_by_search += !v.evidence.found_state.empty();
    }
  }
  std::string text = std::to_string(verdicts.size()) + " pairs:";
  for (const auto& [reason, count] : added) {
    text += ' ' + std::to_string(count) + ' ' + reason + ',';
  }
  if (given_off > 0) text += ' ' + std::to_string(given_off) + " disabled as given,";
  return text + ' ' + std::to_string(checked) + " stay checked, of which " +
         std::to_string(found_by_search) + " were found in contact by search only";
}

void writePairTable(const std::vector<PairVerdict>& verdicts, const CollisionScene& scene,
                    const JointSampler& sampler, const ClassRules& rules, std::ostream& out) {
  out << "link1,link2,class,given,switched_off,trials,contacts,probability_above,"
         "probability_below,nearest,touches_at_zero,found_by_search,contact_state\n";
  for (const PairVerdict& v : verdicts) {
    const PairEvidence& e = v.evidence;
    const bool off = v.given == Given::SWITCHED_OFF || !v.reason.empty();
    out << csvField(listedName(v.first_link)) << ',' << csvField(listedName(v.second_link)) << ','
        << className(v.pair_class) << ',' << givenName(v.given) << ',' << off << ',' << e.trials
        << ',' << e.contacts << ',' << formatted("%.4g", lowerBound(e, rules.confidence)) << ','
        << formatted("%.4g", upperBound(e, rules.confidence)) << ','
        << (std::isfinite(e.nearest) ? formatted("%.4g", e.nearest) : "") << ','
        << e.touches_at_zero << ',' << !e.found_state.empty() << ','
        << csvField(contactState(e, scene, sampler)) << '\n';
  }
}

}  // namespace collision_pairs
