#include "moveit_check.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <limits>

#include <ros/console.h>

namespace collision_pairs {
namespace {

using collision_detection::CollisionRequest;
using collision_detection::CollisionResult;
using collision_detection::DistanceRequest;
namespace DistanceRequestType = collision_detection::DistanceRequestTypes;
using collision_detection::DistanceResult;
using collision_detection::DistanceResultsData;
using MoveitContact = collision_detection::Contact;
namespace BodyTypes = collision_detection::BodyTypes;

constexpr double FARTHEST = 1e6;  // metres: nothing is measured beyond

collision_detection::BodyType typeOf(const MoveitBody* moving) {
  if (!moving) return BodyTypes::WORLD_OBJECT;
  return moving->is_attached ? BodyTypes::ROBOT_ATTACHED : BodyTypes::ROBOT_LINK;
}

/// Which pairs a check leaves out.
class Rules {
 public:
  Rules(const MoveitScene& scene, const MoveitLimits& limits)
      : scene_(scene), models_(scene.scene().models()), limits_(limits) {}

  AllowedContact ofPair(std::uint32_t first, std::uint32_t second) const {
    const CollisionModel &a = models_[first], &b = models_[second];
    if (!scene_.isAsked(a, b)) return AllowedContact::ALWAYS;
    const MoveitBody *body_a = scene_.movingOf(a), *body_b = scene_.movingOf(b);
    return allowedBy(limits_, body_a, scene_.nameOf(a), body_b, scene_.nameOf(b));
  }

  /// The check's pairs that may touch on a condition, sorted: they wait for their contacts.
  const std::vector<std::pair<std::uint32_t, std::uint32_t>>& conditional() const {
    return conditional_;
  }

  /// Whether the check left out what these rules leave out, where it matters: pairs that it found
  /// apart are not asked about. Otherwise it had answers of other rules.
  bool agreeWith(const CollisionReport& report, bool verdict_only) {
    conditional_.clear();
    for (const PairReport& pair : report.pairs) {
      if (ofPair(pair.first, pair.second) != AllowedContact::NEVER) return false;
    }
    if (verdict_only && report.verdict == Verdict::COLLISION) return true;
    for (const auto& pair : report.ignored) {
      const AllowedContact allowed = ofPair(pair.first, pair.second);
      if (allowed == AllowedContact::NEVER) return false;
      if (allowed == AllowedContact::CONDITIONAL) conditional_.push_back(pair);
    }
    return true;
  }

  collision_detection::DecideContactFn conditionOf(const PairReport& pair) const {
    collision_detection::DecideContactFn condition;
    limits_.matrix->getAllowedCollision(scene_.nameOf(models_[pair.first]),
                                        scene_.nameOf(models_[pair.second]), condition);
    return condition;
  }

