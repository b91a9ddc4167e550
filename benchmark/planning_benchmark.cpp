// Planners of OMPL on the problems of planning_problems.h, with edges that are certified, edges
// that are sampled, and edges that are sampled with a loop like MoveIt's.
//
//   COLLISION_PAIRS_SHARED=DATA planning_benchmark ROBOT PLANNER PROBLEMS SECONDS > ROWS.csv
//
// A row a run: in turns, from one seed, ended by the first solution. Seconds are CPU time of the
// process, so that other work on the machine does not count. Scenes, planners and the memory of
// checks are made before.
#include <cmath>
#include <cstdlib>
#include <ctime>
#include <functional>
#include <iostream>

#include <ompl/base/DiscreteMotionValidator.h>
#include <ompl/base/objectives/PathLengthOptimizationObjective.h>
#include <ompl/geometric/PathGeometric.h>
#include <ompl/geometric/planners/informedtrees/AITstar.h>
#include <ompl/geometric/planners/informedtrees/BITstar.h>
#include <ompl/geometric/planners/prm/PRMstar.h>
#include <ompl/geometric/planners/rrt/RRTConnect.h>
#include <ompl/util/Console.h>
#include <ompl/util/RandomNumbers.h>

#include "collision_pairs/ompl.h"
#include "moveit_loop.h"
#include "planning_problems.h"

