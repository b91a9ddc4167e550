// No near pair is lost and no two answers contradict each other a hair before contact: on random
// robots of bodies of all kinds, and on real ones.
//
// 20,000 near pairs by default; scripts/test --long: 1,000,000.
#include <cstdlib>
#include <filesystem>

#include "collision_pairs/mesh_loader.h"
#include "collision_pairs/occupied_voxels.h"
#include "near_contact.h"
#include "random_robot.h"
#include "text_files.h"

namespace collision_pairs::test_near_contact {

using Eigen::Isometry3d;
using Eigen::Vector3d;

constexpr double FAR = 100.0;  // metres, of a mesh from its origin

bool isLong() { return std::getenv("COLLISION_PAIRS_LONG") != nullptr; }

Isometry3d shifted(const Vector3d& by) {
  Isometry3d X = Isometry3d::Identity();
  X.translation() = by;
  return X;
}

Element meshElement(TriangleMesh mesh, const Vector3d& scale, const Vector3d& from_origin) {
  for (Vector3d& v : mesh.vertices) v = scale.cwiseProduct(v) + from_origin;
  return {meshShape(mesh), shifted(-from_origin)};
}

Element randomElement(RandomInputs& random) {
  const auto hull = [] { return std::make_shared<TriangleMesh>(bumpyBall(8, 0.12)); };
  const Vector3d as_it_is = Vector3d::Ones(), nowhere = Vector3d::Zero();
  Element element;
  switch (random.integer(0, 13)) {
    case 0:
      element = {Box{{0.3, 0.1, 0.2}}, shifted(nowhere)};
      break;
    case 1:
      element = {Cylinder{0.07, 0.3}, shifted(nowhere)};
      break;
    case 2:
      element = {Sphere{0.1}, shifted(nowhere)};
      break;
    case 3:
      element = {Capsule{0.05, 0.3}, shifted(nowhere)};
      break;
    case 4:
      element = {Convex{hull()}, shifted(nowhere)};
      break;
    case 5:
      element = meshElement(LShape().mesh(), as_it_is, nowhere);
      break;
    case 6:
      element = meshElement(bumpyBall(12, 0.15), as_it_is, nowhere);
      break;
    case 7:
      element = meshElement(LShape().mesh(), {-1.0, 1.0, 1.0}, nowhere);
      break;
    case 8:
      element = meshElement(bumpyBall(9, 0.1), random.vector(0.5, 2.0), nowhere);
      break;
    default:
      element = meshElement(storedPrism(random.integer(5, 24), 0.1, random.uniform(0.05, 0.2),
                                        random.rotation().toRotationMatrix()),
                            as_it_is, nowhere);
      break;
    case 9:
      element = meshElement(LShape().mesh(), as_it_is, {FAR, -FAR, FAR});
      break;
  }
  element.X_LE = random.pose(0.1) * element.X_LE;
  return element;
}

/// Boxes and cylinders as two halves.
std::vector<Element> split(const Element& whole) {
  const auto halves = [&](const Shape& half, double along) {
    const Vector3d by = 0.5 * along * Vector3d::UnitZ();
    return std::vector<Element>{{half, whole.X_LE * shifted(by)},
                                {half, whole.X_LE * shifted(-by)}};
  };
  if (const auto* box = std::get_if<Box>(&whole.shape)) {
    const Vector3d& size = box->size;
    return halves(Box{{size[0], size[1], 0.5 * size[2]}}, 0.5 * size[2]);
  }
  if (const auto* cylinder = std::get_if<Cylinder>(&whole.shape)) {
    return halves(Cylinder{cylinder->radius, 0.5 * cylinder->length}, 0.5 * cylinder->length);
  }
  return {whole};
}

SceneDescription withSplitBodies(SceneDescription description) {
  for (SceneRobot& robot : description.robots) {
    robot.model = robot.model->withElements([](const Link& link) {
      std::vector<Element> elements;
      for (const Element& whole : link.elements) {
        for (const Element& part : split(whole)) elements.push_back(part);
      }
      return elements;
    });
  }
  return description;
}

SceneDescription movedAsAWhole(SceneDescription description, const Isometry3d& X) {
  for (SceneRobot& robot : description.robots) robot.X_WR = X * robot.X_WR;
  for (RigidObject& object : description.objects) object.X_PO = X * object.X_PO;
  return description;
}

/// The other robot's names come first.
SceneDescription exchanged(SceneDescription description) {
  std::swap(description.robots[0].prefix, description.robots[1].prefix);
  return description;
}
std::string exchangedName(const std::string& name) {
  if (name.rfind("one/", 0) == 0) return "two" + name.substr(3);
  return name.rfind("two/", 0) == 0 ? "one" + name.substr(3) : name;
}

/// Two robots among objects, sometimes with a cloud, sometimes far from the origin.
std::unique_ptr<NearContact> nearScene(RandomInputs& random) {
  SceneDescription description;
  for (const std::string prefix : {"one", "two"}) {
    const auto robot = randomRobot(random, 4)->withElements([&](const Link& link) {
      return link.elements.empty() ? std::vector<Element>() : std::vector{randomElement(random)};
    });
    description.robots.push_back({robot, std::nullopt, prefix, random.pose(0.3)});
  }
  for (int i = 0; i < 3; ++i) {
    RigidObject object;
    object.name = "object_" + std::to_string(i);
    object.elements.push_back(randomElement(random));
    object.X_PO = random.pose(0.8);
    description.objects.push_back(object);
  }
  CloudVoxels voxels;
  const bool has_cloud = random.integer(0, 3) == 0;
  if (has_cloud) {
    const double size = 0.05;
    std::vector<VoxelCell> cells;
    for (int i = 0; i < 30; ++i) cells.push_back(random.vector(-12.0, 12.0).cast<int>());
    description.clouds.push_back(cloudOf("cloud", size, {}));
    voxels.push_back(std::make_shared<OccupiedVoxels>(size, cells));
  }
  const double far_off = has_cloud || random.integer(0, 2) > 0 ? 0.0 : 1e3;
  description = movedAsAWhole(description, shifted(far_off * Vector3d::Ones()));
  auto scene = std::make_unique<NearContact>(description, voxels, 2.0 * FAR + 2.0 * far_off);
  const SceneDescription& checked = scene->description();
  scene->addArrangement("exchanged", exchanged(checked), exchangedName);
  scene->addArrangement("split", withSplitBodies(checked));
  if (!has_cloud) scene->addArrangement("moved", movedAsAWhole(checked, random.pose(10.0)));
  return scene;
}

struct Sum {
  std::uint64_t nb_near = 0, nb_questions = 0, nb_scenes = 0;

