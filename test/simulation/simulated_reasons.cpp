// The claims about the reasons in reports of a SimulatedNode: each is true, and none is missing.
#include <algorithm>
#include <cmath>

#include "simulated_node.h"

namespace simulation {
namespace {

constexpr double REFUSAL_SHOWN = 2.0;  // s

/// What was left out is a reason by itself; empty: nothing is missing.
std::string missingName(const CollisionScene& scene, const CollisionReport& report) {
  bool lacks_pose = false, lacks_cloud = false;
  for (const std::uint32_t model : report.left_out) {
    (scene.models()[model].name == "points" ? lacks_cloud : lacks_pose) = true;
  }
  const auto isSaid = [&](const std::string& words) {
    return std::any_of(report.unknown_because.begin(), report.unknown_because.end(),
                       [&](const std::string& reason) { return reason.rfind(words, 0) == 0; });
  };
  const bool are_said = isSaid("no usable pose: ") == lacks_pose &&
                        isSaid("clouds that are unknown or incomplete: ") == lacks_cloud;
  return are_said ? "" : "what was left out is not among the reasons";
}

}  // namespace

/// What is certain of a transform that arrived: it was refused with these words, or nothing is
/// wrong.
void SimulatedNode::noteTransform(int link, const std::optional<std::string>& refusal) {
  const TransformInput& transforms = monitor_.transforms();
  if (transforms.nbRefused() != nb_refused_ + (refusal ? 1 : 0)) {
    const std::vector<std::string> refused = transforms.refused();
    fail("another number of refused transforms is counted: " + (refusal ? "none because " + *refusal
                                                                : refused.empty()
                                                                    ? ""
                                                                    : refused.back()));
  }
  if (transforms.firstRefused().empty() != (transforms.nbRefused() == 0)) {
    fail("the first refused transform is not named");
  }
  if (refusal) {
    refusals_[link] = {*refusal, steady_};
  } else {
    refusals_[link] = {"", -1e9};
  }
}

/// `is_new`: the first of its stamp.
void SimulatedNode::noteHeard(int link, Ns stamp, bool is_new) {
  const Told& told = knowledge_.told(link);
  const bool stands = stands_[static_cast<std::size_t>(link)];
  if (!stands && !knowledge_.isUsable(stamp)) {
    const bool is_ahead = stamp > ros_;
    return noteTransform(link, stamp == 0  ? "its stamp is zero"
                               : ros_ == 0 ? NO_CLOCK
                               : is_ahead  ? "ahead of the clock"
                                           : "old when it arrived");
  }
  if (told.is_lied_about) return void(refusals_.erase(link));
  const bool is_alone =
      stands ? told.statics.size() == 1 : !knowledge_.isDisturbed(told, stamp, stamp);
  if (told.is_settled && is_alone) return noteTransform(link, std::nullopt);
  const bool is_open = stands && told.open_since && told.is_settled &&
                       !Knowledge::isSame(told.static_poses.back().second,
                                          last_[static_cast<std::size_t>(link)].second);
  if (is_open) return noteTransform(link, "on /tf_static");
  if (!told.is_settled && knowledge_.wasOnBoth(told) && (stands ? is_alone : is_new)) {
    return noteTransform(link, "both on /tf and on /tf_static");
  }
  refusals_.erase(link);
}

/// Transforms that were refused lately, and their reasons.
void SimulatedNode::judgeRefusals(const Snapshot& snapshot) {
  const std::vector<std::string> refused = monitor_.transforms().refused();
  for (const auto& [link, refusal] : refusals_) {
    const double age = steady_ - refusal.second;
    if (std::abs(age - REFUSAL_SHOWN) < 1e-6) continue;
    const std::string begin = "transform of '" + setup_.hungFrame(link) + "': ";
    const auto line = std::find_if(refused.begin(), refused.end(), [&](const std::string& each) {
      return each.rfind(begin, 0) == 0;
    });
    const bool is_there = line != refused.end();
    if (is_there != (age < REFUSAL_SHOWN)) {
      fail(begin + (is_there ? "nothing is wrong with it: " + *line : "it was refused"));
    }
    if (is_there && line->find(refusal.first) == std::string::npos) {
      fail("it is refused, but because '" + refusal.first + "': " + *line);
    }
  }
  const auto& reasons = snapshot.poses.unknown_because;
  for (std::size_t i = 0; i < refused.size() && !snapshot.first_left_out.empty(); ++i) {
    if (std::find(reasons.begin(), reasons.end(), "refused " + refused[i]) == reasons.end()) {
      fail("a reason is missing: " + refused[i]);
    }
  }
}

/// Who is named is who it was.
void SimulatedNode::judgeWords(const std::string& reason) {
  for (int link = -1; link < static_cast<int>(setup_.links.size()); ++link) {
    const bool has_none = reason.find("TF has no frame '" + linkName(link) + "'") != reason.npos;
    if (has_none && knowledge_.isNamed(link)) fail("it has one: " + reason);
  }
  const std::size_t end = reason.find(" both publish it"), middle = reason.find(" and '");
  if (end == reason.npos || middle > end) return;
  const std::string second = reason.substr(middle + 5, end - middle - 5);
  if (reason.find(second) < middle) fail("that is one node: " + reason);
}

/// What is said to be old is old, whose clock is said to stand stands, and so on.
void SimulatedNode::judgeReasons(const Snapshot& snapshot) {
  const double rounding = 0.02;  // s: ages are said with two digits
  bool is_of_cloud = false, is_clock_named = false, is_no_clock_named = false;
  for (const std::string& reason : snapshot.poses.unknown_because) {
    const auto says = [&](const char* words) { return reason.find(words) != std::string::npos; };
    const auto begins = [&](const char* words) { return reason.rfind(words, 0) == 0; };
    is_clock_named = is_clock_named || says("/clock stands still");
    is_no_clock_named = is_no_clock_named || reason == NO_CLOCK;
    if (says("/clock stands still") && !knowledge_.isClockSuspect()) fail("it runs: " + reason);
    if (reason == NO_CLOCK && ros_ > 0) fail("it was received: " + reason);
    if (says("the scene was replaced")) fail("it was not: " + reason);
    if (says("geometry that could not be read") && settings_.broken < 0)
      fail("it could: " + reason);
    is_of_cloud = is_of_cloud || begins("cloud '");
    if (reason.empty() || reason.back() == ' ') fail("a reason has no end: " + reason);
    judgeWords(reason);
    if (begins("refused ") && snapshot.first_left_out.empty()) fail("it matters not: " + reason);
    const bool is_of_frame = begins("link '") || begins("refused ");
    const bool is_of_rest = begins("use_sim_time") || begins("geometry") || begins("cloud '");
    if (!is_of_frame && !is_of_rest && reason != NO_CLOCK) fail("a strange reason: " + reason);
    if (is_of_frame && knowledge_.isPlain() &&
        (says("contradict") || says("ambiguous") || says("several nodes") ||
         says("form a cycle"))) {
      fail("nobody contradicts: " + reason);
    }
    for (int link = 0; link < static_cast<int>(setup_.links.size()); ++link) {
      if (reason.rfind("link '" + linkName(link) + "'", 0) != 0) continue;
      const bool is_uncertain = knowledge_.isLiedAbout(link) || knowledge_.isUnsettled(link);
      if (says("only /tf_static places it") && !knowledge_.isHeld(link) && !is_uncertain) {
        fail("it moves: " + reason);
      }
      // Seen from a link, it may be the transform of another one that is said to be old.
      if (says("and max_pose_age is") && !is_uncertain && setup_.fixed_frame < 0 &&
          !knowledge_.hasOldOn(link, setup_.max_pose_age - rounding)) {
        fail("it is young: " + reason);
      }
      const auto newest = newestStampOf(link, ros_);
      if (says("and max_transform_age is") && !is_uncertain &&
          !(newest &&
            seconds(knowledge_.newest() - *newest) > setup_.max_transform_age - rounding)) {
        fail("it is as new as others: " + reason);
      }
    }
  }
  if (is_of_cloud && snapshot.suspect_clouds.empty()) fail("a suspect cloud is not named");
  if (knowledge_.isClockSuspect() && !is_clock_named) fail("nothing is said of /clock");
  if (ros_ == 0 && !is_no_clock_named) fail("nothing is said of no /clock");
  judgeLeftOut(snapshot);
  if (report_.verdict != Verdict::COLLISION) {
    const std::string missing = missingName(*snapshot.scene->scene, report_);
    if (!missing.empty()) fail(missing);
  }
  judgeRefusals(snapshot);
}

/// Links without a pose are named, and no others.
void SimulatedNode::judgeLeftOut(const Snapshot& snapshot) {
  const auto& bodies = snapshot.scene->scene->bodies();
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const std::string begin = "link '" + bodies[i].link + "': ";
    const auto& reasons = snapshot.poses.unknown_because;
    const auto line = std::find_if(reasons.begin(), reasons.end(), [&](const std::string& reason) {
      return reason.rfind(begin, 0) == 0 && reason.size() > begin.size();
    });
    if ((line == reasons.end()) != static_cast<bool>(snapshot.poses.known[i])) {
      fail(begin + "its pose and the reasons do not agree");
    }
  }
  if (!isGeometryMissing()) return;
  const std::string broken = "geometry that could not be read: " + linkName(settings_.broken);
  const auto& reasons = snapshot.poses.unknown_because;
  if (std::find(reasons.begin(), reasons.end(), broken) == reasons.end()) {
    fail("a reason is missing: " + broken);
  }
}

/// What is suspect whatever the instant of the poses.
void SimulatedNode::requireSharedReasons(const Snapshot& cycle, const Snapshot& other,
                                         const std::string& whose) {
  // A joint that TF lacks at the request's stamp is at zero, which cannot age.
  const bool is_at_zero =
      other.joints->jointsFromTf().empty() && !other.joints->jointsAtZero().empty();
  for (const std::string& reason : cycle.poses.unknown_because) {
    const bool is_of_cloud = reason.rfind("cloud '", 0) == 0;
    const bool is_of_clock = reason.rfind("use_sim_time", 0) == 0;
    const auto& others = other.poses.unknown_because;
    const bool is_shared = std::find(others.begin(), others.end(), reason) != others.end();
    const bool can_age = whose == "the limiter" || (!cycle.is_static && !is_at_zero);
    const bool must_be = is_of_cloud || (is_of_clock && can_age);
    if (must_be && !is_shared) fail(whose + " does not know that " + reason);
  }
}

}  // namespace simulation
