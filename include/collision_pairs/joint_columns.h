// Joint states as users provide them: names of some joints, and a number for each.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "collision_pairs/robot_model.h"

namespace collision_pairs {

/// Maps the numbers of a state to the joints of a robot. Immutable; the robot must outlive it.
class JointColumns {
 public:
  /// Source of a joint's position: multiplier * state[column] + offset. Chains of mimic joints are
  /// resolved to their leader.
  struct Source {
    int column = -1;  ///< -1: neither the joint nor its leader is named
    double multiplier = 1.0;
    double offset = 0.0;
  };

  /// Throws InputError, with its name, for a joint that is unknown, named twice or has no position,
  /// or that mimics one that is not named.
  JointColumns(const std::vector<std::string>& names, const RobotModel& robot);

  std::size_t size() const { return joint_of_column_.size(); }
  /// Index in RobotModel::joints() of the joint that is named for a column.
  int jointOf(std::size_t column) const { return joint_of_column_[column]; }
  /// joint: index in RobotModel::joints().
  const Source& sourceOf(int joint) const { return source_of_joint_[joint]; }

  /// `state`: size() numbers, rad or m. Throws InputError, with the joint's name, for a number that
  /// is not finite, an angle beyond 1e6 rad, or one that differs by more than 1e-6 from the value
  /// that its mimic leader implies.
  void check(const double* state) const;
  /// Overwrites the entries of `positions` (one per joint of the robot) that the state determines,
  /// including mimic joints, and keeps the others. Throws as check() does.
  void apply(const double* state, std::vector<double>& positions) const;

  /// Names of moving joints that no number determines: apply() leaves them unchanged, for example
  /// as in RobotModel::unnamedPositions().
  std::vector<std::string> notNamed() const;

  /// Those of them that are then at zero (or their nearest limit), and floating and planar joints,
  /// which no number can set.
  std::vector<std::string> atZero() const;

 private:
  Source followed(int joint, const std::vector<int>& column_of_joint) const;

  const RobotModel& robot_;
  std::vector<int> joint_of_column_;
  std::vector<Source> source_of_joint_;
};

}  // namespace collision_pairs
