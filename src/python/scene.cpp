// The Python class Scene.
#include <pybind11/stl.h>
#include <yaml-cpp/yaml.h>

#include "bindings.h"
#include "collision_pairs/input_error.h"
#include "long_call.h"
#include "scene_sources.h"
#include "user_text.h"

namespace py = pybind11;

namespace collision_pairs {
namespace {

/// A setting is three deep. Py_EnterRecursiveCall() allows more calls in Python 3.13 than the stack
/// has room for.
constexpr int MAX_NESTING = 100;

/// It counts as a number to Python.
bool isNumpyBool(const py::handle& value) {
  return py::hasattr(value, "dtype") && !py::hasattr(value, "__len__") &&
         py::str(value.attr("dtype")).cast<std::string>() == "bool";
}

/// From dicts, lists, numbers and strings. Throws InputError that names what is none of these.
YAML::Node yamlFrom(const py::handle& value, int depth = 0) {
  if (depth > MAX_NESTING) {
    throw InputError("settings: nesting of more than " + std::to_string(MAX_NESTING) + " levels");
  }
  if (value.is_none()) return YAML::Node(YAML::NodeType::Null);
  if (isStr(value)) return YAML::Node(utf8From(value));
  if (const auto fidelity = fidelityMember(value)) return YAML::Node(fidelityName(*fidelity));
  if (py::isinstance<py::bool_>(value) || isNumpyBool(value)) {
    return YAML::Node(value.cast<bool>());
  }
  if (py::isinstance<py::dict>(value)) {
    YAML::Node map(YAML::NodeType::Map);
    for (const auto& [key, entry] : py::reinterpret_borrow<py::dict>(value)) {
      map[utf8From(py::str(key))] = yamlFrom(entry, depth + 1);
    }
    return map;
  }
  if (py::isinstance<py::list>(value) || py::isinstance<py::tuple>(value)) {
    YAML::Node list(YAML::NodeType::Sequence);
    for (const py::handle entry : value) list.push_back(yamlFrom(entry, depth + 1));
    return list;
  }
  if (PyNumber_Check(value.ptr()) && !py::hasattr(value, "__len__")) {
    const double number = PyFloat_AsDouble(value.ptr());
    if (number == -1.0 && PyErr_Occurred() != nullptr) throw py::error_already_set();
    // Of a float of Python's own: NumPy 2 writes np.float64(1.0).
    return YAML::Node(py::repr(py::float_(number)).cast<std::string>());
  }
  throw InputError("settings: " + py::repr(value).cast<std::string>() +
                   " is not a number, text, list or map");
}

/// None, a map, or the path of a YAML file.
SceneConfig settingsFrom(const py::object& settings) {
  if (settings.is_none()) return {};
  if (py::isinstance<py::dict>(settings)) return readSceneSettings(yamlFrom(settings), "settings");
  return readSceneConfigFile(pathFrom(settings, "settings"));
}

/// Prepares the scene of `made.description` and `made.floor`.
PythonScene built(PythonScene made) {
  SceneDescription description = made.description;
  if (made.floor) description.objects.push_back(*made.floor);
  {
    const OthersMayRun others_may_run;
    const std::lock_guard<std::mutex> lock(made.cache->mutex);
    made.scene = CollisionScene::build(description, &made.cache->of_scenes);
  }
  const std::string& unchecked = made.scene->unchecked();
  const bool may_be_free = made.scene->mayBeFree();
  if (made.scene->models().empty() && !description.restriction.empty() && !may_be_free) {
    throw InputError("group and links leave no pair to check");
  }
  if (!unchecked.empty()) {
    warn(unchecked + (may_be_free ? ": what is FREE is so because allow_empty_scene permits it"
                                  : ": nothing is FREE; if that is meant, permit it by "
                                    "settings={'allow_empty_scene': True}"));
  }
  const auto open_meshes = made.scene->openMeshes();
  if (!open_meshes.empty()) warn(joined(open_meshes, "; "));
  py::list names;
  for (const CollisionModel& model : made.scene->models()) names.append(model.name);
  made.model_names = py::module::import("numpy").attr("array")(names, py::arg("dtype") = "str");
  made.model_names.attr("setflags")(py::arg("write") = false);
  return made;
}

PythonScene sceneFrom(const PythonRobot& robot, const py::object& srdf, const PythonRobot* world,
                      std::vector<RigidObject> objects, const py::object& settings) {
  PythonScene scene;
  scene.cache = std::make_shared<PythonScene::Cache>();
  SceneRobot described{robot.model, robot.srdf, ""};
  if (!srdf.is_none()) described.srdf = srdfFrom(xmlFrom(srdf, "srdf"), *robot.model, warn);
  scene.description.robots.push_back(std::move(described));
  if (world != nullptr) scene.description.world = world->model;
  scene.description.objects = std::move(objects);
  const SceneConfig config = settingsFrom(settings);
  const std::string warning = warningOfIgnored(config, {}, world != nullptr);
  if (!warning.empty()) warn("settings: " + warning);
  scene.description.settings = config.settings;
  scene.description.restriction = config.restriction;
  scene.floor = config.floor;
  return built(std::move(scene));
}

PythonScene withObjects(const PythonScene& scene, std::vector<RigidObject> objects) {
  PythonScene other = scene;
  other.description.objects = std::move(objects);
  return built(std::move(other));
}

}  // namespace

void bindScene(py::module& module) {
  py::class_<PythonScene>(module, "Scene",
                          "The models and pairs to be checked. Immutable: can be shared by "
                          "threads and detectors.")
      .def(py::init(&sceneFrom), py::arg("robot"), py::arg("srdf") = py::none(),
           py::arg("world") = py::none(), py::arg("objects") = std::vector<RigidObject>(),
           py::arg("settings") = py::none(),
           "srdf: XML or path, in place of the robot's (None: the robot's; without an SRDF, "
           "adjacent links are not checked). world: a static Robot with its root at the "
           "robot's root link. settings: the node's parameters as a dict, or the path of such a "
           "YAML file; those that do not concern the scene are ignored. Raises InputError. "
           "Preparing meshes takes most of the time; other threads run meanwhile.")
      .def("with_objects", &withObjects, py::arg("objects"),
           "The same scene with other objects; meshes are not prepared again.")
      .def_property_readonly(
          "models", [](const PythonScene& scene) { return scene.model_names; },
          "str (m,): the links and objects that are in some pair, sorted. Results refer to them "
          "by index.")
      .def_property_readonly(
          "objects", [](const PythonScene& scene) { return scene.description.objects; },
          "The objects of the scene.")
      .def("__repr__", [](const PythonScene& scene) {
        return "<Scene of '" + scene.scene->robot().name() + "', " +
               std::to_string(scene.scene->models().size()) + " links and objects in pairs>";
      });
}

}  // namespace collision_pairs
