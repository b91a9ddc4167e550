#include "scene_cases.h"

#include <cmath>
#include <cstdlib>
#include <random>
#include <set>

#include <malloc.h>

#include "collision_pairs/collision_detector.h"
#include "collision_pairs/mesh_loader.h"
#include "link_group.h"
#include "scene_sources.h"
#include "text_files.h"

namespace collision_pairs {
namespace {

constexpr unsigned SEED = 7;

std::size_t heapInUse() {
  const auto info = mallinfo2();
  return info.uordblks + info.hblkhd;
}

RigidObject boxAt(const std::string& name, const Eigen::Vector3d& size, const Eigen::Vector3d& p) {
  RigidObject object;
  object.name = name;
  object.elements.push_back({Box{size}, Eigen::Isometry3d::Identity()});
  object.X_PO.translation() = p;
  return object;
}

std::string numbered(std::size_t i) { return "box_" + std::to_string(i); }

/// Which of the boxes are in no candidate pair of any state.
std::vector<char> neverReached(const BenchmarkRobot& robot, const std::vector<RigidObject>& boxes) {
  SceneDescription description = describe(robot, boxes);
  description.check_self = false;
  description.settings.fidelity = Fidelity::AABB;
  const auto scene = CollisionScene::build(description);
  CollisionDetector detector(scene);
  CheckSettings settings;
  settings.fidelity = Fidelity::AABB;
  std::set<std::string> reached;
  BodyPoses poses;
  for (const auto& X_RB : robot.states) {
    scene->gatherPoses(X_RB, poses);
    for (const auto& [a, b] : detector.detect(poses, settings).candidates) {
      const std::uint32_t standing = std::min(a, b);  // their ids come first
      reached.insert(scene->models()[scene->elements()[standing].model].name);
    }
  }
  std::vector<char> free;
  for (const RigidObject& box : boxes) free.push_back(reached.count(box.name) == 0);
  return free;
}

std::string urdfOf(const BenchmarkRobot& robot) {
  const std::string data = std::getenv("COLLISION_PAIRS_SHARED");
  return readTextFile(data + "/robots/" + robot.name + "_model/urdf/" + robot.name + ".urdf");
}

std::set<std::string> namesOf(const BenchmarkRobot& robot, const std::string& group) {
  std::set<std::string> names;
  for (const int link : linksMovedBy(robot.srdf, *robot.robot, group)) {
    names.insert(robot.robot->links()[link].name);
  }
  return names;
}

/// By names: without an SRDF there are no groups.
void restrict(const BenchmarkRobot& robot, const SceneCase& what, SceneDescription& description) {
  if (what.group.empty()) return;
  const std::set<std::string> names = namesOf(robot, what.group);
  if (!what.others_ignored) {
    description.restriction.names.assign(names.begin(), names.end());
    return;
  }
  for (const Link& link : robot.robot->links()) {
    if (names.count(link.name) == 0) description.settings.ignored_links.push_back(link.name);
  }
}

}  // namespace

std::vector<RigidObject> farBoxes(std::size_t count) {
  std::mt19937 random(SEED);
  std::uniform_real_distribution<double> position(-50.0, 50.0), size(0.04, 0.3);
  std::vector<RigidObject> boxes;
  while (boxes.size() < count) {
    const Eigen::Vector3d p(position(random), position(random), position(random));
    const Eigen::Vector3d s(size(random), size(random), size(random));
    if (p.norm() - s.norm() < 5.0) continue;
    boxes.push_back(boxAt(numbered(boxes.size()), s, p));
  }
  return boxes;
}

std::vector<RigidObject> nearBoxes(const BenchmarkRobot& robot, std::size_t count) {
  std::mt19937 random(SEED);
  std::uniform_real_distribution<double> position(-2.0, 2.0);
  std::vector<RigidObject> boxes;
  while (boxes.size() < count) {
    std::vector<RigidObject> tried;
    for (std::size_t i = 0; i < count; ++i) {
      const Eigen::Vector3d p(position(random), position(random), position(random));
      if (p.norm() < 2.0) tried.push_back(boxAt(numbered(i), Eigen::Vector3d::Constant(0.02), p));
    }
    const std::vector<char> free = neverReached(robot, tried);
    for (std::size_t i = 0; i < tried.size() && boxes.size() < count; ++i) {
      if (!free[i]) continue;
      boxes.push_back(tried[i]);
      boxes.back().name = numbered(boxes.size());
    }
  }
  return boxes;
}

SceneDescription describe(const BenchmarkRobot& robot, std::vector<RigidObject> objects) {
  SceneDescription description;
  description.robots.push_back({robot.robot, robot.srdf, ""});
  description.objects = std::move(objects);
  return description;
}

BuiltCase buildCase(const BenchmarkRobot& robot, const SceneCase& what,
                    std::vector<RigidObject> boxes) {
  BuiltCase built;
  built.what = what;
  const std::string urdf = urdfOf(robot);
  SceneDescription description = describe(robot, std::move(boxes));
  if (!what.srdf) description.robots[0].srdf.reset();
  restrict(robot, what, description);

  const std::size_t before = heapInUse();
  const MeshLoader load = makeMeshLoader();
  std::set<const TriangleMesh*> meshes;  // a file that two links have is loaded once
  RobotSource source(urdf, [&](const std::string& uri, const Eigen::Vector3d& scale) {
    const auto mesh = load(uri, scale);
    if (meshes.insert(mesh.get()).second) built.nb_triangles += mesh->triangles.size();
    return mesh;
  });
  description.robots[0].model = source.skeleton();
  const auto needed = CollisionScene::neededModels(description);
  description.robots[0].model =
      source.withGeometryOf([&](const std::string& link) { return needed.count(link) > 0; });
  built.scene = CollisionScene::build(description);
  built.heap_bytes = heapInUse() - before;
  built.nb_meshes = meshes.size();
  return built;
}

}  // namespace collision_pairs
