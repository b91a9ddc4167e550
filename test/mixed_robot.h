// A robot of floating links of every kind of shape, for tests of the ladder.
#pragma once

#include <stdexcept>
#include <string>

#include "demo_scene.h"
#include "random_inputs.h"
#include "test_shapes.h"

namespace collision_pairs {

/// Meshes by name: "l", "ball" (bumpy), "slab" (convex), "pair" (two bodies apart), "fork" (a block
/// with two thin rods).
inline std::shared_ptr<const TriangleMesh> testMesh(const std::string& uri,
                                                    const Eigen::Vector3d&) {
  TriangleMesh mesh;
  if (uri == "slab") mesh = boxMesh({0.2, 0.15, 0.02});
  if (uri == "l") mesh = LShape().mesh();
  if (uri == "ball") mesh = bumpyBall(12, 0.15);
  if (uri == "pair")
    mesh = joined(boxMesh({0.05, 0.05, 0.05}), movedBy(bumpyBall(8, 0.08), {0.3, 0, 0}));
  if (uri == "fork") {
    const TriangleMesh rod = boxMesh({0.004, 0.004, 0.4});
    mesh = joined(boxMesh({0.06, 0.06, 0.06}),
                  joined(movedBy(rod, {0.02, 0, 0.1}), movedBy(rod, {-0.02, 0, -0.15})));
  }
  if (mesh.triangles.empty()) throw std::logic_error("a test names no mesh \"" + uri + '"');
  return std::make_shared<const TriangleMesh>(mesh);
}

/// Links a, b, c, … that float freely: `rounds` of each of eight shapes, and one link with two of
/// them.
inline std::shared_ptr<const RobotModel> mixedRobot(int rounds = 1) {
  const std::string shapes[] = {
      "<box size='0.4 0.1 0.2'/>", "<cylinder radius='0.1' length='0.3'/>",
      "<sphere radius='0.15'/>",   "<mesh filename='l'/>",
      "<mesh filename='ball'/>",   "<mesh filename='slab'/>",
      "<mesh filename='pair'/>",   "<box size='0.3 0.3 0.3'/>"};
  std::string xml = emptyLink("root");
  char name = 'a';
  for (int round = 0; round < rounds; ++round) {
    for (const std::string& shape : shapes) {
      const std::string link(1, name++);
      xml += linkWith(link, shape) + joint("float_" + link, "floating", "root", link, "0 0 0", "");
    }
  }
  xml +=
      "<link name='z'><collision><geometry><mesh filename='l'/></geometry></collision>"
      "<collision><origin xyz='0.2 0 0'/><geometry><sphere radius='0.1'/></geometry></collision>"
      "</link>" +
      joint("float_z", "floating", "root", "z", "0 0 0", "");
  return RobotModel::fromUrdf("<robot name='mixed'>" + xml + "</robot>", testMesh);
}

inline void throwAbout(RandomInputs& random, double reach, BodyPoses& poses) {
  for (Eigen::Isometry3d& X_WB : poses.X_WB) X_WB = random.pose(reach);
}

}  // namespace collision_pairs
