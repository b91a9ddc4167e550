// The claims about a SimulatedNode's reports as messages: they say what was found, and no more.
#include <algorithm>
#include <cmath>

#include "conversions.h"
#include "simulated_node.h"

namespace simulation {
namespace {

int stateIn(const PairReport& pair) {
  switch (pair.state) {
    case PairState::NEAR:
      return CollisionPair::NEAR;
    case PairState::CONTACT:
      return CollisionPair::CONTACT;
    default:
      return CollisionPair::UNRESOLVED;
  }
}

int certaintyIn(const PairReport& pair) {
  switch (pair.certainty) {
    case Certainty::EXACT:
      return CollisionPair::EXACT;
    case Certainty::BOUND:
      return CollisionPair::DEPTH_BOUND;
    default:
      return CollisionPair::LOWER_BOUND;
  }
}

template <class Point>
bool isSame(const Point& message, const Eigen::Vector3d& p) {
  return message.x == p.x() && message.y == p.y() && message.z == p.z();
}

}  // namespace

void SimulatedNode::judgeMessage(const Snapshot& snapshot) {
  const CollisionScene& scene = *snapshot.scene->scene;
  CheckSettings settings;
  settings.verdict_only = digest_ % 3 == 0;
  settings.alarm_distance = digest_ % 5 == 0 ? 0.0 : ALARM_DISTANCE;
  settings.time_budget = digest_ % 7 == 0 ? 1e-9 : 60.0;
  const CollisionReport& report = detector_->detect(snapshot.poses, settings);
  const bool is_short = report.budget_spent && report.verdict == Verdict::UNKNOWN;
  if (report.verdict != report_.verdict && !is_short) fail("what is wanted changes the verdict");
  if (report.budget_spent && settings.time_budget > 1.0) fail("time was left");
  const bool is_open = std::any_of(report.pairs.begin(), report.pairs.end(), [](const auto& pair) {
    return pair.state == PairState::UNRESOLVED && pair.distance <= 0.0;
  });
  if (is_open && report.verdict == Verdict::FREE) fail("FREE although a pair is not resolved");
  const bool finds_near = !settings.verdict_only && settings.alarm_distance > 0.0;
  const ClosingReport closing =
      closingReport(scene, report, finds_near, snapshot.poses, monitor_.before(snapshot, report));
  const CollisionPairs message =
      toMessage(report, scene, settings, "frame", snapshot.stamp, &closing);
  const auto require = [&](bool holds, const char* what) {
    if (!holds) fail(std::string("a message has another ") + what);
  };
  const bool is_free = report.verdict == Verdict::FREE;
  require(message.header.frame_id == "frame" && message.header.stamp == snapshot.stamp, "header");
  require(static_cast<Verdict>(message.verdict) == report.verdict, "verdict");
  require(message.in_collision == !is_free && report.in_collision == !is_free, "in_collision");
  require(message.unknown_because == report.unknown_because, "reason");
  require(message.unchecked == report.unchecked, "unchecked");
  require(message.nb_boxes == report.nb_boxes && message.nb_pairs == report.candidates.size(),
          "number of boxes");
  require(message.verdict_only == settings.verdict_only &&
              message.time_budget == settings.time_budget &&
              message.alarm_distance == (settings.verdict_only ? 0.0 : settings.alarm_distance) &&
              message.tolerance == report.tolerance && message.fidelity == "mesh",
          "setting");
  require(message.nb_degraded == report.nb_degraded && message.narrow_phase == "native" &&
              message.nb_answered_natively == report.nb_answered_natively &&
              message.nb_unresolved == report.nb_unresolved &&
              static_cast<bool>(message.budget_spent) == report.budget_spent &&
              std::equal(message.nb_settled.begin(), message.nb_settled.end(),
                         report.nb_settled.begin(), report.nb_settled.end()),
          "count");
  require(message.time_boxes == report.times.boxes && message.time_total == report.times.total &&
              message.time_broad_phase == report.times.broad_phase &&
              message.time_narrow_phase == report.times.narrow_phase,
          "time");
  // Of what was not checked no distance is known.
  const bool is_all_left_out = report.left_out.size() == scene.models().size();
  const bool is_nothing_known =
      !report.left_out.empty() && (is_all_left_out || std::isinf(report.min_distance));
  require(message.min_distance == (is_nothing_known ? 0.0 : report.min_distance), "min_distance");
  require(message.min_distance_is_bound == report.min_distance_is_bound, "min_distance_is_bound");
  require(message.time_to_contact == closing.time_to_contact &&
              message.time_to_contact_is_known == closing.time_to_contact_is_known,
          "time_to_contact");
  if (!report.unchecked.empty() && report.candidates.empty()) {
    require(message.min_distance <= 0.0 && message.min_distance_is_bound, "distance of nothing");
  }
  std::set<std::string> left_out;
  for (const auto& entry : scene.missing()) left_out.insert(entry.first);
  for (const std::uint32_t model : report.left_out) left_out.insert(scene.models()[model].name);
  require(std::equal(message.left_out.begin(), message.left_out.end(), left_out.begin(),
                     left_out.end()),
          "left_out");
  require(message.pairs.size() == report.pairs.size(), "number of pairs");
  std::size_t nb_contacts = 0;
  for (const PairReport& pair : report.pairs) nb_contacts += pair.nb_contacts;
  require(report.contacts.size() == nb_contacts, "number of contacts of all pairs");
  for (std::size_t i = 0; i < report.pairs.size() && violation_.empty(); ++i) {
    const PairReport& pair = report.pairs[i];
    const CollisionPair& said = message.pairs[i];
    require(said.first_link == scene.models()[pair.first].name &&
                said.second_link == scene.models()[pair.second].name,
            "pair");
    require(said.state == stateIn(pair) && said.certainty == certaintyIn(pair) &&
                said.distance == pair.distance && said.fidelity == fidelityName(pair.fidelity),
            "state of a pair");
    require(said.closing_speed == closing.pairs[i].closing_speed &&
                static_cast<bool>(said.closing_speed_is_known) == closing.pairs[i].known,
            "closing speed");
    require(said.contacts.size() == (settings.verdict_only ? 0 : pair.nb_contacts) &&
                (settings.verdict_only || pair.nb_contacts > 0),
            "number of contacts");
    double deepest = -1e9;
    for (std::size_t k = 0; k < said.contacts.size() && violation_.empty(); ++k) {
      const Contact& contact = report.contacts[pair.first_contact + k];
      const ContactPoint& point = said.contacts[k];
      require(isSame(point.first_point, contact.p_WFirst) &&
                  isSame(point.second_point, contact.p_WSecond) &&
                  isSame(point.normal, contact.nhat_W) && point.depth == contact.depth,
              "contact");
      const auto elementOf = [&](std::uint32_t model, std::uint32_t element) {
        return element - scene.models()[model].first_element;
      };
      require(point.first_element == elementOf(pair.first, contact.elements.first) &&
                  point.second_element == elementOf(pair.second, contact.elements.second),
              "element");
      deepest = std::max(deepest, contact.depth);
    }
    if (!said.contacts.empty()) require(-deepest == pair.distance, "deepest contact");
  }
  const CollisionPairs without = toMessage(report, scene, settings, "frame", snapshot.stamp);
  require(!without.time_to_contact_is_known &&
              std::none_of(without.pairs.begin(), without.pairs.end(),
                           [](const CollisionPair& pair) { return pair.closing_speed_is_known; }),
          "closing speed without one");
  const CollisionPairs none = unknown("a reason", "frame", snapshot.stamp);
  require(none.header.frame_id == "frame" && none.header.stamp == snapshot.stamp &&
              none.verdict == CollisionPairs::UNKNOWN && none.in_collision &&
              none.unknown_because == std::vector<std::string>{"a reason"} &&
              none.min_distance_is_bound,
          "verdict without a report");
}

}  // namespace simulation
