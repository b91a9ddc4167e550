#include "object_conversions.h"

#include <cmath>

#include "collision_pairs/input_error.h"
#include "cone.h"
#include "geometry_conversions.h"

namespace collision_pairs {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;
using shape_msgs::SolidPrimitive;

std::vector<double> sizesOf(const SolidPrimitive& primitive, const char* shape,
                            const std::vector<const char*>& meaning) {
  if (primitive.dimensions.size() == meaning.size()) {
    return {primitive.dimensions.begin(), primitive.dimensions.end()};
  }
  std::string rule;
  for (const char* size : meaning) rule += (rule.empty() ? "" : ", ") + std::string(size);
  throw InputError(std::string("a ") + shape + " has " +
                   std::to_string(primitive.dimensions.size()) + " dimensions, but needs " +
                   std::to_string(meaning.size()) + ": " + rule);
}

Shape toShape(const SolidPrimitive& primitive) {
  switch (primitive.type) {
    case SolidPrimitive::BOX: {
      const auto d = sizesOf(primitive, "box", {"x", "y", "z"});
      return Box{{d[0], d[1], d[2]}};
    }
    case SolidPrimitive::SPHERE:
      return Sphere{sizesOf(primitive, "sphere", {"radius"})[0]};
    case SolidPrimitive::CYLINDER: {
      const auto d = sizesOf(primitive, "cylinder", {"height", "radius"});
      return Cylinder{d[SolidPrimitive::CYLINDER_RADIUS], d[SolidPrimitive::CYLINDER_HEIGHT]};
    }
    case SolidPrimitive::CONE: {
      const auto d = sizesOf(primitive, "cone", {"height", "radius"});
      for (const double size : d) {
        if (size >= 0.0 && std::isfinite(size)) continue;
        throw InputError("a cone's size is negative or not finite");
      }
      return pyramidAroundCone(d[SolidPrimitive::CONE_RADIUS], d[SolidPrimitive::CONE_HEIGHT]);
    }
    default:
      throw InputError("type " + std::to_string(primitive.type) +
                       " is unknown; use BOX 1, SPHERE 2, CYLINDER 3 or CONE 4");
  }
}

Shape toShape(const shape_msgs::Mesh& message) {
  auto mesh = std::make_shared<TriangleMesh>();
  mesh->name = "mesh of a message";
  for (const auto& vertex : message.vertices) mesh->vertices.push_back(toVector(vertex));
  for (const auto& triangle : message.triangles) {
    const auto& v = triangle.vertex_indices;
    mesh->triangles.push_back({v[0], v[1], v[2]});
  }
  return Mesh{mesh};
}

/// The pose in the object's frame of the half-space whose top is a x + b y + c z + d = 0.
Isometry3d poseOfPlane(const shape_msgs::Plane& plane) {
  const Vector3d normal(plane.coef[0], plane.coef[1], plane.coef[2]);
  const double length = normal.norm();
  if (!(length > 0.0) || !std::isfinite(length) || !std::isfinite(plane.coef[3])) {
    throw InputError(
        "its coefficients do not define a plane: (a, b, c) must not be zero, and all must be "
        "finite");
  }
  Isometry3d X = Isometry3d::Identity();
  const Vector3d z = normal / length;  // the axis that matters: exact, also if it points downwards
  X.linear().col(0) = z.unitOrthogonal();
  X.linear().col(1) = z.cross(X.linear().col(0));
  X.linear().col(2) = z;
  X.translation() = -plane.coef[3] / length * z;
  return X;
}

/// `part` creates the element, without the pose from the message.
template <class Parts, class Part>
void addElements(const Parts& parts, const std::vector<geometry_msgs::Pose>& poses,
                 const std::string& field, const Part& part, std::vector<Element>& elements) {
  if (!poses.empty() && poses.size() != parts.size()) {
    throw InputError(field + " has " + std::to_string(parts.size()) + " entries, but " +
                     std::to_string(poses.size()) + " poses; give one each, or none");
  }
  for (std::size_t i = 0; i < parts.size(); ++i) {
    try {
      Element element = part(parts[i]);
      validateShape(element.shape);
      if (!poses.empty()) element.X_LE = requiredIsometry(poses[i]) * element.X_LE;
      elements.push_back(std::move(element));
    } catch (const std::exception& error) {
      throw InputError(field + "[" + std::to_string(i) + "]: " + error.what());
    }
  }
}

}  // namespace

RigidObject toObject(const SceneObject& message, const MeshLoader& load_mesh) {
  RigidObject object;
  object.name = message.name;
  const auto at_origin = [](Shape shape) {
    return Element{std::move(shape), Isometry3d::Identity()};
  };
  const auto add = [&](const auto& parts, const auto& poses, const char* field, const auto& part) {
    addElements(parts, poses, field, part, object.elements);
  };
  add(message.primitives, message.primitive_poses, "primitives",
      [&](const SolidPrimitive& primitive) { return at_origin(toShape(primitive)); });
  add(message.meshes, message.mesh_poses, "meshes",
      [&](const shape_msgs::Mesh& mesh) { return at_origin(toShape(mesh)); });
  add(message.mesh_resources, message.mesh_resource_poses, "mesh_resources",
      [&](const std::string& uri) { return at_origin(Mesh{load_mesh(uri, Vector3d::Ones())}); });
  add(message.planes, message.plane_poses, "planes", [](const shape_msgs::Plane& plane) {
    return Element{HalfSpace{}, poseOfPlane(plane)};
  });
  object.attached_link = message.attached_link;
  object.touch_links = message.touch_links;
  object.padding = message.padding;
  return object;
}

}  // namespace collision_pairs
