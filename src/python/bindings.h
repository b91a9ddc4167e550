// The parts of the Python module, each bound by a file of its own, and what they share: what its
// classes hold, and values as Python programs give them.
#pragma once

#include <algorithm>
#include <memory>
#include <mutex>
#include <optional>
#include <string>

#include <pybind11/numpy.h>

#include "collision_pairs/collision_scene.h"
#include "collision_pairs/fidelity.h"
#include "collision_pairs/robot_model.h"
#include "collision_pairs/srdf.h"
#include "text_files.h"

namespace collision_pairs {

void bindRobot(pybind11::module& module);
void bindObjects(pybind11::module& module);
void bindScene(pybind11::module& module);
void bindDetector(pybind11::module& module);
void bindMotions(pybind11::module& module);

/// Robot.
struct PythonRobot {
  std::shared_ptr<const RobotModel> model;
  std::optional<Srdf> srdf;
};

/// Scene: immutable, but for the cache that it shares with the scenes made from it.
struct PythonScene {
  struct Cache {
    std::mutex mutex;
    SceneCache of_scenes;
  };
  std::shared_ptr<Cache> cache;
  SceneDescription description;  ///< without the floor
  std::optional<RigidObject> floor;
  std::shared_ptr<const CollisionScene> scene;
  pybind11::array model_names;  ///< str (models,)
};

/// pybind11 before 2.7 takes bytes for a str.
inline bool isStr(const pybind11::handle& value) { return PyUnicode_Check(value.ptr()) != 0; }

/// Whether numpy would drop a mask of it, or of something in a list: then numbers stand that are
/// none. pandas has a method `mask`, which is not one. Deeper lists have a shape that is refused.
inline bool isMasked(const pybind11::handle& value, int depth = 3) {
  if (PyFloat_CheckExact(value.ptr())) return false;
  if (pybind11::hasattr(value, "mask")) {
    return pybind11::isinstance(value, pybind11::module_::import("numpy.ma").attr("MaskedArray"));
  }
  const bool has_items = PyList_Check(value.ptr()) || PyTuple_Check(value.ptr());
  if (!has_items || depth == 0) return false;
  const auto items = pybind11::reinterpret_borrow<pybind11::sequence>(value);
  return std::any_of(items.begin(), items.end(),
                     [&](const pybind11::handle& item) { return isMasked(item, depth - 1); });
}

/// Of a str. Raises UnicodeEncodeError for one that is no Unicode text (lone surrogates).
inline std::string utf8From(const pybind11::handle& str) {
  return pybind11::bytes(str.attr("encode")());
}

/// A message as a str: bytes that are not UTF-8 are written as \xff.
inline pybind11::object messageFrom(const std::string& text) {
  return pybind11::reinterpret_steal<pybind11::object>(PyUnicode_DecodeUTF8(
      text.data(), static_cast<pybind11::ssize_t>(text.size()), "backslashreplace"));
}

/// Of a str or an os.PathLike. Throws InputError, which shows no more of it than its beginning, for
/// a text that is longer than a path or has a line break or a '<' in it; TypeError for anything
/// else.
std::string pathFrom(const pybind11::handle& value, const std::string& what);

/// A str with a '<' in it is the XML itself, anything else a path. `what`: "urdf", its origin if it
/// is the text. Throws as pathFrom(), and InputError for a file that is not UTF-8, since every name
/// in it may become a str.
TextFrom xmlFrom(const pybind11::handle& value, const std::string& what);

/// Python's warnings.warn(message).
void warn(const std::string& message);

/// Of a member of the module's Fidelity.
std::optional<Fidelity> fidelityMember(const pybind11::handle& value);

/// Of such a member or a name. Throws InputError for another name, TypeError for anything else.
Fidelity fidelityFrom(const pybind11::handle& value);

/// Throws TypeError for an object of this module whose __init__() has not ended: by __new__()
/// alone, or before super().__init__(). pybind11 would pass memory that nothing was written to.
void requireInitialised(const pybind11::handle& value);

/// How each class of this module comes from Python.
template <class Bound>
class InitialisedCaster : public pybind11::detail::type_caster_base<Bound> {
 public:
  bool load(const pybind11::handle& given, bool convert) {
    requireInitialised(given);
    return pybind11::detail::type_caster_base<Bound>::load(given, convert);
  }
};

}  // namespace collision_pairs

/// At global scope, before anything takes or gives a Bound.
#define COLLISION_PAIRS_BIND(Bound)                                               \
  namespace pybind11::detail {                                                    \
  template <>                                                                     \
  class type_caster<Bound> : public collision_pairs::InitialisedCaster<Bound> {}; \
  }

COLLISION_PAIRS_BIND(collision_pairs::PythonRobot)
COLLISION_PAIRS_BIND(collision_pairs::PythonScene)
COLLISION_PAIRS_BIND(collision_pairs::RigidObject)
