// Small robots for tests, written in place.
#pragma once

#include <string>

#include "collision_pairs/collision_scene.h"
#include "collision_pairs/input_error.h"

namespace collision_pairs {

inline std::shared_ptr<const TriangleMesh> noMeshes(const std::string& uri,
                                                    const Eigen::Vector3d&) {
  throw InputError("mesh '" + uri + "': there are no meshes in this test");
}

inline std::shared_ptr<const RobotModel> robotFrom(const std::string& links_and_joints) {
  return RobotModel::fromUrdf("<robot name='test'>" + links_and_joints + "</robot>", noMeshes);
}

inline std::string linkWith(const std::string& name, const std::string& geometry,
                            const std::string& origin = "") {
  return "<link name='" + name + "'><collision>" + origin + "<geometry>" + geometry +
         "</geometry></collision></link>";
}

inline std::string boxLink(const std::string& name, double size) {
  const std::string s = std::to_string(size);
  return linkWith(name, "<box size='" + s + " " + s + " " + s + "'/>");
}

inline std::string emptyLink(const std::string& name) { return "<link name='" + name + "'/>"; }

inline std::string joint(const std::string& name, const std::string& type,
                         const std::string& parent, const std::string& child,
                         const std::string& xyz = "0 0 0",
                         const std::string& extra = "<limit lower='-3' upper='3'/>") {
  return "<joint name='" + name + "' type='" + type + "'><parent link='" + parent +
         "'/><child link='" + child + "'/><origin xyz='" + xyz + "'/>" + extra + "</joint>";
}

/// Unit boxes named a, b, c, … sliding along x from a root without geometry, all at the origin.
inline std::string slidingBoxes(int count) {
  std::string xml = emptyLink("root");
  for (int i = 0; i < count; ++i) {
    const std::string name(1, static_cast<char>('a' + i));
    xml += boxLink(name, 1.0) + joint("slide_" + name, "prismatic", "root", name, "0 0 0",
                                      "<axis xyz='1 0 0'/><limit lower='-100' upper='100'/>");
  }
  return xml;
}

}  // namespace collision_pairs
