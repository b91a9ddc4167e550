#include "conversions.h"

#include <algorithm>
#include <cmath>

#include "geometry_conversions.h"
#include "user_text.h"

namespace collision_pairs {
namespace {

std::uint8_t toState(PairState state) {
  if (state == PairState::NEAR) return CollisionPair::NEAR;
  return state == PairState::CONTACT ? CollisionPair::CONTACT : CollisionPair::UNRESOLVED;
}

std::uint8_t toCertainty(Certainty certainty) {
  if (certainty == Certainty::EXACT) return CollisionPair::EXACT;
  return certainty == Certainty::BOUND ? CollisionPair::DEPTH_BOUND : CollisionPair::LOWER_BOUND;
}

ContactPoint toMessage(const Contact& contact, const CollisionScene& scene) {
  ContactPoint message;
  message.first_point = toPoint(contact.p_WFirst);
  message.second_point = toPoint(contact.p_WSecond);
  message.normal = toVector3(contact.nhat_W);
  message.depth = contact.depth;
  message.first_element = scene.indexInModel(contact.elements.first);
  message.second_element = scene.indexInModel(contact.elements.second);
  return message;
}

CollisionPair toMessage(const PairReport& pair, const CollisionReport& report,
                        const CollisionScene& scene) {
  CollisionPair message;
  message.first_link = scene.models()[pair.first].name;
  message.second_link = scene.models()[pair.second].name;
  message.state = toState(pair.state);
  message.distance = pair.distance;
  message.fidelity = fidelityName(pair.fidelity);
  message.certainty = toCertainty(pair.certainty);
  for (std::uint32_t i = 0; i < pair.nb_contacts; ++i) {
    message.contacts.push_back(toMessage(report.contacts[pair.first_contact + i], scene));
  }
  return message;
}

}  // namespace

CollisionPairs unknown(const std::string& reason, const std::string& frame,
                       const ros::Time& stamp) {
  CollisionPairs message;
  message.header.frame_id = frame;
  message.header.stamp = stamp;
  message.min_distance_is_bound = true;
  message.verdict = static_cast<std::uint8_t>(verdictOf(false, true));
  message.in_collision = true;
  message.unknown_because = {reason};
  return message;
}

CollisionPairs toMessage(const CollisionReport& report, const CollisionScene& scene,
                         const CheckSettings& settings, const std::string& frame,
                         const ros::Time& stamp, const ClosingReport* closing) {
  CollisionPairs message;
  message.header.frame_id = frame;
  message.header.stamp = stamp;
  message.verdict = static_cast<std::uint8_t>(report.verdict);
  message.in_collision = report.in_collision;
  message.unknown_because = report.unknown_because;
  message.unchecked = report.unchecked;
  message.nb_boxes = report.nb_boxes;
  message.nb_pairs = static_cast<std::uint32_t>(report.candidates.size());
  message.alarm_distance = settings.verdict_only ? 0.0 : settings.alarm_distance;
  message.verdict_only = settings.verdict_only;
  message.fidelity = fidelityName(settings.fidelity);
  message.min_distance = report.min_distance;
  message.min_distance_is_bound = report.min_distance_is_bound;
  // Without checked pairs the distance has no bound: infinity would claim that there are no pairs.
  const bool is_none =
      report.left_out.size() == scene.models().size() || std::isinf(report.min_distance);
  if (is_none && !report.left_out.empty()) message.min_distance = 0.0;
  for (const PairReport& pair : report.pairs) {
    message.pairs.push_back(toMessage(pair, report, scene));
  }
  if (closing != nullptr) {
    for (std::size_t i = 0; i < closing->pairs.size(); ++i) {
      message.pairs[i].closing_speed = closing->pairs[i].closing_speed;
      message.pairs[i].closing_speed_is_known = closing->pairs[i].known;
    }
    message.time_to_contact = closing->time_to_contact;
    message.time_to_contact_is_known = closing->time_to_contact_is_known;
  }
  for (const auto& entry : scene.missing()) message.left_out.push_back(entry.first);
  for (const std::uint32_t id : report.left_out) {
    message.left_out.push_back(scene.models()[id].name);
  }
  std::sort(message.left_out.begin(), message.left_out.end());
  message.left_out.erase(std::unique(message.left_out.begin(), message.left_out.end()),
                         message.left_out.end());
  message.nb_degraded = report.nb_degraded;
  message.narrow_phase = narrowPhaseName(report.narrow_phase);
  message.nb_answered_natively = report.nb_answered_natively;
  std::copy(report.nb_settled.begin(), report.nb_settled.end(), message.nb_settled.begin());
  message.nb_unresolved = report.nb_unresolved;
  message.budget_spent = report.budget_spent;
  message.tolerance = report.tolerance;
  message.time_budget = settings.time_budget;
  message.time_boxes = report.times.boxes;
  message.time_broad_phase = report.times.broad_phase;
  message.time_narrow_phase = report.times.narrow_phase;
  message.time_total = report.times.total;
  return message;
}

}  // namespace collision_pairs