 private:
  const MoveitScene& scene_;
  const std::vector<CollisionModel>& models_;
  const MoveitLimits& limits_;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> conditional_;
};

bool setPoses(const MoveitScene& scene, const moveit::core::RobotState& state, BodyPoses& poses) {
  poses.resize(scene.scene().bodies().size());
  const auto& links = state.getRobotModel()->getLinkModels();
  for (std::size_t i = 0; i < poses.X_WB.size(); ++i) {
    const MoveitBody& body = scene.moving(i);
    poses.X_WB[i] = state.getGlobalLinkTransform(links[static_cast<std::size_t>(body.link)]);
    if (body.is_attached)
      poses.X_WB[i] = poses.X_WB[i] * state.getAttachedBody(body.name)->getPose();
  }
  if (scene.octree()) scene.toOctree(poses);
  if (!state.dirtyLinkTransforms()) return true;
  warnRarely("the state's link transforms are not up to date: call RobotState::update()");
  return false;
}

CheckSettings settingsFor(const MoveitScene& scene, const MoveitLimits& limits) {
  CheckSettings settings;
  settings.alarm_distance = 0.0;
  if (!limits.active_links.empty()) settings.selection = scene.selectionOf(limits.active_links);
  return settings;
}

// The matrix has no number for what is in it, and a look-up takes longer than many a pair. So the
// detector keeps the answers, and those that decide are compared with the matrix afterwards.
const CollisionReport& detect(MoveitScene::Worker& worker, CheckSettings& settings, Rules& rules) {
  settings.may_ignore = [&rules](std::uint32_t a, std::uint32_t b) {
    return rules.ofPair(a, b) != AllowedContact::NEVER;
  };
  settings.ignore_revision = worker.revision;
  const CollisionReport& report = worker.detector.detect(worker.poses, settings);
  if (rules.agreeWith(report, settings.verdict_only)) return report;
  settings.ignore_revision = ++worker.revision;
  worker.detector.detect(worker.poses, settings);
  rules.agreeWith(report, settings.verdict_only);
  return report;
}

void warnOfUnknown(const MoveitScene& scene, const CollisionReport& report) {
  std::string text = "not certain, and so taken for a collision:";
  const auto& models = scene.scene().models();
  for (const std::uint32_t m : report.left_out) {
    text += " '" + scene.nameOf(models[m]) + "' has no finite pose or box;";
  }
  for (const PairReport& pair : report.pairs) {
    if (pair.state != PairState::UNRESOLVED || !pair.mayTouch()) continue;
    text += " '" + scene.nameOf(models[pair.first]) + "' and '" +
            scene.nameOf(models[pair.second]) + "';";
  }
  warnRarely(text + " " + report.unchecked);
}

Contact inWorld(const MoveitScene& scene, Contact contact) {
  if (scene.octree()) scene.toWorld(contact);
  return contact;
}

MoveitContact toMoveit(const MoveitScene& scene, const PairReport& pair, const Contact& found) {
  const Contact contact = inWorld(scene, found);
  const CollisionModel& first = scene.scene().models()[pair.first];
  const CollisionModel& second = scene.scene().models()[pair.second];
  MoveitContact made;
  made.pos = 0.5 * (contact.p_WFirst + contact.p_WSecond);
  made.normal = contact.nhat_W;
  made.depth = contact.depth;
  made.body_name_1 = scene.nameOf(first);
  made.body_type_1 = typeOf(scene.movingOf(first));
  made.body_name_2 = scene.nameOf(second);
  made.body_type_2 = typeOf(scene.movingOf(second));
  made.percent_interpolation = 0.0;
  made.nearest_points[0] = contact.p_WFirst;
  made.nearest_points[1] = contact.p_WSecond;
  return made;
}

std::pair<std::string, std::string> sortedNames(const MoveitScene& scene, const PairReport& pair) {
  const auto& models = scene.scene().models();
  return std::minmax(scene.nameOf(models[pair.first]), scene.nameOf(models[pair.second]));
}

std::vector<const Contact*> deepestFirst(const CollisionReport& report, const PairReport& pair) {
  std::vector<const Contact*> contacts;
  for (std::uint32_t i = 0; i < pair.nb_contacts; ++i) {
    contacts.push_back(&report.contacts[pair.first_contact + i]);
  }
  std::stable_sort(contacts.begin(), contacts.end(),
                   [](const Contact* a, const Contact* b) { return a->depth > b->depth; });
  return contacts;
}

class Results {
 public:
  Results(const CollisionRequest& request, CollisionResult& result)
      : request_(request), result_(result) {}

  bool wantsContacts() const {
    return request_.contacts && result_.contact_count < request_.max_contacts;
  }
  bool wantsSeveralOfPair() const { return wantsContacts() && request_.max_contacts_per_pair > 1; }
  bool isDone() { return is_done_ || (result_.collision && !wantsContacts()); }
  void takeUnknown() { result_.collision = true; }

  void take(const MoveitScene& scene, const CollisionReport& report, const Rules* conditions) {
    if (report.verdict == Verdict::UNKNOWN) warnOfUnknown(scene, report);
    if (!conditions && report.verdict != Verdict::FREE) result_.collision = true;
    if (conditions && !report.left_out.empty()) result_.collision = true;
    for (const PairReport& pair : report.pairs) {
      if (isDone()) return;
      if (pair.mayTouch()) takePair(scene, report, pair, conditions);
      if (!is_done_ && request_.is_done) is_done_ = request_.is_done(result_);
    }
  }

