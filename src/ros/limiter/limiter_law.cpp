#include "limiter_law.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace collision_pairs {
namespace {

// Metres kept beyond stop_distance except by a command that leads away. It leaves room for what the
// joints of a robot that sets out for a retreat do one after the other.
constexpr double ROOM_TO_RETREAT = 0.002;
constexpr double TIMER_ERROR = 0.01;   // s, by which zeros may come late after command_timeout
constexpr double LEAST_SCALE = 0.005;  // below it the robot is stopped
constexpr int MOST_CERTIFICATES = 5;   // of a search; each costs up to some 100 us
constexpr double NEXT_GUESS = 0.85, FAR_GUESS = 1.0 / 3.0, NEAR_ENOUGH = 0.9;
constexpr int RETREATS = 4;  // scales that are tried
constexpr double NEXT_RETREAT = 0.25;
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

}  // namespace

struct LimiterLaw::Question {
  const LimiterInput& input;
  Surroundings& surroundings;
  Surroundings::Certificate refused{};  ///< the last one that was not free
  std::string no_retreat{};
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
  decision.seconds_to_rest = passed_.secondsToRest(decision.command);
  return decision;
}

void LimiterLaw::published(double now, const LimiterDecision& decision) {
  scale_ = decision.scale;
  scale_time_ = std::isfinite(decision.publish_by) ? decision.publish_by : now;
  passed_.add(now, decision.command);
}

StoppingTube LimiterLaw::tubeAt(const LimiterInput& input, double scale) const {
  return passed_.tube(input.stamp, input.now, input.command, scaled(input.command, scale));
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
    decision.scale = largestScale(question, most);
    if (decision.scale > 0.0) decision.verdict = Verdict::FREE;
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
    decision.seconds_to_rest = passed_.secondsToRest(decision.command);
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
    std::vector<NearPair> pairs;
    std::string why;
    if (!decision.first.empty() &&
        surroundings.nearPairs(settings_.stop_distance + 0.1, input.command, pairs, why)) {
      for (const NearPair& pair : pairs) {
        if (pair.first != decision.first || pair.second != decision.second) continue;
        decision.distance = pair.distance;
        decision.has_distance = true;
      }
    }
  }
  return decision;
}

bool LimiterLaw::isCertified(Question& question, double scale) const {
  const LimiterInput& input = question.input;
  const StoppingTube tube = tubeAt(input, scale);
  const double needed = settings_.stop_distance + ROOM_TO_RETREAT, coming = growth(input, tube);
  Surroundings::Certificate found = question.surroundings.certify(tube, needed, coming, {});
  if (found.is_free) return true;
  if (found.why.empty()) {
    found.why = "on the stopping path a pair comes nearer than " + inMetres(needed);
    if (coming > 0.0) found.why += ", or than " + inMetres(needed + coming) + " to an object";
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

// All pairs that could come too near are looked at, each must become further apart.
double LimiterLaw::retreatScale(Question& question, double most) const {
  const LimiterInput& input = question.input;
  double scale = std::min(settings_.retreat_scale, most);
  for (int i = 0; i < RETREATS; ++i, scale *= NEXT_RETREAT) {
    const StoppingTube tube = tubeAt(input, scale);
    const double coming = growth(input, tube), travel = question.surroundings.travel(tube);
    const double reach = settings_.stop_distance + ROOM_TO_RETREAT + coming + 2.0 * travel;
    std::vector<NearPair> pairs;
    if (!question.surroundings.nearPairs(reach, input.command, pairs, question.no_retreat))
      continue;
    const auto isFarEnough = [&](const NearPair& pair) {
      return pair.distance > reach - (pair.is_robot ? coming : travel);  // one of the two moves
    };
    pairs.erase(std::remove_if(pairs.begin(), pairs.end(), isFarEnough), pairs.end());
    if (mayRetreat(question, scale, std::move(pairs))) return scale;
  }
  return 0.0;
}

bool LimiterLaw::mayRetreat(Question& question, double scale, std::vector<NearPair> pairs) const {
  const LimiterInput& input = question.input;
  if (pairs.empty()) return false;  // what is not certified lies ahead
  double speed = 0.0;
  for (const double number : input.command) speed += std::abs(number);
  question.touches = pairs.front().distance <= 0.0;
  for (const NearPair& pair : pairs) {
    if (pair.derivative > LEAST_DERIVATIVE * speed) continue;
    question.refused = {false, pair.first, pair.second, question.refused.why};
    question.no_retreat = "it does not lead away from all that is near";
    return false;
  }
  question.refused.first = pairs.front().first;
  question.refused.second = pairs.front().second;
  const StoppingTube tube = tubeAt(input, scale);
  const double stop_distance = settings_.stop_distance;
  std::vector<NearPair> nearer;
  bool is_contact = false;
  for (NearPair& pair : pairs) {
    if (pair.distance >= stop_distance + 0.5 * ROOM_TO_RETREAT) break;
    if (pair.distance < CONTACT) {
      is_contact = true;
      if (!question.surroundings.leadsApart(tube, pair)) {
        question.no_retreat = "it would lead deeper into contact";
        return false;
      }
    }
    pair.distance =
        pair.distance < CONTACT ? -1.0 : GIVEN_AWAY * std::min(pair.distance, stop_distance);
    nearer.push_back(std::move(pair));
  }
  // Another part of the same two may be in the way: a cloud is one model.
  if (is_contact) {
    if (!passed_.areAlong(input.command, input.stamp)) {
      question.no_retreat = "the robot does not stand yet";
      return false;
    }
    const double furthest = std::max(GIVEN_AWAY * stop_distance, ROOM_TO_RETREAT);
    if (question.surroundings.travel(tube) > furthest) {
      question.no_retreat = "it would lead too far";
      return false;
    }
  }
  const Surroundings::Certificate found =
      question.surroundings.certify(tube, stop_distance, 0.0, nearer);
  if (!found.is_free) question.no_retreat = "its way back is not certified";
  return found.is_free;
}

}  // namespace collision_pairs
