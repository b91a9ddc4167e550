// The law of the velocity limiter: how much of a velocity command may pass.
#pragma once

#include <limits>
#include <string>
#include <vector>

#include "collision_pairs/collision_report.h"
#include "stopping_tube.h"

namespace collision_pairs {

struct LimiterSettings {
  /// Rad/s^2 or m/s^2, > 0, one per joint of the command: see RobotResponse.
  std::vector<double> deceleration;
  double reaction_time = 0.1;  ///< s, >= 0: see RobotResponse
  /// Seconds, > 0: if no command arrives for this long, zeros are passed, once. A command must be
  /// safe for as long: see RobotResponse::hold.
  double command_timeout = 0.2;
  double max_joint_state_age = 0.1;   ///< s: with older positions everything is stopped
  double stop_distance = 0.01;        ///< metres, >= 0, that are left when the robot stands
  double self_stop_distance = 0.002;  ///< the same between links: see NearPair::are_links
  /// Metres per second, >= 0, at which obstacles may approach: until the robot stands.
  double obstacle_speed = 0.0;
  /// 0 to 1: of a command that leads away from all that is near.
  double retreat_scale = 0.2;
  double ramp_up = 2.0;  ///< per second, > 0: the scale rises at most this fast; it falls at once
  double tracking_tolerance = 0.01;  ///< rad or m, > 0: see ResponseWatch
};

/// Two models that are near each other, or may come.
struct NearPair {
  std::string first, second;
  double distance = 0.0;  ///< metres, signed
  /// Of the distance by time, under the command asked about: m/s. NaN: unknown.
  double derivative = 0.0;
  bool is_robot = false;  ///< the robot carries both
  /// Two links of one robot that its joints move: their distance is known from joint positions
  /// alone. That of what is attached, and between two robots, is not.
  bool are_links = false;
};

/// Metres that pairs have to keep.
struct KeptDistances {
  double links = 0.0;   ///< NearPair::are_links
  double others = 0.0;  ///< all others
  double coming = 0.0;  ///< in addition, with anything that the robot does not carry
  double of(bool are_links, bool is_robot) const {
    return are_links ? links : others + (is_robot ? 0.0 : coming);
  }
  double of(const NearPair& pair) const { return of(pair.are_links, pair.is_robot); }
};

/// What the law asks about the robot's surroundings, for one state of the robot and the scene.
class Surroundings {
 public:
  virtual ~Surroundings() = default;

  struct Certificate {
    bool is_free = false;
    std::string first, second;  ///< else a pair that could not be certified, if it is one
    std::string why;            ///< else why not, in words
    bool are_links = false;     ///< of that pair: see NearPair
  };
  /// Whether no pair that the joints of the command move comes nearer than it has to keep anywhere
  /// in the tube. Each of `nearer` only has to keep its own distance, if that is less; if it is
  /// negative, it is not asked about.
  virtual Certificate certify(const StoppingTube& tube, const KeptDistances& kept,
                              const std::vector<NearPair>& nearer) = 0;

  /// Upper bound of how far a point of the robot can go anywhere in the tube, metres: two links may
  /// come nearer by twice as much.
  virtual double travel(const StoppingTube& tube) = 0;

  /// Whether the pair, which touches or nearly does, is nowhere nearer than now at several places
  /// along the tube.
  virtual bool leadsApart(const StoppingTube& tube, const NearPair& pair) = 0;

  /// Of two models, metres, signed. Infinite: more than `reach`; NaN: unknown.
  virtual double distance(const std::string& first, const std::string& second, double reach) = 0;

  /// All pairs that the direction moves relative to each other and that are no further apart than
  /// `reach`, nearest first. False, with the reason, if something is not known.
  virtual bool nearPairs(double reach, const std::vector<double>& direction,
                         std::vector<NearPair>& pairs, std::string& why) = 0;
};

struct LimiterInput {
  /// Seconds, as all times: when the command is published, at the latest; not before the last
  /// publication.
  double now = 0.0;
  double stamp = 0.0;          ///< of the oldest of the joint positions; <= now
  double obstacles_age = 0.0;  ///< seconds, >= 0: of the oldest information on what moves
  std::vector<double> command;
  /// Seconds, >= 0, by which each joint's position was measured after `stamp`; empty: all at once.
  std::vector<double> later = {};
};

struct LimiterDecision {
  std::vector<double> command;  ///< to be passed
  double scale = 0.0;
  /// FREE: the stopping path of what is passed is certified. COLLISION: the robot is in contact.
  Verdict verdict = Verdict::UNKNOWN;
  std::string first, second;  ///< the pair that limits; empty: none
  double distance = 0.0;      ///< its distance, metres, if known (see has_distance)
  bool has_distance = false;
  std::string reason;  ///< empty: the whole command passes
  /// Until then it may be published: LimiterInput::now. Zeros of stop(): at any time.
  double publish_by = std::numeric_limits<double>::infinity();
  std::vector<double> stopped;  ///< the command, if it is stopped for a pair; else empty
};

/// Passes a command at the largest scale, found with a few certificates, at which the robot's whole
/// stopping path is certified. Zeros are always passed: the certificate of what was published
/// before covers them. Keeps the commands that were published, and the scale; everything else is an
/// input. A decision changes nothing: it may come too late to be published.
class LimiterLaw {
 public:
  explicit LimiterLaw(const LimiterSettings& settings);

  /// What a command that passes leaves between things that stand still.
  KeptDistances needed() const;
  LimiterDecision decide(const LimiterInput& input, Surroundings& surroundings) const;
  /// Zeros, for a reason that the caller knows.
  LimiterDecision stop(const std::string& reason) const;

  /// This decision was published at `now`, not before the last one. Whoever publishes says so, and
  /// nobody else.
  void published(double now, const LimiterDecision& decision);

 private:
  struct Question;
  std::string whyRefused(const LimiterInput& input) const;
  bool isCertified(Question& question, double scale) const;
  double largestScale(Question& question, double most) const;
  double retreatScale(Question& question, double most) const;
  bool mayRetreat(Question& question, double scale, const std::vector<NearPair>& pairs) const;
  /// What is left when the robot stands, and `room` more: the one place that knows of the settings.
  KeptDistances kept(double room, double coming) const;
  StoppingTube tubeAt(const LimiterInput& input, double scale) const;
  double growth(const LimiterInput& input, const StoppingTube& tube) const;

  LimiterSettings settings_;
  PassedCommands passed_;
  double scale_ = 1.0, scale_time_ = 0.0;  // the last that was published, and for when
  std::vector<double> stopped_;            // by it: see LimiterDecision
  std::pair<std::string, std::string> stopped_for_;
};

}  // namespace collision_pairs