 private:
  void takePair(const MoveitScene& scene, const CollisionReport& report, const PairReport& pair,
                const Rules* conditions) {
    if (pair.state == PairState::UNRESOLVED) result_.collision = true;
    collision_detection::DecideContactFn condition;
    if (conditions) condition = conditions->conditionOf(pair);
    const auto names = sortedNames(scene, pair);
    if (request_.verbose) {
      ROS_INFO_STREAM_NAMED("collision_detection.collision_pairs",
                            "'" << names.first << "' and '" << names.second << "' are in contact");
    }
    for (const Contact* contact : deepestFirst(report, pair)) {
      MoveitContact made = toMoveit(scene, pair, *contact);
      if (condition && condition(made)) continue;
      result_.collision = true;
      if (!wantsContacts()) return;
      auto& of_pair = result_.contacts[names];
      if (of_pair.size() >= request_.max_contacts_per_pair) return;
      of_pair.push_back(made);
      ++result_.contact_count;
    }
  }

  const CollisionRequest& request_;
  CollisionResult& result_;
  bool is_done_ = false;
};

void addCollisionsOf(const MoveitScene& scene, const moveit::core::RobotState& state,
                     const MoveitLimits& limits, Results& results) {
  if (results.isDone() || !scene.hasPairs()) return;
  const MoveitScene::Lease worker = scene.lease();
  if (!setPoses(scene, state, worker->poses)) return results.takeUnknown();
  Rules rules(scene, limits);
  CheckSettings settings = settingsFor(scene, limits);
  settings.verdict_only = !results.wantsContacts();
  std::vector<OctreeLeaf> leaves;
  if (scene.readsLeaves()) {
    leaves = scene.leavesWithin(0.0, settings.selection, *worker);
    worker->poses.voxels = voxelsOf(scene.resolution(), leaves);
  }
  const CollisionReport& report = detect(*worker, settings, rules);
  const auto& conditional = rules.conditional();
  const bool wants_each =  // of the leaves a check has only the deepest
      !conditional.empty() || (results.wantsSeveralOfPair() && !report.contacts.empty());
  if (wants_each && !leaves.empty()) {
    return addCollisionsOf(*scene.ofBoxes(leaves), state, limits, results);
  }
  results.take(scene, report, nullptr);
  if (conditional.empty() || results.isDone()) return;

  settings.verdict_only = false;
  settings.ignore_revision = 0;
  settings.may_ignore = [&](std::uint32_t a, std::uint32_t b) {
    return !std::binary_search(conditional.begin(), conditional.end(), std::make_pair(a, b));
  };
  results.take(scene, worker->detector.detect(worker->poses, settings), &rules);
}

DistanceResultsData toMoveit(const MoveitScene& scene, const CollisionModel& first,
                             const CollisionModel& second, const Contact& found) {
  const Contact contact = inWorld(scene, found);
  DistanceResultsData data;
  data.distance = -contact.depth;
  data.nearest_points[0] = contact.p_WFirst;
  data.nearest_points[1] = contact.p_WSecond;
  data.normal = contact.nhat_W;
  data.link_names[0] = scene.nameOf(first);
  data.link_names[1] = scene.nameOf(second);
  data.body_types[0] = typeOf(scene.movingOf(first));
  data.body_types[1] = typeOf(scene.movingOf(second));
  return data;
}

void takeSmallest(const DistanceResultsData& data, DistanceResult& result) {
  if (data.distance < result.minimum_distance.distance) result.minimum_distance = data;
  if (data.distance <= 0.0) result.collision = true;
}

void takePairs(const MoveitScene& scene, const CollisionReport& report,
               const DistanceRequest& request, DistanceResult& result) {
  const auto& models = scene.scene().models();
  for (const PairReport& pair : report.pairs) {
    auto& of_pair = result.distances[sortedNames(scene, pair)];
    for (const Contact* contact : deepestFirst(report, pair)) {
      const auto data = toMoveit(scene, models[pair.first], models[pair.second], *contact);
      takeSmallest(data, result);
      const std::size_t most = request.type == DistanceRequestType::SINGLE ? 1
                               : request.type == DistanceRequestType::LIMITED
                                   ? request.max_contacts_per_body
                                   : of_pair.max_size();
      // An object with octrees has several models.
      const auto is_nearer = [](const auto& a, const auto& b) { return a.distance < b.distance; };
      of_pair.insert(std::upper_bound(of_pair.begin(), of_pair.end(), data, is_nearer), data);
      if (of_pair.size() > most) of_pair.pop_back();
    }
  }
}

/// Of an octree with ever more leaves, until the nearest is among them.
const CollisionReport& detectDistances(const MoveitScene& scene, const CheckSettings& settings,
                                       const DistanceResult& result, MoveitScene::Worker& worker) {
  if (!scene.readsLeaves()) return worker.detector.detect(worker.poses, settings);
  double reach = settings.min_distance ? 8.0 * scene.resolution() : settings.alarm_distance;
  for (;;) {
    worker.poses.voxels =
        voxelsOf(scene.resolution(), scene.leavesWithin(reach, settings.selection, worker));
    const CollisionReport& report = worker.detector.detect(worker.poses, settings);
    const double known = std::min(report.min_distance, result.minimum_distance.distance);
    if (!settings.min_distance || known <= reach || std::isinf(reach)) return report;
    reach = reach < FARTHEST ? 4.0 * reach : std::numeric_limits<double>::infinity();
  }
}

void addDistancesOf(const MoveitScene& scene, const moveit::core::RobotState& state,
                    const MoveitLimits& limits, const DistanceRequest& request,
                    DistanceResult& result) {
  if (!scene.hasPairs()) return;
  const MoveitScene::Lease worker = scene.lease();
  const Rules rules(scene, limits);
  CheckSettings settings = settingsFor(scene, limits);
  settings.may_ignore = [&](std::uint32_t a, std::uint32_t b) {
    return rules.ofPair(a, b) == AllowedContact::ALWAYS;  // on a condition: it has a distance
  };
  const bool is_global = request.type == DistanceRequestType::GLOBAL;
  settings.min_distance = is_global;
  if (!is_global) {
    const double threshold = request.distance_threshold;
    settings.alarm_distance =
        std::isnan(threshold) ? FARTHEST : std::clamp(threshold, 0.0, FARTHEST);
  }
  bool is_unknown = !setPoses(scene, state, worker->poses);
  if (!is_unknown) {
    const CollisionReport& report = detectDistances(scene, settings, result, *worker);
    is_unknown = report.verdict == Verdict::UNKNOWN;
    if (is_unknown) warnOfUnknown(scene, report);
    if (!is_global) {
      takePairs(scene, report, request, result);
    } else if (report.nearest) {
      const auto& models = scene.scene().models();
      const auto& elements = scene.scene().elements();
      takeSmallest(
          toMoveit(scene, models[elements[report.nearest->elements.first].model],
                   models[elements[report.nearest->elements.second].model], *report.nearest),
          result);
    } else if (report.unchecked.empty()) {  // of a pair that is not certain
      auto& smallest = result.minimum_distance.distance;
      smallest = std::min(smallest, report.min_distance);
    }
  }
  if (!is_unknown) return;
  result.collision = true;
  result.minimum_distance.distance = std::min(result.minimum_distance.distance, 0.0);
}

}  // namespace

void warnRarely(const std::string& text) {
  static std::atomic<std::int64_t> last{-1};
  const auto now = std::chrono::duration_cast<std::chrono::seconds>(
                       std::chrono::steady_clock::now().time_since_epoch())
                       .count();
  if (last.exchange(now) != now) ROS_WARN_STREAM_NAMED("collision_detection.collision_pairs", text);
}

void addCollisions(const MoveitScene& scene, const moveit::core::RobotState& state,
                   const MoveitLimits& limits, const CollisionRequest& request,
                   CollisionResult& result) {
  if (request.cost) warnRarely("costs of collisions are not computed");
  Results results(request, result);
  addCollisionsOf(scene, state, limits, results);
  for (const auto& octree : scene.octrees()) addCollisionsOf(*octree, state, limits, results);
}

void addDistances(const MoveitScene& scene, const moveit::core::RobotState& state,
                  const MoveitLimits& limits, const DistanceRequest& request,
                  DistanceResult& result) {
  addDistancesOf(scene, state, limits, request, result);
  for (const auto& octree : scene.octrees()) {
    addDistancesOf(*octree, state, limits, request, result);
  }
}

}  // namespace collision_pairs
