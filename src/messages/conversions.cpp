#include "conversions.h"

#include <algorithm>

#include "geometry_conversions.h"

namespace collision_pairs {
namespace {

std::uint8_t toState(PairState state) {
  switch (state) {
    case PairState::NEAR:
      return CollisionPair::NEAR;
    case PairState::CONTACT:
      return CollisionPair::CONTACT;
    default:
      return CollisionPair::UNRESOLVED;
  }
}

std::uint8_t toCertainty(Certainty certainty) {
  switch (certainty) {
    case Certainty::EXACT:
      return CollisionPair::EXACT;
    case Certainty::BOUND:
      return CollisionPair::DEPTH_BOUND;
    default:
      return CollisionPair::LOWER_BOUND;
  }
}

ContactPoint toMessage(const Contact& contact, const CollisionScene& scene) {
  const auto index_in_link = [&](std::uint32_t element) {
    return element - scene.models()[scene.elements()[element].model].first_element;
  };
  ContactPoint message;
  message.first_point = toPoint(contact.p_WFirst);
  message.second_point = toPoint(contact.p_WSecond);
  message.normal = toVector3(contact.nhat_W);
  message.depth = contact.depth;
  message.first_element = index_in_link(contact.elements.first);
  message.second_element = index_in_link(contact.elements.second);
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

CollisionPairs toMessage(const CollisionReport& report, const CollisionScene& scene,
                         const CheckSettings& settings, const std::string& frame,
                         const ros::Time& stamp, const std::vector<std::string>& broken_links) {
  CollisionPairs message;
  message.header.frame_id = frame;
  message.header.stamp = stamp;
  message.in_collision = report.in_collision;
  message.nb_boxes = report.nb_boxes;
  message.nb_pairs = static_cast<std::uint32_t>(report.candidates.size());
  message.alarm_distance = settings.alarm_distance;
  message.fidelity = fidelityName(settings.fidelity);
  message.min_distance = report.min_distance;
  message.min_distance_is_bound = report.min_distance_is_bound;
  for (const PairReport& pair : report.pairs) {
    message.pairs.push_back(toMessage(pair, report, scene));
  }
  message.left_out = broken_links;
  for (const std::uint32_t model : report.left_out) {
    message.left_out.push_back(scene.models()[model].name);
  }
  std::sort(message.left_out.begin(), message.left_out.end());
  message.left_out.erase(std::unique(message.left_out.begin(), message.left_out.end()),
                         message.left_out.end());
  message.nb_degraded = report.nb_degraded;
  std::copy(report.nb_settled.begin(), report.nb_settled.end(), message.nb_settled.begin());
  message.nb_unresolved = report.nb_unresolved;
  message.budget_spent = report.budget_spent;
  message.time_budget = settings.time_budget;
  message.time_boxes = report.times.boxes;
  message.time_broad_phase = report.times.broad_phase;
  message.time_narrow_phase = report.times.narrow_phase;
  message.time_total = report.times.total;
  return message;
}

}  // namespace collision_pairs
