#include "limiter_law.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <utility>

namespace collision_pairs {
namespace {

// Metres kept beyond a pair's stop distance except by a command that leads away. It leaves room for
// what the joints of a robot that sets out for a retreat do one after the other.
constexpr double ROOM_TO_RETREAT = 0.002;
// The same, in addition, for a command by which the robot was stopped: measured positions change a
// little although it stands, and the scale would leave zero again and again.
constexpr double ROOM_TO_GO_ON = 0.002;
constexpr double SAME_DIRECTION = 0.9;  // cosine: such a command is the one that was stopped
constexpr double TIMER_ERROR = 0.01;    // s, by which zeros may come late after command_timeout
constexpr double LEAST_SCALE = 0.005;   // below it the robot is stopped
constexpr int MOST_CERTIFICATES = 5;    // of a search; each costs up to some 100 us
constexpr double NEXT_GUESS = 0.85, FAR_GUESS = 1.0 / 3.0, NEAR_ENOUGH = 0.9;
constexpr double SHOWN = 0.1;  // m beyond stop_distance, to which a pair's distance is told
constexpr double RETREATS[] = {1.0, 0.5, 0.125, 1.0 / 64.0};  // of its scale, as they are tried
// Metres: nearer than this counts as contact, of which nothing is left to certify.
constexpr double CONTACT = 2e-5;
constexpr double LEAST_DERIVATIVE = 1e-5;  // m per rad or m: errors of gradients are smaller
constexpr double GIVEN_AWAY = 0.5;         // share of a distance below stop_distance

std::vector<double> scaled(const std::vector<double>& command, double scale) {
  std::vector<double> result = command;
  for (double& number : result) number *= scale;
  return result;
}

std::string inMetres(double metres) {
  const std::string text = std::to_string(metres);
  return text.substr(0, text.find('.') + 4) + " m";
}

bool isAlong(const std::vector<double>& a, const std::vector<double>& b) {
  if (a.size() != b.size()) return false;
  double ab = 0.0, aa = 0.0, bb = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    ab += a[i] * b[i];
    aa += a[i] * a[i];
    bb += b[i] * b[i];
  }
  return ab > SAME_DIRECTION * std::sqrt(aa) * std::sqrt(bb);
}

}  // namespace

struct LimiterLaw::Question {
  const LimiterInput& input;
  Surroundings& surroundings;
  Surroundings::Certificate refused{};  ///< the last one that was not free
  std::string no_retreat{};
  double room = ROOM_TO_RETREAT;
  bool touches = false;
  bool is_retreat = false;
};

LimiterLaw::LimiterLaw(const LimiterSettings& settings)
    : settings_(settings),
      passed_({settings.reaction_time, settings.command_timeout + TIMER_ERROR,
               settings.deceleration}) {}

std::string LimiterLaw::whyRefused(const LimiterInput& input) const {
  const std::size_t nb_joints = settings_.deceleration.size();
  if (input.command.size() != nb_joints) {
    return "the command has " + std::to_string(input.command.size()) + " numbers, but " +
           std::to_string(nb_joints) + " joints are limited";
  }
  for (const double number : input.command) {
    if (!std::isfinite(number)) return "the command is not finite";
  }
  const double age = input.now - input.stamp;
  if (!(age <= settings_.max_joint_state_age)) {
    return "the joint state is " + std::to_string(age) + " s old";
  }
  if (!(age >= 0.0)) return "the joint state is of the future";
  if (!(input.obstacles_age >= 0.0)) return "the age of obstacles is not known";
  return "";
}

LimiterDecision LimiterLaw::stop(const std::string& reason) const {
  LimiterDecision decision;
  decision.command.assign(settings_.deceleration.size(), 0.0);
  decision.reason = reason;
  return decision;
}

void LimiterLaw::published(double now, const LimiterDecision& decision) {
  scale_ = decision.scale;
  scale_time_ = std::isfinite(decision.publish_by) ? decision.publish_by : now;
  stopped_ = decision.stopped;
  stopped_for_ = {decision.first, decision.second};
  passed_.add(now, decision.command);
}

KeptDistances LimiterLaw::kept(double room, double coming) const {
  return {settings_.self_stop_distance + room, settings_.stop_distance + room, coming};
}

KeptDistances LimiterLaw::needed() const { return kept(ROOM_TO_RETREAT, 0.0); }

