// libFuzzer targets: everything that reads foreign bytes. Whatever they are, it returns or throws
// InputError (YAML of the settings: YAML's own); what it accepts can be checked. PARSER, given by
// the build, is one of the functions below.
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

#include <fuzzer/FuzzedDataProvider.h>
#include <sensor_msgs/PointCloud2.h>
#include <unistd.h>
#include <yaml-cpp/yaml.h>

#include "bag_index.h"
#include "collision_pairs/collision_detector.h"
#include "collision_pairs/input_error.h"
#include "joint_states_csv.h"
#include "mesh_files.h"
#include "message_layout.h"
#include "pcd_file.h"
#include "scene_config.h"
#include "scene_updates.h"

namespace collision_pairs {
namespace {

std::shared_ptr<const TriangleMesh> anyMesh(const std::string&, const Eigen::Vector3d& scale) {
  auto mesh = std::make_shared<TriangleMesh>();
  mesh->vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  for (Eigen::Vector3d& vertex : mesh->vertices) vertex = vertex.cwiseProduct(scale);
  mesh->triangles = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
  return mesh;
}

void check(const SceneDescription& description) {
  const auto scene = CollisionScene::build(description);
  std::vector<Eigen::Isometry3d> X_RB;
  BodyPoses poses;
  scene->robot().forwardKinematics(scene->robot().zeroPositions(), X_RB);
  scene->gatherPoses(X_RB, poses);
  CollisionDetector(scene).detect(poses, CheckSettings());
}

[[maybe_unused]] void urdf(const std::string& bytes) {
  std::vector<BrokenElement> broken;
  SceneDescription description;
  description.robots.resize(1);
  description.robots[0].model = RobotModel::fromUrdf(bytes, anyMesh, &broken);
  constexpr std::size_t FEW = 40;  // links: to build a scene of many is not what is tried here
  if (description.robots[0].model->links().size() <= FEW) check(description);
}

[[maybe_unused]] void srdf(const std::string& bytes) {
  Srdf::fromXml(bytes).switchedOff({"a", "b", "c"});
}

[[maybe_unused]] void settings(const std::string& bytes) {
  try {
    readSceneConfig(YAML::Load(bytes));
  } catch (const YAML::Exception&) {
  }
}

[[maybe_unused]] void states(const std::string& bytes) {
  static const auto robot = RobotModel::fromUrdf(
      "<robot name='r'><link name='a'/><link name='b'/><link name='c'/><joint name='p' "
      "type='continuous'><parent link='a'/><child link='b'/></joint><joint name='q' "
      "type='continuous'><parent link='b'/><child link='c'/><mimic joint='p' multiplier='2'/>"
      "</joint></robot>",
      anyMesh);
  readJointStates(bytes, *robot, "states.csv");
}

[[maybe_unused]] void stl(const std::string& bytes) { readStl(bytes); }
[[maybe_unused]] void obj(const std::string& bytes) { readObj(bytes); }
[[maybe_unused]] void ply(const std::string& bytes) { readPly(bytes); }
[[maybe_unused]] void pcd(const std::string& bytes) { readPcd(bytes); }

[[maybe_unused]] void bag(const std::string& bytes) {
  static const std::string path =
      std::filesystem::temp_directory_path() / ("fuzz_" + std::to_string(::getpid()) + ".bag");
  std::ofstream(path, std::ios::binary) << bytes;
  const auto all = [](const RawMessage&) { return true; };
  const BagIndex index = indexBag(path, all);
  replayBag(path, index, all, [](const RawMessage& raw) {
    readMessage<sensor_msgs::PointCloud2>(raw.data, raw.size);
  });
}

class RequestMaker {
 public:
  explicit RequestMaker(const std::string& bytes)
      : data_(reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()) {}

  std::vector<SceneChange> changes() {
    std::vector<SceneChange> changes(data_.ConsumeIntegralInRange(0, 6));
    for (SceneChange& change : changes) {
      change.operation = data_.ConsumeIntegralInRange<std::uint8_t>(0, 6);
      fill(change.object);
    }
    return changes;
  }

