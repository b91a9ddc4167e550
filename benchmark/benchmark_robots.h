// Real robots with recorded states and worlds, from the folder that COLLISION_PAIRS_SHARED names.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "collision_pairs/robot_model.h"
#include "collision_pairs/srdf.h"

namespace collision_pairs {

/// Of many states of a robot a test checks these: a sanitizer makes each ten to fifty times as slow.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr std::size_t EVERY_NTH_STATE = 10;
#else
constexpr std::size_t EVERY_NTH_STATE = 1;
#endif

struct BenchmarkRobot {
  std::string name;
  std::shared_ptr<const RobotModel> robot;
  std::shared_ptr<const RobotModel> world;
  Srdf srdf;
  std::vector<std::vector<double>> positions;  ///< of each state, one a joint
  /// Forward kinematics of each state: poses of RobotModel::bodies() in the root link's frame.
  std::vector<std::vector<Eigen::Isometry3d>> states;
};

/// The folder that COLLISION_PAIRS_SHARED names, whose robots' meshes are found from then on; empty,
/// with a message on standard error, where it is not there.
std::string sharedData();

/// panda, ur5 and pr2; empty, with a message on standard error, where the data are not there.
const std::vector<BenchmarkRobot>& benchmarkRobots();

}  // namespace collision_pairs
