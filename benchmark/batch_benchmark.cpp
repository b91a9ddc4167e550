// The core's checks of joint states, timed on request: what scripts/benchmark_python compares
// Python with. A line "batch" or "single" on standard input is answered by the
// microseconds of processor time that a state took.
#include <ctime>
#include <iostream>
#include <string>

#include "collision_pairs/batch_check.h"
#include "collision_pairs/mesh_loader.h"
#include "collision_pairs/srdf.h"
#include "joint_states_csv.h"
#include "text_files.h"

namespace collision_pairs {
namespace {

class Benchmark {
 public:
  /// The states of the file, one after the other and again, until there are `count`.
  Benchmark(const std::string& urdf, const std::string& srdf, const std::string& csv,
            std::size_t count)
      : robot_(RobotModel::fromUrdf(readTextFile(urdf), makeMeshLoader())),
        scene_(CollisionScene::build(robot_, Srdf::fromXml(readTextFile(srdf)), nullptr)),
        batch_(scene_),
        detector_(scene_) {
    const auto given = readJointStates(readTextFile(csv), *robot_, csv).positions;
    for (std::size_t i = 0; i < count; ++i) states_.push_back(given[i % given.size()]);
    settings_.verdict_only = true;
  }

  double time(const std::string& what) {
    std::vector<std::uint8_t> verdicts(states_.size());
    const auto take = [&](std::size_t i, const CollisionReport& report) {
      verdicts[i] = static_cast<std::uint8_t>(report.verdict);
    };
    const auto pose = [&](std::size_t i, BodyPoses& poses) {
      thread_local std::vector<Eigen::Isometry3d> X_WB;
      robot_->forwardKinematics(states_[i], X_WB);
      scene_->gatherPoses(X_WB, poses);
    };
    const std::clock_t begin = std::clock();  // of all threads
    if (what == "batch") {
      batch_.run(states_.size(), settings_, pose, take);
    } else {
      for (std::size_t i = 0; i < states_.size(); ++i) {
        pose(i, poses_);
        take(i, detector_.detect(poses_, settings_));
      }
    }
    const double seconds = static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
    return 1e6 * seconds / static_cast<double>(states_.size());
  }

 private:
  std::shared_ptr<const RobotModel> robot_;
  std::shared_ptr<const CollisionScene> scene_;
  BatchCheck batch_;
  CollisionDetector detector_;
  BodyPoses poses_;
  CheckSettings settings_;
  std::vector<std::vector<double>> states_;
};

}  // namespace
}  // namespace collision_pairs

int main(int argc, char** argv) {
  if (argc != 5) {
    std::cerr << "usage: batch_benchmark ROBOT.urdf ROBOT.srdf STATES.csv COUNT\n";
    return 2;
  }
  try {
    collision_pairs::Benchmark benchmark(argv[1], argv[2], argv[3], std::stoul(argv[4]));
    for (std::string line; std::getline(std::cin, line);) {
      std::cout << benchmark.time(line) << std::endl;
    }
  } catch (const std::exception& error) {
    std::cerr << "error: " << error.what() << '\n';
    return 2;
  }
}