 private:
  double number() {  // any bits, or a number that is likely to be accepted
    return data_.ConsumeBool() ? data_.ConsumeFloatingPoint<double>()
                               : data_.ConsumeIntegralInRange(-8, 8) / 4.0;
  }
  std::string name() {
    return data_.PickValueInArray({"", "a", "b", "new", "a|b", "x;y", "box[1]", "line\nbreak"});
  }
  geometry_msgs::Pose pose() {
    geometry_msgs::Pose pose;
    pose.position.x = number(), pose.position.y = number(), pose.position.z = number();
    pose.orientation.w = 1.0;
    if (data_.ConsumeBool()) pose.orientation.x = number(), pose.orientation.w = number();
    return pose;
  }
  template <class Part, class Fill>
  void fillParts(std::vector<Part>& parts, std::vector<geometry_msgs::Pose>& poses, Fill fill) {
    parts.resize(data_.ConsumeIntegralInRange(0, 2));
    for (Part& part : parts) fill(part);
    poses.resize(data_.ConsumeBool() ? parts.size() : data_.ConsumeIntegralInRange(0, 2));
    for (auto& each : poses) each = pose();
  }

  void fill(SceneObject& object) {
    object.name = name(), object.attached_link = name();
    object.header.frame_id = name();
    object.pose = pose();
    if (data_.ConsumeBool()) object.padding = number();
    if (data_.ConsumeBool()) object.touch_links = {name(), name()};
    fillParts(object.primitives, object.primitive_poses, [&](shape_msgs::SolidPrimitive& solid) {
      solid.type = data_.ConsumeIntegralInRange<std::uint8_t>(0, 5);
      solid.dimensions.resize(data_.ConsumeIntegralInRange(0, 4));
      for (double& dimension : solid.dimensions) dimension = number();
    });
    fillParts(object.meshes, object.mesh_poses, [&](shape_msgs::Mesh& mesh) {
      mesh.vertices.resize(data_.ConsumeIntegralInRange(0, 6));
      for (auto& v : mesh.vertices) v.x = number(), v.y = number(), v.z = number();
      mesh.triangles.resize(data_.ConsumeIntegralInRange(0, 6));
      for (auto& triangle : mesh.triangles) {
        for (auto& index : triangle.vertex_indices) {
          index = data_.ConsumeIntegralInRange<std::uint32_t>(0, 6);
        }
      }
    });
    fillParts(object.planes, object.plane_poses, [&](shape_msgs::Plane& plane) {
      for (double& coefficient : plane.coef) coefficient = number();
    });
    object.mesh_resources.resize(data_.ConsumeIntegralInRange(0, 1), "file:///a.stl");
  }

  FuzzedDataProvider data_;
};

[[maybe_unused]] void update_scene(const std::string& bytes) {
  static const auto robot = RobotModel::fromUrdf(
      "<robot name='r'><link name='a'><collision><geometry><box size='1 1 1'/></geometry>"
      "</collision></link></robot>",
      anyMesh);
  UpdateContext context;
  context.world_frame = "a";
  context.look_up = [](const std::string& target, const std::string& source, const ros::Time&) {
    if (target != source) throw InputError("unknown frame");
    return Eigen::Isometry3d::Identity();
  };
  SceneDescription description;
  description.robots.resize(1);
  description.robots[0].model = robot;
  SceneObjects objects;
  const std::vector<SceneChange> changes = RequestMaker(bytes).changes();
  apply(editsBy(changes, readAdded(changes, anyMesh), objects, context), objects);
  for (const auto& entry : objects) description.objects.push_back(entry.second.object);
  check(description);
}

}  // namespace
}  // namespace collision_pairs

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  try {
    collision_pairs::PARSER(std::string(reinterpret_cast<const char*>(data), size));
  } catch (const collision_pairs::InputError&) {
  }
  return 0;
}
