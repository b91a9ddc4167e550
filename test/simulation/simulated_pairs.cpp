// The claims about pairs, speeds and the scene's message in reports of a SimulatedNode.
#include <algorithm>
#include <cmath>

#include "simulated_node.h"

namespace simulation {

/// Contacts are contacts, distances are distances, and none that is near is missing.
void SimulatedNode::judgePairs(const Snapshot& snapshot) {
  const CollisionScene& scene = *snapshot.scene->scene;
  const Poses at = posesAt(static_cast<Ns>(snapshot.stamp.toNSec()));
  const auto solidOf = [&](const std::string& name, Solid& solid, Pose& X_WS) {
    if (name.front() == 'l') {
      const int link = std::stoi(name.substr(1));
      solid = ballOf(link);
      X_WS = at[static_cast<std::size_t>(link)].value_or(Pose());
      return at[static_cast<std::size_t>(link)].has_value();
    }
    const auto found = objects_.find(name);
    if (found == objects_.end() || !isPlaced(found->second, at)) return false;
    solid = found->second.solid;
    X_WS = poseOf(found->second, at);
    return true;
  };
  const auto paddingOf = [&](const std::string& name) {
    return name.front() == 'l' ? settings_.padding : 0.0;
  };
  std::set<std::pair<std::string, std::string>> reported;
  double smallest = ALARM_DISTANCE;
  bool is_all = settings_.broken < 0;  // pairs are judged, of balls
  for (const PairReport& pair : report_.pairs) {
    const std::string &a = scene.models()[pair.first].name, &b = scene.models()[pair.second].name;
    reported.insert(std::minmax(a, b));
    Solid of_a, of_b;
    Pose X_WA, X_WB;
    if (!solidOf(a, of_a, X_WA) || !solidOf(b, of_b, X_WB)) {
      is_all = false;
      continue;
    }
    const double expected = distance(of_a, X_WA, of_b, X_WB) - paddingOf(a) - paddingOf(b);
    const bool is_contact = pair.state == PairState::CONTACT;
    if (is_contact != (expected <= 0.0) && std::abs(expected) > ROUNDING) {
      fail(a + " and " + b + ": " + (is_contact ? "no contact" : "a contact"));
    }
    const bool is_depth = expected < 0.0 && (of_a.is_box || of_b.is_box);  // not judged
    is_all = is_all && !is_depth;
    if (!is_depth && std::abs(pair.distance - expected) > 1e-5)
      fail(a + " and " + b + ": distance");
    if (!is_depth && pair.certainty != Certainty::EXACT) fail(a + " and " + b + ": certainty");
    smallest = std::min(smallest, expected);
    if (settings_.broken < 0) judgeContacts(pair, a, b, expected);
  }
  const bool is_smallest = is_all && report_.left_out.empty() && !reported.empty();
  if (is_smallest && std::abs(report_.min_distance - smallest) > 1e-5) {
    fail("the smallest distance is another");
  }
  if (is_smallest && report_.min_distance_is_bound) fail("the smallest distance is called a bound");
  const bool has_nearest = !report_.pairs.empty() && !report_.min_distance_is_bound;
  if (has_nearest != report_.nearest.has_value() ||
      (has_nearest && report_.nearest->depth != -report_.min_distance)) {
    fail("the nearest is another");
  }
  for (int i = 0; i < static_cast<int>(setup_.links.size()); ++i) {
    if (!at[i] || !report_.left_out.empty()) continue;
    for (int j = 0; j < i; ++j) {
      if (!at[j] || !areChecked(i, j)) continue;
      const double gap = distance(ballOf(i), *at[i], ballOf(j), *at[j]) - 2.0 * settings_.padding;
      const bool is_near = gap < ALARM_DISTANCE - 1e-5;
      if (is_near && reported.count(std::minmax(linkName(i), linkName(j))) == 0) {
        fail(linkName(i) + " and " + linkName(j) + " are near, and not reported");
      }
    }
  }
}

/// Of links, each of one ball or two: one contact for each two balls that are near.
void SimulatedNode::judgeContacts(const PairReport& pair, const std::string& a,
                                  const std::string& b, double gap) {
  std::vector<double> shrinks_a = {0.0}, shrinks_b = {0.0};
  for (const auto& [name, shrinks] : {std::pair(&a, &shrinks_a), {&b, &shrinks_b}}) {
    if (name->front() != 'l') continue;
    const SimulatedLink& link = setup_.links[static_cast<std::size_t>(std::stoi(name->substr(1)))];
    if (link.is_double) shrinks->push_back(0.5 * link.radius);
  }
  std::size_t least = 0, most = 0;
  for (const double of_a : shrinks_a) {
    for (const double of_b : shrinks_b) {
      least += gap + of_a + of_b < ALARM_DISTANCE - 1e-5 ? 1 : 0;
      most += gap + of_a + of_b < ALARM_DISTANCE + 1e-5 ? 1 : 0;
    }
  }
  const bool is_ball = a.front() == 'l' && b.front() == 'l';  // boxes: gaps do not simply add
  if (is_ball && (pair.nb_contacts < least || pair.nb_contacts > most)) {
    fail(a + " and " + b + ": number of contacts");
  }
}

/// What is attached to a member is one.
bool SimulatedNode::isOneOf(const std::set<std::string>& members, const std::string& a,
                            const std::string& b) const {
  const auto isMember = [&](const std::string& name) {
    const auto object = objects_.find(name);
    const bool is_on = object != objects_.end() && object->second.link >= 0 &&
                       members.count(linkName(object->second.link)) > 0;
    return members.count(name) > 0 || is_on;
  };
  return members.empty() || isMember(a) || isMember(b);
}

/// Whether the rules may leave a pair with one of these members, or any.
bool SimulatedNode::isAnyChecked(const std::set<std::string>& members) const {
  const bool has_surroundings = setup_.has_cloud || setup_.has_world;
  for (int i = 0; i < static_cast<int>(setup_.links.size()); ++i) {
    const std::string link = linkName(i);
    if (settings_.ignored.count(i) > 0) continue;
    if (has_surroundings && isOneOf(members, link, link)) return true;
    for (int j = 0; j < i; ++j) {
      if (mayBeChecked(i, j) && isOneOf(members, link, linkName(j))) return true;
    }
    for (const auto& [name, object] : objects_) {
      if (object.link != i && object.touches.count(i) == 0 && isOneOf(members, link, name))
        return true;
    }
  }
  for (const auto& [name, object] : objects_) {
    const bool has_other = has_surroundings || objects_.size() > 1;
    if (object.link >= 0 && has_other) return true;
  }
  return false;
}

/// What speeds are computed from.
void SimulatedNode::judgeBefore(const Snapshot& snapshot) {
  if (report_.pairs.empty()) return;
  const EarlierPoses before = monitor_.before(snapshot, report_);
  const Ns then = static_cast<Ns>(snapshot.stamp.toNSec()) - static_cast<Ns>(1e8);
  if (snapshot.is_static) return;
  const auto& bodies = snapshot.scene->scene->bodies();
  std::set<int> wanted;
  for (const PairReport& pair : report_.pairs) {
    for (const auto model : {pair.first, pair.second}) {
      wanted.insert(snapshot.scene->scene->models()[model].body);
    }
  }
  if (before.window != 0.1) fail("speeds are of another span");
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const int link = bodies[i].link == "root" ? -1 : std::stoi(bodies[i].link.substr(1));
    const bool must_be = wanted.count(static_cast<int>(i)) > 0 && knowledge_.isCertain(link, then);
    if (must_be && !before.poses.known[i]) fail(linkName(link) + " has no speed");
    if (!before.poses.known[i]) continue;
    if (wanted.count(static_cast<int>(i)) == 0) fail(linkName(link) + " is in no pair");
    if (knowledge_.isLiedAbout(link, then)) continue;
    if (!isBody(link, before.poses.X_WB[i], then)) fail(linkName(link) + " was elsewhere before");
  }
}

