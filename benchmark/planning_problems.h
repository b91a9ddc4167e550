// Planning problems of the folder that COLLISION_PAIRS_SHARED names: MotionBenchMaker's.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "benchmark_robots.h"

namespace collision_pairs {

struct PlanningProblem {
  std::string set;
  std::vector<double> start, goal;          ///< rad or m, of PlanningProblems::joints
  std::shared_ptr<const RobotModel> world;  ///< boxes and cylinders, a link each
};

struct PlanningProblems {
  BenchmarkRobot robot;  ///< without world and states
  std::vector<std::string> joints;
  std::vector<double> positions;  ///< of all joints of the robot; `joints` are at zero
  std::vector<PlanningProblem> problems;
};

/// `nb_problems` of panda, ur5 or baxter, spread evenly over all sets. ur5's are without the
/// gripper that they were made for.
PlanningProblems readPlanningProblems(const std::string& data, const std::string& robot,
                                      std::size_t nb_problems);

}  // namespace collision_pairs
