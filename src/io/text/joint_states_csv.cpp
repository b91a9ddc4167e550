#include "joint_states_csv.h"

#include <algorithm>
#include <optional>
#include <sstream>
#include <utility>

#include "collision_pairs/input_error.h"
#include "collision_pairs/joint_columns.h"
#include "csv.h"
#include "user_text.h"

namespace collision_pairs {
namespace {

bool isBlank(const std::string& line) { return line.find_first_not_of(" \t\r") == line.npos; }

class TableReader {
 public:
  TableReader(const RobotModel& robot, const std::string& name)
      : robot_(robot),
        name_(name),
        is_rigid_(std::none_of(robot.joints().begin(), robot.joints().end(),
                               [](const Joint& joint) { return joint.hasPosition(); })),
        zero_(robot.zeroPositions()) {}

  JointStates read(const std::string& csv) {
    std::istringstream lines(csv);
    std::string line;
    std::size_t blank_line = 0, nb_further = 0;
    while (std::getline(lines, line)) {
      ++line_;
      if (isBlank(line) && is_rigid_) {
        columns_ ? readRow({}) : readHeader({});
        continue;
      }
      if (isBlank(line)) {
        if (blank_line == 0) blank_line = line_;
        continue;
      }
      CsvRecord record;
      while (!record.addLine(line)) {
        if (!std::getline(lines, line)) fail("a quotation mark is not closed");
        ++nb_further;
      }
      if (!columns_) {
        readHeader(record.fields());
        blank_line = 0;
      } else {
        if (blank_line) fail("a row after the blank line " + std::to_string(blank_line));
        readRow(record.fields());
      }
      line_ += std::exchange(nb_further, 0);
    }
    if (!columns_) throw InputError(name_ + ": no header; it must name the joints");
    return std::move(states_);
  }

 private:
  [[noreturn]] void fail(const std::string& why) const {
    throw InputError(name_ + " line " + std::to_string(line_) + ": " + why);
  }
  /// An error of `work` is that of the line.
  template <class Work>
  void withLine(const Work& work) const {
    try {
      work();
    } catch (const InputError& error) {
      fail(error.what());
    }
  }

  void readHeader(const std::vector<std::string>& fields) {
    withLine([&] { columns_.emplace(fields, robot_); });
    names_ = fields;
    states_.joints_at_zero = columns_->atZero();
    for (const std::string& name : columns_->notNamed()) {
      if (!robot_.joints()[robot_.findJoint(name)].leader_missing) continue;
      fail("joint '" + name + "' needs a column: the joint that it mimics does not exist");
    }
  }

  void readRow(const std::vector<std::string>& fields) {
    if (fields.size() != names_.size()) {
      fail(std::to_string(fields.size()) + " fields, but the header has " +
           std::to_string(names_.size()));
    }
    std::vector<double> state(fields.size());
    for (std::size_t i = 0; i < fields.size(); ++i) {
      if (parseNumber(fields[i], state[i])) continue;
      fail("joint '" + names_[i] + "': '" + fields[i] + "' is not a finite number");
    }
    states_.positions.push_back(zero_);
    withLine([&] { columns_->apply(state.data(), states_.positions.back()); });
  }

  const RobotModel& robot_;
  const std::string& name_;
  const bool is_rigid_;  // no joint has a position
  const std::vector<double> zero_;
  std::optional<JointColumns> columns_;
  std::vector<std::string> names_;  // of the columns
  std::size_t line_ = 0;
  JointStates states_;
};

}  // namespace

JointStates readJointStates(const std::string& csv, const RobotModel& robot,
                            const std::string& name) {
  return TableReader(robot, name).read(csv);
}

}  // namespace collision_pairs
