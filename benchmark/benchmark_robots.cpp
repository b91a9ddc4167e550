#include "benchmark_robots.h"

#include <cstdlib>
#include <iostream>

#include "collision_pairs/mesh_loader.h"
#include "joint_states_csv.h"
#include "text_files.h"

namespace collision_pairs {
namespace {

BenchmarkRobot load(const std::string& data, const std::string& name, const std::string& package) {
  const MeshLoader load_mesh = makeMeshLoader();
  const std::string model = data + "/robots/" + package;
  BenchmarkRobot loaded;
  loaded.name = name;
  loaded.robot = RobotModel::fromUrdf(readTextFile(model + "/urdf/" + name + ".urdf"), load_mesh);
  loaded.srdf = Srdf::fromXml(readTextFile(model + "/srdf/" + name + ".srdf"));
  loaded.world = RobotModel::fromUrdf(
      readTextFile(data + "/robots/world_model/urdf/world_" + name + ".urdf"), load_mesh);
  const std::string csv = data + "/reference/joints_" + name + ".csv";
  loaded.positions = readJointStates(readTextFile(csv), *loaded.robot, csv).positions;
  for (const auto& q : loaded.positions) {
    loaded.states.emplace_back();
    loaded.robot->forwardKinematics(q, loaded.states.back());
  }
  return loaded;
}

std::vector<BenchmarkRobot> loadAll() {
  const std::string data = sharedData();
  if (data.empty()) return {};
  return {load(data, "panda", "panda_model"), load(data, "ur5", "ur_model"),
          load(data, "pr2", "pr2_model")};
}

}  // namespace

std::string sharedData() {
  const char* data = std::getenv("COLLISION_PAIRS_SHARED");
  if (data == nullptr || *data == '\0') {
    std::cerr << "skipped: COLLISION_PAIRS_SHARED names no folder with robots and states\n";
    return "";
  }
  // The folder with the robots' packages, so that their package:// URIs are found.
  const char* path = std::getenv("ROS_PACKAGE_PATH");
  ::setenv("ROS_PACKAGE_PATH", (std::string(data) + "/robots:" + (path ? path : "")).c_str(), 1);
  return data;
}

const std::vector<BenchmarkRobot>& benchmarkRobots() {
  static const std::vector<BenchmarkRobot> robots = loadAll();
  return robots;
}

}  // namespace collision_pairs
