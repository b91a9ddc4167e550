// Shapes, and the objects made of them.
#include <limits>
#include <stdexcept>

#include <pybind11/eigen.h>
#include <pybind11/stl.h>

#include "bindings.h"
#include "collision_pairs/input_error.h"
#include "collision_pairs/mesh_loader.h"
#include "collision_pairs/scene_description.h"

COLLISION_PAIRS_BIND(collision_pairs::Box)
COLLISION_PAIRS_BIND(collision_pairs::Sphere)
COLLISION_PAIRS_BIND(collision_pairs::Cylinder)
COLLISION_PAIRS_BIND(collision_pairs::Capsule)
COLLISION_PAIRS_BIND(collision_pairs::HalfSpace)
COLLISION_PAIRS_BIND(collision_pairs::Convex)
COLLISION_PAIRS_BIND(collision_pairs::Mesh)

namespace py = pybind11;

namespace collision_pairs {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;

constexpr double RIGID = 1e-3;  // largest entry of R^T R - I that rounding may leave

/// Throws InputError for a size or a vertex that is none.
template <class T>
T valid(const T& shape) {
  try {
    validateShape(shape);
  } catch (const std::invalid_argument& error) {
    throw InputError(error.what());
  }
  return shape;
}

using Numbers = py::array_t<double, py::array::c_style | py::array::forcecast>;

/// A list counts as an array. Null if these are no real numbers (of truth values, indices would be
/// 0 and 1), or some are masked.
Numbers numbersFrom(const py::handle& value) {
  const py::array array = py::array::ensure(value);
  const bool are_numbers =
      array && std::string("fiuO").find(array.dtype().kind()) != std::string::npos;
  if (!are_numbers || isMasked(value)) return py::reinterpret_steal<Numbers>(nullptr);
  return Numbers::ensure(array);
}

Vector3d vectorFrom(const py::object& value, const std::string& what) {
  const Numbers numbers = numbersFrom(value);
  if (!numbers || numbers.ndim() != 1 || numbers.shape(0) != 3) {
    throw InputError(what + " must be an array of shape (3,)");
  }
  return Eigen::Map<const Vector3d>(numbers.data());
}

Mesh meshFromFile(const std::string& uri, const py::object& scale) {
  const Vector3d factors = scale.is_none() ? Vector3d::Ones() : vectorFrom(scale, "scale");
  if (!factors.allFinite() || (factors.array() == 0.0).any()) {
    throw InputError("scale has a factor that is 0 or not finite");
  }
  return valid(Mesh{makeMeshLoader()(uri, factors)});
}

Numbers rowsOfThree(const py::object& value, const std::string& what) {
  const Numbers numbers = numbersFrom(value);
  if (!numbers || numbers.ndim() != 2 || numbers.shape(1) != 3) {
    throw InputError(what + " must be an array of shape (n, 3)");
  }
  return numbers;
}

std::shared_ptr<TriangleMesh> verticesFrom(const py::object& vertices) {
  auto mesh = std::make_shared<TriangleMesh>();
  mesh->name = "mesh of an array";
  const Numbers array = rowsOfThree(vertices, "vertices");
  const auto p = array.unchecked<2>();
  for (py::ssize_t i = 0; i < p.shape(0); ++i) {
    mesh->vertices.emplace_back(p(i, 0), p(i, 1), p(i, 2));
  }
  return mesh;
}

Mesh meshFrom(const py::object& vertices, const py::object& triangles) {
  const auto mesh = verticesFrom(vertices);
  const Numbers array = rowsOfThree(triangles, "triangles");
  const auto t = array.unchecked<2>();
  for (py::ssize_t i = 0; i < t.shape(0); ++i) {
    std::array<std::uint32_t, 3> triangle;
    for (py::ssize_t j = 0; j < 3; ++j) {
      const double index = t(i, j);
      if (!(index >= 0.0 && index <= std::numeric_limits<std::uint32_t>::max()) ||
          index != std::floor(index)) {
        throw InputError("triangles[" + std::to_string(i) + "] has an invalid index");
      }
      triangle[static_cast<std::size_t>(j)] = static_cast<std::uint32_t>(index);
    }
    mesh->triangles.push_back(triangle);
  }
  return valid(Mesh{mesh});
}

/// From a (4, 4) array, a homogeneous transform. Throws InputError that names `what`.
Isometry3d poseFrom(const py::handle& value, const std::string& what) {
  const Numbers array = numbersFrom(value);
  if (!array || array.ndim() != 2 || array.shape(0) != 4 || array.shape(1) != 4) {
    throw InputError(what + " must be an array of shape (4, 4): a homogeneous transform");
  }
  const Eigen::Matrix4d matrix =
      Eigen::Map<const Eigen::Matrix<double, 4, 4, Eigen::RowMajor>>(array.data());
  const Eigen::Matrix3d R = matrix.topLeftCorner<3, 3>();
  const bool is_rigid =
      matrix.allFinite() && R.determinant() > 0.0 &&
      (R.transpose() * R - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff() <= RIGID &&
      matrix.row(3) == Eigen::RowVector4d(0.0, 0.0, 0.0, 1.0);
  if (!is_rigid) {
    throw InputError(
        what + " is not a pose: it needs a rotation, finite metres, and 0 0 0 1 in the last row");
  }
  Isometry3d X = Isometry3d::Identity();
  X.linear() = Eigen::Quaterniond(R).normalized().toRotationMatrix();
  X.translation() = matrix.topRightCorner<3, 1>();
  return X;
}

RigidObject objectFrom(std::string name, const std::vector<Shape>& shapes, const py::object& poses,
                       const py::object& pose, std::string attached_link,
                       std::vector<std::string> touch_links, double padding) {
  const std::string what = "object '" + name + "': ";
  if (name.empty()) throw InputError("an object has no name");
  RigidObject object;
  for (const Shape& shape : shapes) object.elements.push_back({shape, Isometry3d::Identity()});
  if (!poses.is_none()) {
    if (py::len(poses) != shapes.size()) {
      throw InputError(what + std::to_string(shapes.size()) + " shapes, but " +
                       std::to_string(py::len(poses)) + " poses; give one each, or None");
    }
    std::size_t i = 0;
    for (const py::handle each : poses) {
      object.elements[i].X_LE = poseFrom(each, what + "poses[" + std::to_string(i) + "]");
      ++i;
    }
  }
  if (!pose.is_none()) object.X_PO = poseFrom(pose, what + "pose");
  if (!(padding >= 0.0) || !std::isfinite(padding)) {
    throw InputError(what + "padding is " + std::to_string(padding) +
                     ", but must be 0 or more metres");
  }
  object.name = std::move(name);
  object.attached_link = std::move(attached_link);
  object.touch_links = std::move(touch_links);
  object.padding = padding;
  return object;
}

void bindShapes(py::module& module) {
  py::class_<Box>(module, "Box", "Centred at its origin.")
      .def(py::init([](const py::object& size) { return valid(Box{vectorFrom(size, "size")}); }),
           py::arg("size"), "size: full edge lengths, float64 (3,), m.");
  py::class_<Sphere>(module, "Sphere", "Centred at its origin.")
      .def(py::init([](double radius) { return valid(Sphere{radius}); }), py::arg("radius"),
           "radius: m.");
  py::class_<Cylinder>(module, "Cylinder", "Along z, centred at its origin, with flat ends.")
      .def(py::init([](double radius, double length) {
             return valid(Cylinder{radius, length});
           }),
           py::arg("radius"), py::arg("length"), "radius, length: m.");
  py::class_<Capsule>(module, "Capsule",
                      "All points within radius of a segment along z, centred at its origin.")
      .def(py::init([](double radius, double length) {
             return valid(Capsule{radius, length});
           }),
           py::arg("radius"), py::arg("length"),
           "radius, length: m; its total height is length + 2 radius.");
  py::class_<HalfSpace>(module, "HalfSpace", "All points with z <= 0: a floor. Unbounded.")
      .def(py::init([] { return HalfSpace{}; }));
  py::class_<Convex>(module, "Convex", "The convex hull of points.")
      .def(py::init(
               [](const py::object& vertices) { return valid(Convex{verticesFrom(vertices)}); }),
           py::arg("vertices"), "vertices: float64 (n, 3), m.");
  py::class_<Mesh>(module, "Mesh", "The solid bounded by triangles.")
      .def(py::init(&meshFrom), py::arg("vertices"), py::arg("triangles"),
           "vertices: float64 (n, 3), m; triangles: indices of vertices, integers (m, 3).")
      .def_static("from_uri", &meshFromFile, py::arg("uri"), py::arg("scale") = py::none(),
                  "From a file: package:// or file://, as in a URDF. scale: float64 (3,), per axis "
                  "(None: 1).");
}

}  // namespace

void bindObjects(py::module& module) {
  bindShapes(module);
  py::class_<RigidObject>(module, "RigidObject",
                          "A body that is not a link: static, or attached to a link.")
      .def(py::init(&objectFrom), py::arg("name"), py::arg("shapes"), py::arg("poses") = py::none(),
           py::arg("pose") = py::none(), py::arg("attached_link") = "",
           py::arg("touch_links") = std::vector<std::string>(), py::arg("padding") = 0.0,
           "shapes: solids fixed to each other; poses: float64 (n, 4, 4), of the shapes in the "
           "object's frame (None: at its origin). pose: float64 (4, 4), of the object in the root "
           "link's frame, or in that of attached_link (None: identity). touch_links: links and "
           "objects that it is not checked against. padding: m, distance to keep.")
      .def_readonly("name", &RigidObject::name)
      .def_readonly("attached_link", &RigidObject::attached_link)
      .def_readonly("touch_links", &RigidObject::touch_links)
      .def_readonly("padding", &RigidObject::padding)
      .def_property_readonly(
          "pose", [](const RigidObject& object) { return Eigen::Matrix4d(object.X_PO.matrix()); },
          "float64 (4, 4).")
      .def("__repr__", [](const RigidObject& object) {
        return "<RigidObject '" + object.name + "', " + std::to_string(object.elements.size()) +
               (object.elements.size() == 1 ? " shape" : " shapes") +
               (object.attached_link.empty() ? ">"
                                             : ", attached to '" + object.attached_link + "'>");
      });
}

}  // namespace collision_pairs
