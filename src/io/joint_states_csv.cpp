#include "joint_states_csv.h"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <utility>

#include "collision_pairs/input_error.h"
#include "csv.h"
#include "user_text.h"

namespace collision_pairs {
namespace {

constexpr double MIMIC_TOLERANCE = 1e-6;  // rad or m: precision of output with six decimals

bool isBlank(const std::string& line) { return line.find_first_not_of(" \t\r") == line.npos; }

class Reader {
 public:
  Reader(const RobotModel& robot, const std::string& name)
      : robot_(robot), name_(name), zero_(robot.zeroPositions()) {}

  JointStates read(const std::string& csv) {
    std::istringstream lines(csv);
    std::string line;
    std::size_t blank_line = 0, nb_further = 0;
    while (std::getline(lines, line)) {
      ++line_;
      if (isBlank(line)) {
        if (blank_line == 0) blank_line = line_;
        continue;
      }
      CsvRecord record;
      while (!record.addLine(line)) {
        if (!std::getline(lines, line)) fail("a quotation mark is not closed");
        ++nb_further;
      }
      if (joint_of_.empty()) {
        readHeader(record.fields());
        blank_line = 0;
      } else {
        if (blank_line) fail("a row after the blank line " + std::to_string(blank_line));
        readRow(record.fields());
      }
      line_ += std::exchange(nb_further, 0);
    }
    if (joint_of_.empty()) throw InputError(name_ + ": no header; it must name the joints");
    noteJointsAtZero();
    return std::move(states_);
  }

 private:
  [[noreturn]] void fail(const std::string& why) const {
    throw InputError(name_ + " line " + std::to_string(line_) + ": " + why);
  }

  void readHeader(const std::vector<std::string>& fields) {
    for (const std::string& field : fields) {
      const int joint = robot_.findJoint(field);
      if (joint < 0) fail("column '" + field + "' is not a joint of robot '" + robot_.name() + "'");
      if (robot_.joints()[joint].type == JointType::FIXED) {
        fail("joint '" + field + "' is fixed; remove its column");
      }
      if (!robot_.joints()[joint].hasPosition()) {
        fail("joint '" + field +
             "' is floating or planar and stays at identity; remove its column");
      }
      if (std::count(joint_of_.begin(), joint_of_.end(), joint)) {
        fail("a second column '" + field + "'");
      }
      joint_of_.push_back(joint);
    }
  }

  void readRow(const std::vector<std::string>& fields) {
    if (fields.size() != joint_of_.size()) {
      fail(std::to_string(fields.size()) + " fields, but the header has " +
           std::to_string(joint_of_.size()));
    }
    std::vector<double> given = zero_;
    for (std::size_t i = 0; i < fields.size(); ++i) {
      if (!parseNumber(fields[i], given[joint_of_[i]])) {
        fail("joint '" + robot_.joints()[joint_of_[i]].name + "': '" + fields[i] +
             "' is not a finite number");
      }
    }
    std::vector<double> positions = given;
    robot_.applyMimics(positions);
    for (const int joint : joint_of_) {
      if (std::abs(positions[joint] - given[joint]) > MIMIC_TOLERANCE) {
        fail("joint '" + robot_.joints()[joint].name + "' is " + std::to_string(given[joint]) +
             ", but by the joint it mimics it must be " + std::to_string(positions[joint]));
      }
    }
    states_.positions.push_back(std::move(positions));
  }

  void noteJointsAtZero() {
    for (std::size_t i = 0; i < robot_.joints().size(); ++i) {
      const Joint& joint = robot_.joints()[i];
      const bool given = std::count(joint_of_.begin(), joint_of_.end(), static_cast<int>(i)) > 0;
      if (joint.hasPosition() && !joint.mimic && !given) {
        states_.joints_at_zero.push_back(joint.name);
      }
    }
  }

  const RobotModel& robot_;
  const std::string& name_;
  const std::vector<double> zero_;
  std::vector<int> joint_of_;  // by column
  std::size_t line_ = 0;
  JointStates states_;
};

}  // namespace

JointStates readJointStates(const std::string& csv, const RobotModel& robot,
                            const std::string& name) {
  return Reader(robot, name).read(csv);
}

}  // namespace collision_pairs
