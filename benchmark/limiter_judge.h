// Judges by the exact check what a robot did among obstacles that may move by themselves.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "collision_pairs/collision_detector.h"

namespace collision_pairs {

/// What the robot itself did. An obstacle that moves may run into a robot that stands, so of its
/// distance only what the robot took away counts: between two checks, the difference that the
/// robot's motion makes with the obstacle where it is at the later one.
struct RobotsPart {
  /// With what does not move by itself: times that contact began. With an obstacle that moves: of
  /// these only the times in which the robot took away more than half of the last stop_distance,
  /// which is what the law permits to a retreat.
  int nb_contacts = 0;
  int nb_run_into = 0;    ///< times that contact with one that moves began otherwise
  int nb_moved_into = 0;  ///< of these: by the robot's motion since the check before
  /// Metres: the smallest distance to what does not move by itself, links apart, where the robot
  /// moves nearer. Looked for below 15 mm only; 1: there was none.
  double nearest = 1.0;
  double nearest_links = 1.0;  ///< the same between two links that joints move
  /// Metres: the most that the robot took away of a distance from stop_distance to contact with an
  /// obstacle that moves, without giving it back in between.
  double taken = 0.0;
  void add(const RobotsPart& other);
};

class LimiterJudge {
 public:
  /// Name of the robot whose box is the obstacle that moves, on the joints x, y, z.
  static constexpr const char* MOVER = "mover";

  LimiterJudge(std::shared_ptr<const CollisionScene> truth, std::vector<std::string> joints);

  /// Forgets the run before.
  void begin();

  /// Exact, of the pairs that the limited joints move; infinite beyond the alarm distance.
  double distanceAt(const std::vector<double>& q, const Eigen::Vector3d& mover,
                    double alarm_distance);

  /// What the robot did between two checks, with the obstacle where it is now: `before` is `now` of
  /// the last call. True if something touches.
  bool judge(const std::vector<double>& before, const std::vector<double>& now,
             const Eigen::Vector3d& mover, double stop_distance, RobotsPart& part);

  /// Metres that anything may come nearer after the last call without a contact or a new smallest
  /// distance.
  double room() const { return room_; }

 private:
  using Near = std::map<std::pair<std::uint32_t, std::uint32_t>, double>;
  Near nearPairs(const std::vector<double>& q, const Eigen::Vector3d& mover, double alarm_distance);
  bool isMoved(const PairReport& pair) const;
  bool areLinks(const std::pair<std::uint32_t, std::uint32_t>& models) const;
  bool isOfMover(std::uint32_t model) const;

  std::shared_ptr<const CollisionScene> truth_;
  std::vector<std::string> joints_;
  CollisionDetector detector_;
  std::vector<Eigen::Isometry3d> X_WB_;
  BodyPoses poses_;
  Near taken_;  ///< metres that the robot took away, of each obstacle that is too near
  Near were_;   ///< distances at the last check
  double room_ = 0.0;
};

}  // namespace collision_pairs