  /// False after a contradiction.
  bool look(NearContact& scene, RandomInputs& random, int nb_states) {
    const States states = scene.statesNearContact(random, nb_states);
    for (std::size_t i = 0; i < states.size(); ++i) {
      SCOPED_TRACE("state " + std::to_string(i));
      scene.expectOneAnswer(states[i]);
      if (testing::Test::HasFatalFailure()) return false;
    }
    // Making the stage costs as much as some thousand states.
    if (nb_scenes++ % 10 == 0 && !states.empty()) scene.expectBatchAgrees(states);
    nb_near += scene.nb_near;
    nb_questions += scene.nb_questions;
    return !testing::Test::HasFatalFailure();
  }
  void print() const {
    std::cout << nb_near << " near pairs in " << nb_scenes << " scenes, " << nb_questions
              << " questions\n";
  }
};

TEST(NearContact, OfRandomRobotsIsTheSameInEveryWay) {
  RandomInputs random;
  Sum sum;
  const std::uint64_t nb_wanted = isLong() ? 1000000 : 20000;
  while (sum.nb_near < nb_wanted && sum.nb_scenes < nb_wanted / 10) {
    SCOPED_TRACE("scene " + std::to_string(sum.nb_scenes));
    const auto scene = nearScene(random);
    if (!sum.look(*scene, random, isLong() ? 2000 : 400)) break;
  }
  EXPECT_GE(sum.nb_near, nb_wanted);
  sum.print();
}

TEST(NearContact, OfRealRobotsIsTheSameInEveryWay) {
  const char* data = std::getenv("COLLISION_PAIRS_SHARED");
  if (data == nullptr || *data == '\0') GTEST_SKIP() << "COLLISION_PAIRS_SHARED names no data";
  const std::string robots = std::string(data) + "/robots";
  const char* path = std::getenv("ROS_PACKAGE_PATH");
  ::setenv("ROS_PACKAGE_PATH", (robots + ":" + (path ? path : "")).c_str(), 1);
  std::set<std::string> files;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(robots)) {
    if (entry.path().extension() == ".urdf") files.insert(entry.path().string());
  }
  RandomInputs random;
  Sum sum;
  for (const std::string& file : files) {
    SCOPED_TRACE(file);
    SceneDescription description;
    std::vector<BrokenElement> broken;
    const auto robot = RobotModel::fromUrdf(readTextFile(file), makeMeshLoader(), &broken);
    description.robots.push_back({robot, std::nullopt, ""});
    NearContact scene(description, {}, 20.0);
    scene.addArrangement("moved", movedAsAWhole(scene.description(), random.pose(5.0)));
    if (!sum.look(scene, random, isLong() ? 2000 : 40)) break;
  }
  sum.print();
}

}  // namespace collision_pairs::test_near_contact
