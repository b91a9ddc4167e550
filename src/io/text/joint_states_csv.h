// Recorded joint states: a header of joint names, one row per state.
#pragma once

#include <string>
#include <vector>

#include "collision_pairs/robot_model.h"

namespace collision_pairs {

struct JointStates {
  /// One row per state: RobotModel::joints() long, mimics applied.
  std::vector<std::vector<double>> positions;
  /// Moving joints without a column, taken as zero (or their nearest limit).
  std::vector<std::string> joints_at_zero;
};

/// Columns may come in any order; a column of a mimic joint is accepted if it agrees with its
/// leader to 1e-6. Quotation marks as in RFC 4180, Windows line ends, a byte order mark
/// and blank lines at the end are accepted. Of a robot without a joint that has a position the
/// header and each row are blank lines. Throws InputError with the line (and `name` of the file)
/// for what JointColumns refuses, for a mimic joint without a leader and a column, and for a field
/// that is missing, too many, or not a finite number.
JointStates readJointStates(const std::string& csv, const RobotModel& robot,
                            const std::string& name);

}  // namespace collision_pairs
