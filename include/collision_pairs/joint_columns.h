// Joint states as users have them: some joints by name, and a number for each.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "collision_pairs/robot_model.h"

namespace collision_pairs {

/// Which number of a state moves which joint of a robot. Immutable; the robot must outlive it.
class JointColumns {
 public:
  /// What a joint follows: its position is multiplier * state[column] + offset. Mimics are followed
  /// to the joint that leads them.
  struct Source {
    int column = -1;  ///< -1: the joint is not named, nor is one that leads it
    double multiplier = 1.0;
    double offset = 0.0;
  };

  /// Throws InputError that names the joint for one that is unknown, named twice or without a
  /// position to set, or that mimics one that is not named.
  JointColumns(const std::vector<std::string>& names, const RobotModel& robot);

  std::size_t size() const { return joint_of_column_.size(); }
  /// By index in RobotModel::joints().
  const Source& sourceOf(int joint) const { return source_of_joint_[joint]; }

  /// `state`: size() numbers, rad or m. Throws InputError that names the joint for one that is not
  /// finite, or further than 1e-6 from what the joint that it mimics makes it.
  void check(const double* state) const;
  /// Overwrites those of all joints' `positions` that the state moves, mimics included; the others
  /// stay as they are. Throws as check() does.
  void apply(const double* state, std::vector<double>& positions) const;

  /// Moving joints that no number moves, by name: they stand where `positions` had them, in
  /// RobotModel::zeroPositions() at zero (or their nearer limit).
  std::vector<std::string> notNamed() const;

 private:
  Source followed(int joint, const std::vector<int>& column_of_joint) const;

  const RobotModel& robot_;
  std::vector<int> joint_of_column_;
  std::vector<Source> source_of_joint_;
};

}  // namespace collision_pairs
