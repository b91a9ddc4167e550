// Plans from one posture to another with RRT-Connect; every edge of the path is certified.
//   plan_with_ompl ROBOT.urdf ROBOT.srdf JOINT=FROM:TO …      joints that are not named stay at
//   zero
#include <fstream>
#include <iostream>
#include <iterator>

#include <collision_pairs/mesh_loader.h>
#include <collision_pairs/ompl.h>
#include <ompl/geometric/SimpleSetup.h>
#include <ompl/geometric/planners/rrt/RRTConnect.h>

using namespace collision_pairs;
namespace ob = ompl::base;
namespace og = ompl::geometric;

std::string read(const char* path) {
  std::ifstream file(path);
  return {std::istreambuf_iterator<char>(file), {}};
}

struct Task {
  OmplJoints joints;
  std::vector<double> from, to;
};

Task parse(int count, char** words) {
  Task task;
  for (int i = 0; i < count; ++i) {
    const std::string word = words[i];
    const std::size_t equals = word.find('='), colon = word.find(':', equals);
    if (colon == std::string::npos) throw InputError(word + " is not JOINT=FROM:TO");
    task.joints.names.push_back(word.substr(0, equals));
    task.from.push_back(std::stod(word.substr(equals + 1, colon - equals - 1)));
    task.to.push_back(std::stod(word.substr(colon + 1)));
  }
  return task;
}

ob::StateSpacePtr spaceOf(const RobotModel& robot, const std::vector<std::string>& names) {
  ob::RealVectorBounds bounds(names.size());
  for (std::size_t i = 0; i < names.size(); ++i) {
    const int joint = robot.findJoint(names[i]);
    const bool has_limits = joint >= 0 && robot.joints()[joint].hasLimits();
    bounds.setLow(i, has_limits ? robot.joints()[joint].lower : -3.1416);
    bounds.setHigh(i, has_limits ? robot.joints()[joint].upper : 3.1416);
  }
  auto space = std::make_shared<ob::RealVectorStateSpace>(names.size());
  space->setBounds(bounds);
  return space;
}

int main(int argc, char** argv) try {
  if (argc < 4) throw InputError("usage: plan_with_ompl ROBOT.urdf ROBOT.srdf JOINT=FROM:TO …");
  const Task task = parse(argc - 3, argv + 3);
  const auto robot = RobotModel::fromUrdf(read(argv[1]), makeMeshLoader());
  const auto scene = CollisionScene::build(robot, Srdf::fromXml(read(argv[2])), nullptr);

  og::SimpleSetup setup(spaceOf(*robot, task.joints.names));
  const auto& space = setup.getSpaceInformation();
  setup.setStateValidityChecker(
      std::make_shared<OmplStateValidityChecker>(space, scene, task.joints));
  space->setMotionValidator(std::make_shared<OmplMotionValidator>(space, scene, task.joints));
  ob::ScopedState<> start(space), goal(space);
  start = task.from;
  goal = task.to;
  setup.setStartAndGoalStates(start, goal);
  setup.setPlanner(std::make_shared<og::RRTConnect>(space));
  if (setup.solve(10.0) != ob::PlannerStatus::EXACT_SOLUTION) {
    throw InputError("no path was found in 10 s");
  }
  std::cout.precision(17);
  setup.getSolutionPath().printAsMatrix(std::cout);
} catch (const std::exception& error) {
  std::cerr << "error: " << error.what() << "\n";
  return 2;
}