/// Of the scene as its message says.
void SimulatedNode::judgeSame(const Snapshot& snapshot) {
  if (!read_again_) return;
  const auto store = std::move(read_again_);
  if (!store->active()) return fail("the scene's message cannot be read");
  CollisionDetector original(snapshot.scene->scene), detector(store->active()->scene);
  CheckSettings settings;
  settings.alarm_distance = ALARM_DISTANCE;
  const CollisionReport& expected = original.detect(snapshot.poses, settings);
  const CollisionReport& same = detector.detect(snapshot.poses, settings);
  if (store->active()->scene->models().size() != snapshot.scene->scene->models().size()) {
    fail("the scene's message says a scene of others");
  }
  if (same.verdict != expected.verdict || same.unknown_because != expected.unknown_because ||
      same.min_distance != expected.min_distance || same.pairs.size() != expected.pairs.size()) {
    fail("the scene's message says another scene");
  }
  const StampedPoses stamped = store->active()->tf_poses->latest(monitor_.transforms().now().stamp);
  if (stamped.poses.known != snapshot.poses.known) fail("the scene's message has other poses");
}

bool SimulatedNode::areChecked(int i, int j) const {
  return mayBeChecked(i, j) && bodyOf(i) != bodyOf(j) && !areAdjacent(i, j);
}

bool SimulatedNode::mayBeChecked(int i, int j) const {
  const auto parentOf = [&](int link) {
    return setup_.links[static_cast<std::size_t>(link)].parent;
  };
  return parentOf(i) != j && parentOf(j) != i &&
         settings_.ignored.count(i) + settings_.ignored.count(j) == 0;
}

bool SimulatedNode::areAdjacent(int a, int b) const {
  const auto parentBody = [&](int link) {
    const int parent = setup_.links[static_cast<std::size_t>(bodyOf(link))].parent;
    return parent < 0 ? -1 : bodyOf(parent);
  };
  return parentBody(a) == bodyOf(b) || parentBody(b) == bodyOf(a);
}

}  // namespace simulation