StoppingTube LimiterLaw::tubeAt(const LimiterInput& input, double scale) const {
  return passed_.tube(input.stamp, input.now, input.command, scaled(input.command, scale),
                      input.later);
}

// What comes towards the robot until it stands.
double LimiterLaw::growth(const LimiterInput& input, const StoppingTube& tube) const {
  const double since_stamp = input.now - input.stamp;
  const double longer = std::max(input.obstacles_age - since_stamp, 0.0);
  return settings_.obstacle_speed * (tube.seconds + longer);
}

LimiterDecision LimiterLaw::decide(const LimiterInput& input, Surroundings& surroundings) const {
  const std::string refused = whyRefused(input);
  LimiterDecision decision = stop(refused);
  decision.publish_by = input.now;
  if (!refused.empty()) return decision;
  const double risen = settings_.ramp_up * (input.now - scale_time_);
  const double most = std::min(1.0, scale_ + std::max(risen, 0.0));
  const auto isZero = [](double number) { return number == 0.0; };
  if (std::all_of(input.command.begin(), input.command.end(), isZero)) {
    decision.scale = most;
    decision.verdict = Verdict::FREE;
  } else {
    Question question{input, surroundings};
    if (isAlong(input.command, stopped_)) question.room += ROOM_TO_GO_ON;
    decision.scale = largestScale(question, most);
    // Also of zeros, where no time has passed since others: the scale has not risen yet.
    const bool is_certified = decision.scale > 0.0 || question.refused.why.empty();
    if (is_certified) decision.verdict = Verdict::FREE;
    if (decision.scale < std::min(settings_.retreat_scale, most)) {
      const double retreat = retreatScale(question, most);
      if (retreat > decision.scale) {
        decision.scale = retreat;
        decision.verdict = Verdict::UNKNOWN;
        question.is_retreat = true;
      }
    }
    if (question.touches) decision.verdict = Verdict::COLLISION;
    decision.command = scaled(input.command, decision.scale);
    decision.first = question.refused.first;
    decision.second = question.refused.second;
    if (question.is_retreat) {
      decision.reason = "it leads away from what is near";
    } else if (!question.refused.why.empty()) {
      decision.reason = question.refused.why;
      if (decision.scale == 0.0 && !question.no_retreat.empty()) {
        decision.reason += "; " + question.no_retreat;
      }
    } else if (decision.scale < 1.0) {
      decision.reason = "the scale is rising";
    }
    if (!decision.first.empty()) {
      const double reach = settings_.stop_distance + SHOWN;
      const double distance = surroundings.distance(decision.first, decision.second, reach);
      decision.has_distance = std::isfinite(distance);
      if (decision.has_distance) decision.distance = distance;
    }
    if (decision.scale == 0.0 && !decision.first.empty()) decision.stopped = input.command;
  }
  return decision;
}

bool LimiterLaw::isCertified(Question& question, double scale) const {
  const LimiterInput& input = question.input;
  const StoppingTube tube = tubeAt(input, scale);
  const KeptDistances needed = kept(question.room, growth(input, tube));
  Surroundings::Certificate found = question.surroundings.certify(tube, needed, {});
  // What was not stopped for may stay as near as ever.
  const bool is_another = std::pair(found.first, found.second) != stopped_for_;
  if (!found.is_free && question.room > ROOM_TO_RETREAT && is_another) {
    const KeptDistances least = kept(ROOM_TO_RETREAT, growth(input, tube));
    found = question.surroundings.certify(tube, least, {});
  }
  if (found.is_free) return true;
  if (found.why.empty()) {
    found.why = "on the stopping path a pair comes nearer than " +
                inMetres(found.are_links ? needed.links : needed.others);
    if (needed.coming > 0.0 && !found.are_links) {
      found.why += ", or than " + inMetres(needed.others + needed.coming) + " to an object";
    }
  }
  question.refused = std::move(found);
  return false;
}

// The whole first, since it passes nearly always, then what was last passed, a little less.
double LimiterLaw::largestScale(Question& question, double most) const {
  if (isCertified(question, most)) return most;
  double lowest = 0.0, highest = most;
  double guess = NEXT_GUESS * std::min(most, scale_ > 0.0 ? scale_ : most);
  for (int i = 1; i < MOST_CERTIFICATES && guess >= std::min(LEAST_SCALE, most); ++i) {
    if (isCertified(question, guess)) {
      lowest = guess;
    } else {
      highest = guess;
    }
    if (lowest > NEAR_ENOUGH * highest) break;
    guess = lowest > 0.0 ? 0.5 * (lowest + highest) : FAR_GUESS * highest;
  }
  return lowest;
}