namespace collision_pairs {
namespace {

namespace ob = ompl::base;
namespace og = ompl::geometric;
using VectorState = ob::RealVectorStateSpace::StateType;
using Values = std::vector<double>;

constexpr double STEP = 0.01;                          // rad, Euclidean, of sampled edges
constexpr double JUDGED_STEP = 1e-4, FCL_STEP = 5e-3;  // rad, of those who judge paths
const char* const EDGES[] = {"certified", "sampled", "fcl"};

double cpuSeconds(clockid_t clock = CLOCK_PROCESS_CPUTIME_ID) {
  std::timespec now{};
  clock_gettime(clock, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

ob::PlannerPtr makePlanner(const std::string& name, const ob::SpaceInformationPtr& space) {
  if (name == "RRTConnect") return std::make_shared<og::RRTConnect>(space);
  if (name == "PRMstar") return std::make_shared<og::PRMstar>(space);
  if (name == "BITstar") return std::make_shared<og::BITstar>(space);
  return std::make_shared<og::AITstar>(space);
}

/// Sums up the seconds of another one: the rest of a run is the planner's own work.
class TimedMotions : public ob::MotionValidator {
 public:
  TimedMotions(const ob::SpaceInformationPtr& space, ob::MotionValidatorPtr motions)
      : MotionValidator(space), motions_(std::move(motions)) {}

  bool checkMotion(const ob::State* from, const ob::State* to) const override {
    return timed([&] { return motions_->checkMotion(from, to); });
  }
  bool checkMotion(const ob::State* from, const ob::State* to,
                   std::pair<ob::State*, double>& last_valid) const override {
    return timed([&] { return motions_->checkMotion(from, to, last_valid); });
  }
  mutable double seconds = 0.0;

 private:
  template <class Check>
  bool timed(const Check& check) const {
    const double began = cpuSeconds(CLOCK_THREAD_CPUTIME_ID);
    const bool is_valid = check();
    seconds += cpuSeconds(CLOCK_THREAD_CPUTIME_ID) - began;
    ++(is_valid ? valid_ : invalid_);
    return is_valid;
  }

  const ob::MotionValidatorPtr motions_;
};

/// Asks MoveItLoop, which sees surfaces only.
class FclChecker : public ob::StateValidityChecker {
 public:
  FclChecker(const ob::SpaceInformationPtr& space, const RobotModel& robot, const MoveItLoop& loop,
             const OmplJoints& joints)
      : StateValidityChecker(space),
        robot_(robot),
        loop_(loop),
        columns_(joints.names, robot),
        positions_(joints.positions) {}

  bool isValid(const ob::State* state) const override {
    return !meets(state->as<VectorState>()->values);
  }
  bool meets(const double* values) const {
    columns_.apply(values, positions_);
    robot_.forwardKinematics(positions_, X_RB_);
    return loop_.collides(X_RB_);
  }

 private:
  const RobotModel& robot_;
  const MoveItLoop& loop_;
  JointColumns columns_;
  mutable Values positions_;
  mutable MoveItLoop::Poses X_RB_;
};

double distance(const Values& a, const Values& b) {
  double sum = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += (b[i] - a[i]) * (b[i] - a[i]);
  return std::sqrt(sum);
}

bool anyMeets(const Values& from, const Values& to, double step,
              const std::function<bool(const double*)>& meets) {
  const int nb_steps = static_cast<int>(std::ceil(distance(from, to) / step));
  Values at(from);
  for (int k = 0; k <= nb_steps; ++k) {
    const double fraction = nb_steps == 0 ? 0.0 : static_cast<double>(k) / nb_steps;
    for (std::size_t i = 0; i < at.size(); ++i) at[i] = from[i] + fraction * (to[i] - from[i]);
    if (meets(at.data())) return true;
  }
  return false;
}

class Problem {
 public:
  Problem(const PlanningProblems& all, const PlanningProblem& problem, SceneCache& cache)
      : source_(all.robot), problem_(problem), joints_{all.joints, all.positions, {}} {
    source_.world = problem.world;
    SceneDescription description;
    description.robots.push_back({source_.robot, source_.srdf, ""});
    description.world = problem.world;
    scene_ = CollisionScene::build(description, &cache);
    loop_ = std::make_unique<MoveItLoop>(source_);
    judge_ = std::make_unique<CollisionDetector>(scene_);
    motions_ = std::make_unique<MotionCheck>(scene_);
  }

  bool isPossible() { return !meets(problem_.start.data()) && !meets(problem_.goal.data()); }

  void run(std::size_t number, const std::string& planner_name, int edges, double most_seconds) {
    ompl::RNG::setSeed(number + 1);
    const auto space = std::make_shared<ob::SpaceInformation>(makeSpace());
    setChecks(space, edges);
    // OMPL's step is a fraction of the space's diagonal.
    space->getStateSpace()->setLongestValidSegmentFraction(STEP / space->getMaximumExtent());
    space->setup();
    ob::ScopedState<> start(space), goal(space);
    start = problem_.start;
    goal = problem_.goal;
    const auto definition = std::make_shared<ob::ProblemDefinition>(space);
    definition->setStartAndGoalStates(start, goal);
    const auto objective = std::make_shared<ob::PathLengthOptimizationObjective>(space);
    objective->setCostThreshold(objective->infiniteCost());  // the first solution will do
    definition->setOptimizationObjective(objective);
    const ob::PlannerPtr planner = makePlanner(planner_name, space);
    planner->setProblemDefinition(definition);
    planner->setup();
    space->isValid(start.get());
    space->checkMotion(start.get(), start.get());
    const auto& motions = static_cast<const TimedMotions&>(*space->getMotionValidator());
    const double before = motions.seconds;

    const double began = cpuSeconds();
    const ob::PlannerStatus status = planner->solve(
        ob::PlannerTerminationCondition([=] { return cpuSeconds() - began > most_seconds; }));
    const double seconds = cpuSeconds() - began;
    const bool solved = status == ob::PlannerStatus::EXACT_SOLUTION && seconds <= most_seconds;
    std::cout << source_.name << ',' << number << ',' << problem_.set << ',' << planner_name << ','
              << EDGES[edges] << ',' << solved << ',' << seconds << ',' << motions.seconds - before
              << ',' << motions.getValidMotionCount() << ',' << motions.getInvalidMotionCount();
    if (solved) {
      judge(*definition->getSolutionPath()->as<og::PathGeometric>(), edges, space);
    } else {
      std::cout << ",,,";
    }
    std::cout << std::endl;
  }

 private:
  ob::StateSpacePtr makeSpace() const {
    ob::RealVectorBounds bounds(joints_.names.size());
    for (std::size_t i = 0; i < joints_.names.size(); ++i) {
      const Joint& joint = source_.robot->joints()[source_.robot->findJoint(joints_.names[i])];
      bounds.setLow(i, joint.hasLimits() ? joint.lower : -M_PI);
      bounds.setHigh(i, joint.hasLimits() ? joint.upper : M_PI);
    }
    auto space = std::make_shared<ob::RealVectorStateSpace>(joints_.names.size());
    space->setBounds(bounds);
    return space;
  }

  void setChecks(const ob::SpaceInformationPtr& space, int edges) const {
    if (edges == 2) {
      space->setStateValidityChecker(
          std::make_shared<FclChecker>(space, *source_.robot, *loop_, joints_));
    } else {
      space->setStateValidityChecker(
          std::make_shared<OmplStateValidityChecker>(space, scene_, joints_));
    }
    ob::MotionValidatorPtr motions = std::make_shared<ob::DiscreteMotionValidator>(space);
    if (edges == 0) motions = std::make_shared<OmplMotionValidator>(space, scene_, joints_);
    space->setMotionValidator(std::make_shared<TimedMotions>(space, motions));
  }

  /// The exact check of one configuration.
  bool meets(const double* values) {
    Values positions = joints_.positions;
    JointColumns(joints_.names, scene_->robot()).apply(values, positions);
    scene_->robot().forwardKinematics(positions, X_RB_);
    scene_->gatherPoses(X_RB_, poses_);
    CheckSettings settings;
    settings.verdict_only = true;
    return judge_->detect(poses_, settings).verdict != Verdict::FREE;
  }

  bool isCertified(const Values& from, const Values& to) {
    JointMotion motion{joints_.positions, joints_.positions};
    const JointColumns columns(joints_.names, scene_->robot());
    columns.apply(from.data(), motion.from);
    columns.apply(to.data(), motion.to);
    return motions_->check(motion, {}).verdict == Verdict::FREE;
  }

  /// Writes length, whether a configuration at JUDGED_STEP is in contact, and whether FCL finds one
  /// at FCL_STEP in a certified path. Certified paths are sampled as a whole; of the others, what
  /// cannot be certified.
  void judge(og::PathGeometric& path, int edges, const ob::SpaceInformationPtr& space) {
    const FclChecker fcl(space, *source_.robot, *loop_, joints_);
    bool in_contact = false, fcl_finds = false;
    Values from, to;
    for (std::size_t i = 0; i < path.getStateCount(); ++i) {
      const double* values = path.getState(i)->as<VectorState>()->values;
      to.assign(values, values + joints_.names.size());
      if (i > 0 && (edges == 0 || !isCertified(from, to))) {
        in_contact |= anyMeets(from, to, JUDGED_STEP, [&](const double* q) { return meets(q); });
        if (edges == 0) {
          fcl_finds |= anyMeets(from, to, FCL_STEP, [&](const double* q) { return fcl.meets(q); });
        }
      }
      from = to;
    }
    std::cout << ',' << path.length() << ',' << in_contact << ',';
    if (edges == 0) std::cout << fcl_finds;
  }

  BenchmarkRobot source_;
  const PlanningProblem& problem_;
  OmplJoints joints_;
  std::shared_ptr<const CollisionScene> scene_;
  std::unique_ptr<MoveItLoop> loop_;
  std::unique_ptr<CollisionDetector> judge_;
  std::unique_ptr<MotionCheck> motions_;
  MoveItLoop::Poses X_RB_;
  BodyPoses poses_;
};

void run(const PlanningProblems& all, const std::string& planner, double most_seconds) {
  std::cout << "robot,problem,set,planner,edges,solved,seconds,edge_seconds,edges_valid,edges_"
               "invalid,length,"
               "in_contact,fcl_finds\n";
  SceneCache cache;
  for (std::size_t i = 0; i < all.problems.size(); ++i) {
    Problem problem(all, all.problems[i], cache);
    if (!problem.isPossible()) {
      std::cerr << all.robot.name << ": start or goal of problem " << i << " is in contact\n";
      continue;
    }
    for (std::size_t turn = 0; turn < 3; ++turn) {
      problem.run(i, planner, static_cast<int>((i + turn) % 3), most_seconds);
    }
  }
}

}  // namespace
}  // namespace collision_pairs

int main(int argc, char** argv) {
  using namespace collision_pairs;
  const int nb_problems = argc == 5 ? std::atoi(argv[3]) : 0;
  if (nb_problems < 1) {
    std::cerr << "usage: planning_benchmark ROBOT PLANNER PROBLEMS SECONDS > ROWS.csv\n";
    return 2;
  }
  const std::string data = sharedData();
  if (data.empty()) return 0;
  ompl::msg::setLogLevel(ompl::msg::LOG_NONE);
  run(readPlanningProblems(data, argv[1], static_cast<std::size_t>(nb_problems)), argv[2],
      std::atof(argv[4]));
  return 0;
}
