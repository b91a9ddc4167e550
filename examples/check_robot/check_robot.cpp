// Smallest distance of a robot to itself with all joints at zero.
//   check_robot ROBOT.urdf ROBOT.srdf
#include <fstream>
#include <iostream>
#include <iterator>

#include <collision_pairs/collision_detector.h>
#include <collision_pairs/input_error.h>
#include <collision_pairs/mesh_loader.h>

using namespace collision_pairs;

std::string read(const char* path) {
  std::ifstream file(path);
  return {std::istreambuf_iterator<char>(file), {}};
}

int main(int argc, char** argv) try {
  if (argc != 3) throw InputError("usage: check_robot ROBOT.urdf ROBOT.srdf");
  const auto robot = RobotModel::fromUrdf(read(argv[1]), makeMeshLoader());
  const auto scene = CollisionScene::build(robot, Srdf::fromXml(read(argv[2])), nullptr);
  CollisionDetector detector(scene);

  std::vector<Eigen::Isometry3d> X_RB;  // poses of the robot's bodies in its root frame
  robot->forwardKinematics(robot->zeroPositions(), X_RB);
  BodyPoses poses;
  scene->gatherPoses(X_RB, poses);

  CheckSettings settings;
  settings.min_distance = true;
  const CollisionReport& report = detector.detect(poses, settings);
  if (report.verdict == Verdict::UNKNOWN) throw InputError("not all links could be checked");
  std::cout << (report.verdict == Verdict::FREE ? "free, " : "in collision, ")
            << report.min_distance << " m\n";
} catch (const InputError& error) {
  std::cerr << "error: " << error.what() << "\n";
  return 2;
}
