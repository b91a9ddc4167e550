#include "demo_motion.h"

#include <cstdlib>

#include "collision_pairs/mesh_loader.h"
#include "joint_states_csv.h"
#include "text_files.h"

namespace collision_pairs {
namespace {

constexpr int STEPS = 32;

std::vector<double> between(const std::vector<double>& a, const std::vector<double>& b,
                            double share) {
  std::vector<double> q(a.size());
  for (std::size_t i = 0; i < q.size(); ++i) q[i] = (1.0 - share) * a[i] + share * b[i];
  return q;
}

}  // namespace

BenchmarkRobot demoRobot() {
  const std::string project = PROJECT_SOURCE_DIR, folder = project + "/config/demo/";
  const char* path = std::getenv("ROS_PACKAGE_PATH");
  ::setenv("ROS_PACKAGE_PATH", (project + ":" + (path ? path : "")).c_str(), 1);
  BenchmarkRobot demo;
  demo.name = "demo";
  demo.robot = RobotModel::fromUrdf(readTextFile(folder + "demo_robot.urdf"), makeMeshLoader());
  demo.srdf = Srdf::fromXml(readTextFile(folder + "demo_robot.srdf"));
  const std::string csv = folder + "motion.csv";
  const auto postures = readJointStates(readTextFile(csv), *demo.robot, csv).positions;
  for (std::size_t i = 0; i + 1 < postures.size(); ++i) {
    for (int step = 0; step < STEPS; ++step) {
      const double share = static_cast<double>(step) / STEPS;
      demo.positions.push_back(between(postures[i], postures[i + 1], share));
      demo.states.emplace_back();
      demo.robot->forwardKinematics(demo.positions.back(), demo.states.back());
    }
  }
  return demo;
}

}  // namespace collision_pairs
