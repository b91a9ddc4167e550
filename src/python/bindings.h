// The parts of the Python module, each bound by a file of its own, and what they share: what its
// classes hold, and values as Python programs give them.
#pragma once

#include <memory>
#include <mutex>
#include <optional>
#include <string>

#include <pybind11/numpy.h>

#include "collision_pairs/collision_scene.h"
#include "collision_pairs/robot_model.h"
#include "collision_pairs/srdf.h"

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

/// Of a str. Raises UnicodeEncodeError for one that is no Unicode text (lone surrogates).
inline std::string utf8From(const pybind11::handle& str) {
  return pybind11::bytes(str.attr("encode")());
}

/// A text and what it came from, for messages.
struct TextFrom {
  std::string origin, content;
};

/// A str with a '<' in it is the XML itself, any other str or an os.PathLike the path of a file.
/// `what`: "urdf", its origin if it is the text. Throws InputError, or TypeError for anything else.
TextFrom xmlFrom(const pybind11::handle& value, const std::string& what);

/// Warns of links that the robot does not have. Throws InputError that names the origin.
Srdf srdfFrom(const TextFrom& xml, const RobotModel& robot);

/// Python's warnings.warn(message).
void warn(const std::string& message);

}  // namespace collision_pairs
