// Objects in messages, for tests.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include <collision_pairs/SceneObject.h>

#include "collision_pairs/input_error.h"
#include "collision_pairs/mesh_loader.h"

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

inline MeshLoader noMeshLoader() {
  return [](const std::string& uri, const Eigen::Vector3d&) -> std::shared_ptr<const TriangleMesh> {
    throw InputError("mesh '" + uri + "': there is no such file");
  };
}

}  // namespace collision_pairs
