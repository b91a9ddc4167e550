#include "joint_states.h"

#include <algorithm>
#include <cstring>

#include "bindings.h"
#include "collision_pairs/input_error.h"
#include "user_text.h"

namespace py = pybind11;

namespace collision_pairs {
namespace {

py::tuple itemsOf(const py::object& joints) {
  if (joints.is_none()) return py::tuple();
  const bool has_order = !isStr(joints) && PyAnySet_Check(joints.ptr()) == 0;
  if (has_order && py::isinstance<py::iterable>(joints)) return joints;
  throw InputError("joints must be a list of names");
}

std::vector<std::string> namesFrom(const py::tuple& items) {
  std::vector<std::string> names;
  for (const py::handle name : items) {
    if (!isStr(name)) throw InputError("joints must be a list of names");
    names.push_back(utf8From(name));
  }
  return names;
}

std::string shapeOf(const py::array& array) {
  return py::str(array.attr("shape")).cast<std::string>();
}

py::array float64From(const py::object& states) {
  if (isMasked(states)) {
    throw InputError("states are a masked array: masked entries have no position");
  }
  const py::array array = py::array::ensure(states);
  const char kind = array ? array.dtype().kind() : 'O';
  if (kind != 'f' && kind != 'i' && kind != 'u') {
    throw InputError("states are " +
                     (array ? "of dtype " + py::str(array.dtype()).cast<std::string>()
                            : std::string("no array")) +
                     ", but must be of float64 (float32 and integers are converted)");
  }
  if (py::isinstance<py::array_t<double>>(array)) return array;
  return array.attr("astype")("float64");
}

py::object ownerOf(const py::array& array) {
  py::object owner = array;
  while (py::isinstance<py::array>(owner.attr("base"))) owner = owner.attr("base");
  return owner;
}

}  // namespace

std::vector<std::string> namesOfAllJoints(const RobotModel& robot) {
  return JointColumns({}, robot).notNamed();
}

NamedJoints::NamedJoints(const py::object& joints, const RobotModel& robot)
    : given(itemsOf(joints)),
      is_all(joints.is_none()),
      columns(is_all ? namesOfAllJoints(robot) : namesFrom(given), robot),
      at_zero(columns.atZero()) {}

bool NamedJoints::areNamedBy(const py::object& joints) const {
  if (is_all || joints.is_none()) return is_all && joints.is_none();
  if (!PyList_Check(joints.ptr()) && !PyTuple_Check(joints.ptr())) return false;
  PyObject** const items = PySequence_Fast_ITEMS(joints.ptr());
  return std::equal(items, items + PySequence_Fast_GET_SIZE(joints.ptr()),
                    PySequence_Fast_ITEMS(given.ptr()),
                    PySequence_Fast_ITEMS(given.ptr()) + given.size());
}

void NamedJoints::warnOfOthers() const {
  if (at_zero.empty()) return;
  warn("joints that are not named are taken as zero, and a state is free only with them at zero: " +
       joined(at_zero));
}

// A handle: pybind11 2.6 takes an object for a weak reference to be copied.
JointStatesArray::JointStatesArray(const py::object& states, std::size_t nb_joints)
    : array_(float64From(states)),
      no_resize_(py::weakref(py::handle(ownerOf(array_)))),
      nb_joints_(nb_joints) {
  const py::ssize_t nb_dimensions = array_.ndim();
  const bool fits = (nb_dimensions == 1 || nb_dimensions == 2) &&
                    array_.shape(nb_dimensions - 1) == static_cast<py::ssize_t>(nb_joints);
  if (!fits) {
    const std::string n = std::to_string(nb_joints);
    throw InputError("states have shape " + shapeOf(array_) + ", but " + n +
                     " joints are named: (n, " + n + ") is expected, or (" + n +
                     ",) for one state");
  }
  begin_ = static_cast<const char*>(array_.data());
  column_stride_ = array_.strides(nb_dimensions - 1);
  single_ = nb_dimensions == 1;
  if (single_) return;
  size_ = static_cast<std::size_t>(array_.shape(0));
  row_stride_ = array_.strides(0);
}

void JointStatesArray::read(std::size_t i, std::vector<double>& state) const {
  state.resize(nb_joints_);
  const char* from = begin_ + static_cast<std::ptrdiff_t>(i) * row_stride_;
  for (double& number : state) {
    std::memcpy(&number, from, sizeof number);  // it need not be aligned
    from += column_stride_;
  }
}

}  // namespace collision_pairs