// All pairs that could come too near are looked at: those of the largest scale are those of all.
double LimiterLaw::retreatScale(Question& question, double most) const {
  const LimiterInput& input = question.input;
  std::vector<NearPair> near;
  double near_until = -1.0;
  for (const double share : RETREATS) {
    const double scale = share * std::min(settings_.retreat_scale, most);
    const StoppingTube tube = tubeAt(input, scale);
    const KeptDistances all = kept(ROOM_TO_RETREAT, growth(input, tube));
    const double travel = question.surroundings.travel(tube);
    if (!std::isfinite(travel)) {
      question.no_retreat = "the robot carries a plane, which has no end";
      return 0.0;
    }
    const double reach = std::max(all.links, all.others + all.coming) + 2.0 * travel;
    if (reach > near_until) {
      auto& surroundings = question.surroundings;
      if (!surroundings.nearPairs(reach, input.command, near, question.no_retreat)) return 0.0;
      near_until = reach;
    }
    const auto mayComeTooNear = [&](const NearPair& pair) {  // of a robot's pair both may move
      return !(pair.distance > all.of(pair) + (pair.is_robot ? 2.0 : 1.0) * travel);
    };
    std::vector<NearPair> pairs;
    std::copy_if(near.begin(), near.end(), std::back_inserter(pairs), mayComeTooNear);
    if (mayRetreat(question, scale, pairs)) return scale;
  }
  return 0.0;
}

// Pairs that the command leads apart may keep less than the certificate asks of all others, and
// those that are too near already have to be such pairs.
bool LimiterLaw::mayRetreat(Question& question, double scale,
                            const std::vector<NearPair>& pairs) const {
  const LimiterInput& input = question.input;
  const StoppingTube tube = tubeAt(input, scale);
  const KeptDistances least = kept(0.0, 0.0), asked = kept(0.0, growth(input, tube));
  double speed = 0.0;
  for (const double number : input.command) speed += std::abs(number);
  std::vector<NearPair> nearer;
  const NearPair* nearest_apart = nullptr;
  double furthest = std::numeric_limits<double>::infinity();  // that a path from contact may lead
  for (const NearPair& pair : pairs) {
    const double stop_distance = least.of(pair);
    question.touches = question.touches || pair.distance <= 0.0;
    if (!(pair.derivative > LEAST_DERIVATIVE * speed)) {
      if (pair.distance >= stop_distance + question.room) continue;
      question.refused = {false, pair.first, pair.second, question.refused.why};
      question.no_retreat = "it does not lead away from all that is near";
      return false;
    }
    if (nearest_apart == nullptr) nearest_apart = &pair;
    NearPair keeps = pair;
    keeps.distance = stop_distance;
    if (pair.distance < CONTACT) {
      keeps.distance = -1.0;
      furthest = std::min(furthest, std::max(GIVEN_AWAY * stop_distance, ROOM_TO_RETREAT));
    } else if (pair.distance < stop_distance + 0.5 * ROOM_TO_RETREAT) {
      keeps.distance = GIVEN_AWAY * std::min(pair.distance, stop_distance);
    }
    if (keeps.distance < asked.of(pair)) nearer.push_back(std::move(keeps));
  }
  if (nearest_apart == nullptr) {  // what is not certified lies ahead
    if (!pairs.empty()) question.no_retreat = "it leads away from nothing that is near";
    return false;
  }
  question.refused.first = nearest_apart->first;
  question.refused.second = nearest_apart->second;
  for (const NearPair& pair : pairs) {
    if (pair.distance >= CONTACT || question.surroundings.leadsApart(tube, pair)) continue;
    question.no_retreat = "it would lead deeper into contact";
    return false;
  }
  // Another part of the same two may be in the way: a cloud is one model.
  if (std::isfinite(furthest)) {
    if (!passed_.areAlong(input.command, input.stamp)) {
      question.no_retreat = "the robot does not stand yet";
      return false;
    }
    if (question.surroundings.travel(tube) > furthest) {
      question.no_retreat = "it would lead too far";
      return false;
    }
  }
  const Surroundings::Certificate found = question.surroundings.certify(tube, asked, nearer);
  if (!found.is_free) question.no_retreat = "its way back is not certified";
  return found.is_free;
}

}  // namespace collision_pairs
