// Joint states as Python programs give them: names, and an array of numbers.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include <pybind11/numpy.h>

#include "collision_pairs/joint_columns.h"

namespace collision_pairs {

/// All that a state can set and that mimic no other.
std::vector<std::string> namesOfAllJoints(const RobotModel& robot);

/// The joints of a call, kept for the next one, which mostly names the same. Made, compared and
/// let go with the GIL.
struct NamedJoints {
  /// `joints`: a list of names, or None: all. Throws InputError as JointColumns does.
  NamedJoints(const pybind11::object& joints, const RobotModel& robot);

  /// By the same strings, which need not be read for that: they cannot change.
  bool areNamedBy(const pybind11::object& joints) const;

  /// Python's warning that joints are not named, if there are any.
  void warnOfOthers() const;

  const pybind11::tuple given;
  const bool is_all;
  const JointColumns columns;
  const std::vector<std::string> at_zero;  ///< moving joints that are not named
};

/// An array of shape (n, joints), or (joints,) for one state. Numbers of dtype float64 are read
/// where they lie, whatever the strides; float32, integers and lists are converted, in a copy.
/// What is written to the array meanwhile is read before or after; it cannot be resized.
class JointStatesArray {
 public:
  /// Throws InputError for another dtype or shape, or a mask.
  JointStatesArray(const pybind11::object& states, std::size_t nb_joints);

  /// One state was given, without the first dimension.
  bool isSingle() const { return single_; }
  std::size_t size() const { return size_; }
  /// Needs no GIL.
  void read(std::size_t i, std::vector<double>& state) const;

 private:
  pybind11::array array_;       // keeps the numbers
  pybind11::object no_resize_;  // a weak reference: NumPy resizes no array that has one
  const char* begin_ = nullptr;
  std::ptrdiff_t row_stride_ = 0, column_stride_ = 0;  // bytes
  std::size_t size_ = 1, nb_joints_;
  bool single_ = true;
};

}  // namespace collision_pairs
