// Objects in messages, for tests.
#pragma once

#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include <collision_pairs/SceneObject.h>

#include "collision_pairs/input_error.h"
#include "collision_pairs/mesh_loader.h"
#include "geometry_conversions.h"

namespace collision_pairs {

inline geometry_msgs::Pose poseAt(double x, double y, double z) {
  geometry_msgs::Pose pose;
  pose.position.x = x;
  pose.position.y = y;
  pose.position.z = z;
  pose.orientation.w = 1.0;
  return pose;
}

inline shape_msgs::SolidPrimitive primitive(std::uint8_t type,
                                            const std::vector<double>& dimensions) {
  shape_msgs::SolidPrimitive solid;
  solid.type = type;
  solid.dimensions.assign(dimensions.begin(), dimensions.end());
  return solid;
}

inline SceneObject boxObject(const std::string& name, const geometry_msgs::Pose& pose) {
  SceneObject object;
  object.name = name;
  object.pose = pose;
  object.primitives = {primitive(shape_msgs::SolidPrimitive::BOX, {1, 2, 3})};
  return object;
}

inline shape_msgs::Mesh messageOf(const TriangleMesh& mesh) {
  shape_msgs::Mesh message;
  for (const Eigen::Vector3d& v : mesh.vertices) message.vertices.push_back(toPoint(v));
  for (const auto& t : mesh.triangles) {
    message.triangles.emplace_back();
    std::copy(t.begin(), t.end(), message.triangles.back().vertex_indices.begin());
  }
  return message;
}

inline MeshLoader noMeshLoader() {
  return [](const std::string& uri, const Eigen::Vector3d&) -> std::shared_ptr<const TriangleMesh> {
    throw InputError("mesh '" + uri + "': there is no such file");
  };
}

}  // namespace collision_pairs
