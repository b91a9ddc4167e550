// The Python class Robot.
#include <algorithm>
#include <climits>
#include <limits>

#include <pybind11/stl.h>

#include "bindings.h"
#include "collision_pairs/input_error.h"
#include "scene_sources.h"
#include "user_text.h"

namespace py = pybind11;

namespace collision_pairs {
namespace {

PythonRobot makeRobot(const TextFrom& urdf, const py::object& srdf) {
  PythonRobot robot{robotFrom(urdf, warn), {}};
  if (!srdf.is_none()) robot.srdf = srdfFrom(xmlFrom(srdf, "srdf"), *robot.model, warn);
  return robot;
}

struct TextParameter {
  std::string key;               ///< resolved
  py::object text = py::none();  ///< None if there is none of that name
};

/// Searched for from the caller's namespace upwards.
TextParameter parameter(const std::string& name) {
  const py::module rospy = py::module::import("rospy");
  const py::object found = rospy.attr("search_param")(name);
  if (found.is_none()) return {};
  TextParameter made{found.cast<std::string>(), rospy.attr("get_param")(found)};
  if (!isStr(made.text)) throw InputError("parameter '" + made.key + "' is not text");
  return made;
}

/// An SRDF further up than the URDF is used only where it was named with its namespace.
PythonRobot robotFromParameters(const std::string& description, const std::string& semantic) {
  const TextParameter urdf = parameter(description);
  TextParameter srdf = parameter(semantic);
  if (urdf.text.is_none()) {
    throw InputError("parameter '" + description +
                     "' is not set, neither here nor in a namespace above");
  }
  const bool is_named = !semantic.empty() && semantic.front() == '/';
  if (!srdf.text.is_none() && !is_named && isOutsideNamespaceOf(urdf.key, srdf.key)) {
    warn("parameter '" + srdf.key + "' is not used: it may be of another robot than '" + urdf.key +
         "'; put it beside that, or give semantic='" + srdf.key + "'");
    srdf.text = py::none();
  }
  return makeRobot({"parameter '" + description + "'", utf8From(urdf.text)}, srdf.text);
}

void requireUtf8(const TextFrom& file) {
  try {
    py::bytes(file.content).attr("decode")("utf-8");
  } catch (const py::error_already_set& error) {
    if (!error.matches(PyExc_UnicodeDecodeError)) throw;
    const auto at = error.value().attr("start").cast<std::size_t>();
    const auto line = std::count(file.content.begin(), file.content.begin() + at, '\n') + 1;
    throw InputError(file.origin + " line " + std::to_string(line) +
                     ": it is not in UTF-8; convert it, for example with iconv -f latin1 -t utf-8");
  }
}

/// By index: the joints that a state can name and that follow no other.
std::vector<const Joint*> leadersOf(const RobotModel& model) {
  std::vector<const Joint*> joints;
  for (const Joint& joint : model.joints()) {
    if (joint.hasPosition() && !joint.mimic) joints.push_back(&joint);
  }
  return joints;
}

std::vector<std::string> jointNames(const PythonRobot& robot) {
  std::vector<std::string> names;
  for (const Joint* joint : leadersOf(*robot.model)) names.push_back(joint->name);
  return names;
}

py::array_t<double> limits(const PythonRobot& robot) {
  const auto joints = leadersOf(*robot.model);
  py::array_t<double> rows({static_cast<py::ssize_t>(joints.size()), py::ssize_t{2}});
  auto at = rows.mutable_unchecked<2>();
  for (py::ssize_t i = 0; i < rows.shape(0); ++i) {
    const Joint& joint = *joints[static_cast<std::size_t>(i)];
    const bool limited = joint.hasLimits() && (joint.lower != 0.0 || joint.upper != 0.0);
    at(i, 0) = limited ? joint.lower : -std::numeric_limits<double>::infinity();
    at(i, 1) = limited ? joint.upper : std::numeric_limits<double>::infinity();
  }
  return rows;
}

}  // namespace

std::string pathFrom(const py::handle& value, const std::string& what) {
  const std::string path = py::bytes(py::module::import("os").attr("fsencode")(value));
  if (path.empty()) throw InputError(what + " is empty");
  if (path.size() < PATH_MAX && path.find_first_of("<\n\r") == std::string::npos) return path;
  const bool is_bytes = py::isinstance<py::bytes>(value);
  const std::string begin = py::repr(py::bytes(path.substr(0, 20))).cast<std::string>();
  throw InputError(what + (is_bytes ? " is bytes that are" : " is a text that is") + " no path, " +
                   begin + " ...; give the path of a file, or " +
                   (is_bytes ? "decode() it to a str" : "what such a file says"));
}

TextFrom xmlFrom(const py::handle& value, const std::string& what) {
  if (isStr(value)) {
    const std::string text = utf8From(value);
    if (text.find('<') != std::string::npos) return {what, text};
  }
  const TextFrom file = textFromFile(pathFrom(value, what));
  requireUtf8(file);
  return file;
}

void warn(const std::string& message) {
  const py::object text = messageFrom(message);
  if (PyErr_WarnFormat(PyExc_UserWarning, 1, "%U", text.ptr()) < 0) throw py::error_already_set();
}

void bindRobot(py::module& module) {
  py::class_<PythonRobot>(module, "Robot",
                          "Links with their collision geometry, and the joints between them. "
                          "Immutable: can be shared by threads.")
      .def(py::init([](const py::object& urdf, const py::object& srdf) {
             return makeRobot(xmlFrom(urdf, "urdf"), srdf);
           }),
           py::arg("urdf"), py::arg("srdf") = py::none(),
           "Reads a URDF, and optionally an SRDF: each either XML text or the path of a file. "
           "Meshes are loaded by package:// and file:// URIs. Raises InputError, also for a mesh "
           "that cannot be "
           "used.")
      .def_static(
          "from_urdf",
          [](const std::string& urdf_text) {
            return makeRobot({"urdf", urdf_text}, py::none());
          },
          py::arg("urdf_text"), "Reads the XML text of a URDF.")
      .def_static(
          "from_parameters", &robotFromParameters, py::arg("description") = "robot_description",
          py::arg("semantic") = "robot_description_semantic",
          "Reads the ROS parameters of these names, searched for by rospy from the caller's "
          "namespace upwards. The second is optional.")
      .def_property_readonly(
          "name", [](const PythonRobot& robot) { return robot.model->name(); }, "Name in the URDF.")
      .def_property_readonly("joints", &jointNames,
                             "Names of the joints of a state: revolute, continuous and "
                             "prismatic joints that are not mimic joints.")
      .def_property_readonly("limits", &limits,
                             "float64 (len(joints), 2): lower and upper limit, rad or m; infinite "
                             "without a limit.")
      .def_property_readonly(
          "links", [](const PythonRobot& robot) { return namesOf(robot.model->links()); },
          "Names of all links.")
      .def("__repr__", [](const PythonRobot& robot) {
        return "<Robot '" + robot.model->name() + "', " +
               std::to_string(robot.model->links().size()) + " links, " +
               std::to_string(leadersOf(*robot.model).size()) + " joints>";
      });
}

}  // namespace collision_pairs
