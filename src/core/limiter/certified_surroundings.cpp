#include "certified_surroundings.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "collision_pairs/input_error.h"
#include "joint_sampler.h"

namespace collision_pairs {
namespace {

constexpr double RESOLUTION = 5e-4;  // m: a pair that keeps this much more than asked is certified
constexpr std::size_t MOST_HALVED = 2;  // deviations of joints, of which each doubles the cost
constexpr double OVERLAP = 1.0 + 1e-9;  // of halves, for rounding
constexpr double LEFT_OUT = -1.0;       // of a ClearanceOf
constexpr double DEEPER = 1e-4;         // m, by which a contact's depth may be off
constexpr int STATES = 200;             // random ones, of alwaysNear()
constexpr int PLACES = 4;               // of a path that leads out of contact, after its first
const char* const TIME_IS_OVER = "the time for the decision is over";

}  // namespace

CertifiedSurroundings::CertifiedSurroundings(std::shared_ptr<const CollisionScene> scene,
                                             const std::vector<std::string>& joints,
                                             Fidelity fidelity)
    : scene_(std::move(scene)),
      columns_(joints, scene_->robot()),
      fidelity_(fidelity),
      motions_(scene_),
      detector_(scene_),
      gradient_(*scene_, columns_),
      rates_(joints.size()) {
  const auto& all = scene_->robot().joints();
  for (std::size_t i = 0; i < joints.size(); ++i) {
    const Joint& joint = all[columns_.jointOf(i)];
    if (!joint.mimic) continue;
    throw InputError(
        "joint '" + joint.name + "' mimics '" + all[joint.mimic->joint].name +
        "', so it has no velocity of its own: leave it out of the joints, or its <mimic>");
  }
  RobotState any;
  any.positions = scene_->robot().zeroPositions();
  any.voxels.resize(scene_->clouds().size());
  setState(std::move(any));
  std::vector<NearPair> pairs;
  std::string why;
  const std::vector<double> none(joints.size(), 0.0);
  nearPairs(0.0, none, pairs, why);
  certify({none, none, none, 0.0}, {}, {});
}

double CertifiedSurroundings::secondsLeft() const {
  const std::chrono::duration<double> left = deadline_ - std::chrono::steady_clock::now();
  return left.count();
}

void CertifiedSurroundings::setState(RobotState state) {
  state_ = std::move(state);
  scene_->robot().applyMimics(state_.positions);
  carriers_.resize(scene_->models().size());
  for (std::uint32_t model = 0; model < carriers_.size(); ++model) {
    carriers_[model] = scene_->carrierOf(model, state_.placed);
  }
  place(state_.positions);
}

void CertifiedSurroundings::place(const std::vector<double>& positions) {
  scene_->robot().forwardKinematics(positions, state_.placed, X_WB_);
  scene_->gatherPoses(X_WB_, poses_);
  poses_.voxels = state_.voxels;
}

bool CertifiedSurroundings::areLinks(std::uint32_t first, std::uint32_t second) const {
  return carriers_[first] >= 0 && carriers_[first] == carriers_[second];
}

bool CertifiedSurroundings::areOfRobot(std::uint32_t first, std::uint32_t second) const {
  return scene_->models()[first].body >= 0 && scene_->models()[second].body >= 0;
}

// What is refused for two links is tried again by halves, for these two alone.
Surroundings::Certificate CertifiedSurroundings::certify(const StoppingTube& tube,
                                                         const KeptDistances& kept,
                                                         const std::vector<NearPair>& nearer) {
  using Models = std::pair<std::uint32_t, std::uint32_t>;
  std::vector<std::pair<Models, double>> own;
  for (const NearPair& pair : nearer) {
    own.push_back({std::minmax(idOf(pair.first), idOf(pair.second)), pair.distance});
  }
  const ClearanceOf clearanceOf = [&](std::uint32_t first, std::uint32_t second) {
    double clearance = kept.of(areLinks(first, second), areOfRobot(first, second));
    for (const auto& [models, distance] : own) {
      if (models == Models(first, second)) clearance = std::min(clearance, distance);
    }
    return clearance;
  };
  const double most = std::max(kept.links, kept.others + kept.coming);
  Certificate found = certifyAtOnce(tube, most, clearanceOf);
  while (!found.is_free && found.are_links) {
    const Certificate by_halves = certifyByHalves(tube, most, clearanceOf, found);
    if (!by_halves.is_free) return by_halves;
    own.push_back({std::minmax(idOf(found.first), idOf(found.second)), LEFT_OUT});
    found = certifyAtOnce(tube, most, clearanceOf);
  }
  return found;
}

// A tube is the union of those of which the deviations are halves of its own, on either side. Their
// certificates ask for less, because a deviation counts as far as its joint moves a link.
Surroundings::Certificate CertifiedSurroundings::certifyByHalves(const StoppingTube& tube,
                                                                 double clearance,
                                                                 const ClearanceOf& of,
                                                                 const Certificate& refused) {
  const std::pair<std::uint32_t, std::uint32_t> models =
      std::minmax(idOf(refused.first), idOf(refused.second));
  const ClearanceOf of_these = [&](std::uint32_t first, std::uint32_t second) {
    return std::pair(first, second) == models ? of(first, second) : LEFT_OUT;
  };
  std::vector<int> halved = columnsBetween(models.first, models.second);
  const auto isExact = [&tube](int column) { return tube.deviation[column] == 0.0; };
  halved.erase(std::remove_if(halved.begin(), halved.end(), isExact), halved.end());
  if (halved.empty() || halved.size() > MOST_HALVED) return refused;
  Certificate found;
  for (unsigned part = 0; part < 1U << halved.size(); ++part) {
    StoppingTube of_part = tube;
    for (std::size_t i = 0; i < halved.size(); ++i) {
      const int column = halved[i];
      const double half = 0.5 * tube.deviation[column], side = part >> i & 1U ? half : -half;
      of_part.from[column] += side;
      of_part.to[column] += side;
      of_part.deviation[column] = half * OVERLAP;
    }
    found = certifyAtOnce(of_part, clearance, of_these);
    if (!found.is_free) return found;
  }
  return found;
}

Surroundings::Certificate CertifiedSurroundings::certifyAtOnce(const StoppingTube& tube,
                                                               double clearance,
                                                               const ClearanceOf& of) {
  JointMotion motion;
  motion.from = motion.to = state_.positions;
  motion.deviation.assign(motion.from.size(), 0.0);
  for (std::size_t i = 0; i < columns_.size(); ++i) {
    motion.from[columns_.jointOf(i)] += tube.from[i];
    motion.to[columns_.jointOf(i)] += tube.to[i];
    motion.deviation[columns_.jointOf(i)] = tube.deviation[i];
  }
  MotionSettings settings;
  settings.fidelity = fidelity_;
  settings.clearance = clearance;
  settings.clearance_of = of;
  settings.resolution = RESOLUTION;
  settings.only_free = settings.only_moved = true;
  const double left = secondsLeft();
  if (left <= 0.0) return {false, "", "", TIME_IS_OVER};
  if (deadline_ != std::chrono::steady_clock::time_point::max()) settings.time_budget = left;
  const MotionReport& report = motions_.check(motion, settings, state_.placed, state_.voxels);
  Certificate certificate;
  // If all that there is to check is left out, it is the caller's to bound; but not what is
  // unknown.
  const bool is_all_left_out =
      report.unchecked != scene_->unchecked() && report.pairs.empty() && scene_->missing().empty();
  certificate.is_free = report.verdict == Verdict::FREE || is_all_left_out;
  if (certificate.is_free) return certificate;
  if (secondsLeft() <= 0.0) {
    certificate.why = TIME_IS_OVER;
  } else {
    certificate.why = report.pairs.empty() ? report.unknown_because.front() : report.unchecked;
  }
  if (!report.pairs.empty()) {
    const auto [first, second] = report.pairs.front();
    certificate.first = scene_->models()[first].name;
    certificate.second = scene_->models()[second].name;
    certificate.are_links = areLinks(first, second);
  }
  return certificate;
}

// The joints of a link turn one after the other, the nearest to the link first, each about its
// present axis: so each moves a point by at most its angle times the point's present radius.
double CertifiedSurroundings::travel(const StoppingTube& tube) {
  const RobotModel& robot = scene_->robot();
  std::vector<double> moved(robot.joints().size(), 0.0);
  for (std::size_t i = 0; i < columns_.size(); ++i) {
    moved[columns_.jointOf(i)] =
        std::max(std::abs(tube.from[i]), std::abs(tube.to[i])) + tube.deviation[i];
  }
  std::vector<double> zeros(moved.size(), 0.0);
  robot.applyMimics(zeros);
  robot.applyMimics(moved);
  double most = 0.0;
  for (std::uint32_t i = scene_->nbStaticElements(); i < scene_->endOfMovingElements(); ++i) {
    const SceneElement& element = scene_->elements()[i];
    if (element.body < 0) continue;
    int body = scene_->bodies()[element.body].body;
    const Eigen::Vector3d center = X_WB_[body] * element.X_BE * element.box_center;
    const double radius = element.box_half.norm();
    double sum = 0.0;
    for (; body >= 0; body = robot.bodies()[body].parent) {
      const int id = robot.bodies()[body].joint;
      if (id < 0) continue;
      const double way = std::abs(moved[id] - zeros[id]);
      if (way == 0.0) continue;
      const Joint& joint = robot.joints()[id];
      const Eigen::Vector3d axis_W = X_WB_[body].linear() * joint.axis;
      sum += joint.type == JointType::PRISMATIC
                 ? way
                 : way * (axis_W.cross(center - X_WB_[body].translation()).norm() + radius);
    }
    most = std::max(most, sum);
  }
  return most;
}

double CertifiedSurroundings::distance(const std::string& first, const std::string& second,
                                       double reach) {
  return placedDistance(idOf(first), idOf(second), reach);
}

double CertifiedSurroundings::placedDistance(std::uint32_t first, std::uint32_t second,
                                             double reach) {
  CheckSettings settings;
  settings.alarm_distance = reach;
  settings.fidelity = fidelity_;
  settings.may_ignore = [models = std::minmax({first, second})](auto a, auto b) {
    return std::pair(a, b) != models;
  };
  const CollisionReport* report = detect(settings);
  if (report == nullptr || !report->left_out.empty()) return NAN;
  return report->pairs.empty() ? HUGE_VAL : report->pairs.front().distance;
}

bool CertifiedSurroundings::leadsApart(const StoppingTube& tube, const NearPair& pair) {
  const std::uint32_t first = idOf(pair.first), second = idOf(pair.second);
  const double reach = std::max(0.0, pair.distance);
  bool is_apart = true;
  for (int i = 0; i <= PLACES && is_apart; ++i) {
    const double share = static_cast<double>(i) / PLACES;
    std::vector<double> positions = state_.positions;
    for (std::size_t j = 0; j < columns_.size(); ++j) {
      positions[columns_.jointOf(j)] += tube.from[j] + share * (tube.to[j] - tube.from[j]);
    }
    scene_->robot().applyMimics(positions);
    place(positions);
    is_apart = placedDistance(first, second, reach) >= pair.distance - DEEPER;  // not if unknown
  }
  place(state_.positions);
  return is_apart;
}

std::uint32_t CertifiedSurroundings::idOf(const std::string& name) const {
  return static_cast<std::uint32_t>(scene_->findModel(name));
}

std::vector<int> CertifiedSurroundings::columnsBetween(std::uint32_t first_model,
                                                       std::uint32_t second_model) const {
  const auto bodyOf = [&](auto model) { return scene_->robotBody(scene_->models()[model]); };
  const RobotModel& robot = scene_->robot();
  std::vector<int> columns;
  robot.visitBetween(bodyOf(first_model), bodyOf(second_model), [&](int body, bool) {
    const int joint = robot.bodies()[body].joint;
    const int column = joint < 0 ? -1 : columns_.sourceOf(joint).column;
    if (column >= 0) columns.push_back(column);
  });
  std::sort(columns.begin(), columns.end());  // a joint and one that mimics it have the same
  columns.erase(std::unique(columns.begin(), columns.end()), columns.end());
  return columns;
}

bool CertifiedSurroundings::moves(const PairReport& pair,
                                  const std::vector<double>& direction) const {
  const std::vector<int> columns = columnsBetween(pair.first, pair.second);
  return std::any_of(columns.begin(), columns.end(),
                     [&](int column) { return direction[column] != 0.0; });
}

std::vector<std::string> CertifiedSurroundings::alwaysNear(const KeptDistances& kept) {
  const JointSampler sampler({scene_, &scene_->robot()}, 1);
  const std::vector<double> all(columns_.size(), 1.0);
  CheckSettings settings;
  settings.alarm_distance = std::max(kept.links, kept.others) + RESOLUTION;
  settings.fidelity = fidelity_;
  std::map<std::pair<std::uint32_t, std::uint32_t>, double> furthest;  // metres
  for (int i = 0; i < STATES && (i == 0 || !furthest.empty()); ++i) {
    std::vector<double> positions;
    sampler.draw(static_cast<std::uint64_t>(i), positions);
    place(positions);
    auto before = std::exchange(furthest, {});
    for (const PairReport& pair : detector_.detect(poses_, settings).pairs) {
      const NearPair near = nearPair(pair);
      const std::pair<std::uint32_t, std::uint32_t> models(pair.first, pair.second);
      const bool is_first = i == 0 || before.count(models) > 0;
      if (!is_first || !near.is_robot || pair.distance >= kept.of(near) + RESOLUTION) continue;
      if (moves(pair, all)) furthest[models] = std::max(pair.distance, before[models]);
    }
  }
  std::vector<std::string> sentences;
  for (const auto& [models, distance] : furthest) {
    const std::string &first = scene_->models()[models.first].name,
                      &second = scene_->models()[models.second].name;
    sentences.push_back(first + " and " + second + " stop every command: in " +
                        std::to_string(STATES) + " random states they were never more than " +
                        std::to_string(1e3 * distance) +
                        " mm apart; let the SRDF disable this pair if it cannot collide, or set a "
                        "smaller velocity_limiter/self_stop_distance or stop_distance");
  }
  return sentences;
}

NearPair CertifiedSurroundings::nearPair(const PairReport& pair) const {
  const CollisionModel &first = scene_->models()[pair.first],
                       &second = scene_->models()[pair.second];
  return {first.name,
          second.name,
          pair.distance,
          NAN,
          areOfRobot(pair.first, pair.second),
          areLinks(pair.first, pair.second)};
}

const CollisionReport* CertifiedSurroundings::detect(CheckSettings& settings) {
  const double left = secondsLeft();
  if (left <= 0.0) return nullptr;
  if (deadline_ != std::chrono::steady_clock::time_point::max()) settings.time_budget = left;
  const CollisionReport& report = detector_.detect(poses_, settings);
  return report.nb_unresolved > 0 ? nullptr : &report;
}

bool CertifiedSurroundings::nearPairs(double reach, const std::vector<double>& direction,
                                      std::vector<NearPair>& pairs, std::string& why) {
  CheckSettings settings;
  settings.alarm_distance = reach;
  settings.fidelity = fidelity_;
  const CollisionReport* const found = detect(settings);
  if (found == nullptr) {
    why = TIME_IS_OVER;
    return false;
  }
  const CollisionReport& report = *found;
  if (!report.left_out.empty()) {
    why = scene_->models()[report.left_out.front()].name + " is not known";
    return false;
  }
  if (!report.unchecked.empty()) {
    why = report.unchecked;
    return false;
  }
  pairs.clear();
  for (const PairReport& pair : report.pairs) {
    if (!moves(pair, direction)) continue;
    NearPair near = nearPair(pair);
    if (gradient_.compute(pair, report, X_WB_, rates_.data())) {
      near.derivative = 0.0;
      for (std::size_t i = 0; i < rates_.size(); ++i) near.derivative += rates_[i] * direction[i];
    }
    pairs.push_back(std::move(near));
  }
  std::sort(pairs.begin(), pairs.end(),
            [](const NearPair& a, const NearPair& b) { return a.distance < b.distance; });
  return true;
}

}  // namespace collision_pairs
