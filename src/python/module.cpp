// The compiled half of the Python package collision_pairs. Arguments and results are described in
// collision_pairs/__init__.pyi.
#include <array>
#include <initializer_list>
#include <utility>

#include "bindings.h"
#include "check_result.h"
#include "collision_pairs/input_error.h"
#include "long_call.h"

namespace py = pybind11;

namespace collision_pairs {
namespace {

/// An enum.IntEnum, whose members compare with the numbers in arrays.
template <class Enum>
void addEnum(py::module& module, const char* name, const char* doc,
             std::initializer_list<std::pair<const char*, Enum>> members) {
  py::list items;
  for (const auto& [member, value] : members) {
    items.append(py::make_tuple(member, static_cast<int>(value)));
  }
  py::object made = py::module::import("enum").attr("IntEnum")(name, items);
  made.attr("__module__") = "collision_pairs";
  made.attr("__doc__") = doc;
  module.attr(name) = made;
}

/// The class Fidelity, which lives as long as the interpreter.
py::handle fidelity_enum;

}  // namespace

std::optional<Fidelity> fidelityMember(const py::handle& value) {
  if (!py::isinstance(value, fidelity_enum)) return {};
  return static_cast<Fidelity>(value.attr("value").cast<int>());
}

Fidelity fidelityFrom(const py::handle& value) {
  if (isStr(value)) return parseFidelity(utf8From(value));
  if (const auto member = fidelityMember(value)) return *member;
  throw py::type_error("fidelity is " + py::repr(value).cast<std::string>() +
                       ", but must be a name ('mesh') or a member of Fidelity");
}

void requireInitialised(const py::handle& value) {
  using namespace py::detail;
  PyTypeObject* const type = Py_TYPE(value.ptr());
  const auto bound = reinterpret_cast<PyTypeObject*>(get_internals().instance_base);
  if (PyType_IsSubtype(type, bound) == 0) return;
  for (const auto& held : values_and_holders(reinterpret_cast<instance*>(value.ptr()))) {
    if (held.holder_constructed()) continue;
    throw py::type_error(std::string("this ") + type->tp_name +
                         " has not been made: its __init__() was not called, or has not ended");
  }
}

}  // namespace collision_pairs

PYBIND11_MODULE(_native, module) {
  using namespace collision_pairs;
  module.attr("__name__") = "collision_pairs";  // where its classes are to be found
  static const py::exception<InputError> input_error(module, "InputError", PyExc_ValueError);
  py::register_exception_translator([](std::exception_ptr thrown) {
    try {
      if (thrown) std::rethrow_exception(thrown);
    } catch (const InputError& error) {
      PyErr_SetObject(input_error.ptr(), messageFrom(error.what()).ptr());
    }
  });
  addEnum<Verdict>(
      module, "Verdict", "The overall result of a check.",
      {{"FREE", Verdict::FREE}, {"COLLISION", Verdict::COLLISION}, {"UNKNOWN", Verdict::UNKNOWN}});
  addEnum<PairState>(module, "PairState", "State of a pair of links or objects.",
                     {{"NEAR", PairState::NEAR},
                      {"CONTACT", PairState::CONTACT},
                      {"UNRESOLVED", PairState::UNRESOLVED}});
  addEnum<DistanceWorth>(module, "Certainty", "How a distance relates to the true one.",
                         {{"EXACT", DistanceWorth::EXACT},
                          {"LOWER_BOUND", DistanceWorth::LOWER_BOUND},
                          {"DEPTH_BOUND", DistanceWorth::DEPTH_BOUND}});
  addEnum<Fidelity>(module, "Fidelity", "The geometry that decided.",
                    {{"AABB", Fidelity::AABB},
                     {"SPHERES", Fidelity::SPHERES},
                     {"OBB", Fidelity::OBB},
                     {"CONVEX", Fidelity::CONVEX},
                     {"MESH", Fidelity::MESH}});
  fidelity_enum = py::object(module.attr("Fidelity")).release();
  OthersMayRun::watchForks();
  bindRobot(module);
  bindObjects(module);
  bindScene(module);
  bindDetector(module);
  bindMotions(module);
}
