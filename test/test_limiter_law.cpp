// The limiter's law in closed loop with a simulated robot, judged by the exact check.
//
// A small run by default; scripts/test --long makes it the run that docs/limiter.md states.
#include <algorithm>
#include <cmath>
#include <cstdlib>

#include <gtest/gtest.h>

#include "benchmark/demo_motion.h"
#include "benchmark/simulated_limiters.h"
#include "motion_fixtures.h"
#include "published_decisions.h"

namespace collision_pairs::test_limiter_law {

// m: the robot's positions are exact between two steps, and checked every 4 ms.
constexpr double SIMULATION_ERROR = 1e-5;

bool isLong() { return std::getenv("COLLISION_PAIRS_LONG") != nullptr; }

std::vector<BenchmarkRobot> robots() {
  std::vector<BenchmarkRobot> all = {demoRobot()};
  for (const BenchmarkRobot& robot : benchmarkRobots()) all.push_back(robot);
  return all;
}

Limiter ours(const LimiterScene& scene) {
  const auto law = std::make_shared<LimiterLaw>(scene.settings());
  const auto withNewScene = [law, &scene] {
    return lawLimiter(
        law, std::make_shared<CertifiedSurroundings>(scene.seen(), scene.joints(), Fidelity::MESH));
  };
  if (!scene.options().disturbed) return withNewScene();
  return [=, limiter = withNewScene(), calls = 0](const LimiterView& view) mutable {
    if (++calls % 300 == 0) limiter = withNewScene();  // as after a reload
    return limiter(view);
  };
}

/// Seconds of simulated time for each robot.
double secondsEach(double by_default, double in_long_run) {
  const char* given = std::getenv("COLLISION_PAIRS_LIMITER_SECONDS");
  if (given != nullptr) return std::atof(given);
  return isLong() ? in_long_run : by_default;
}

SimulationResult simulate(const BenchmarkRobot& robot, SimulationOptions options, double seconds,
                          RandomInputs& random) {
  const double run = isLong() ? 60.0 : 10.0;  // s in one scene
  SimulationResult all;
  for (int i = 0; i * run < seconds; ++i) {
    options.reaction_time = random.uniform(0.02, 0.2);
    options.command_timeout = random.integer(0, 1) ? 0.2 : 0.05;
    options.deceleration = random.uniform(1.0, 6.0);
    options.max_speed = random.uniform(0.5, 2.0);
    const auto index = static_cast<std::uint64_t>(random.integer(0, 1 << 30));
    LimiterScene scene(robot, limitedJoints(robot), index, options);
    all.add(scene.run(ours(scene), random, std::min(run, seconds)));
  }
  std::cout << robot.name << ": " << all.seconds << " s, " << all.nb_contacts
            << " contacts, nearest " << 1e3 * all.nearest << " mm, links "
            << 1e3 * all.nearest_links << " mm, taken " << 1e3 * all.taken << " mm, run into "
            << all.nb_run_into << " times (" << all.nb_moved_into
            << " while it moved nearer), passed " << 100.0 * all.passed / all.asked
            << " %, stopped " << all.nb_stops << " of " << all.nb_commands << ", retreats slowed "
            << all.nb_retreats_slowed << " of " << all.nb_retreats << std::endl;
  return all;
}

/// Simulates every robot. What does not move by itself is never nearer than its stop distance.
/// Below it, a retreat may take away half of the distance to an obstacle that came by itself.
void expectSafety(const SimulationOptions& options, double in_long_run, double least_passed) {
  RandomInputs random;
  double passed = 0.0, asked = 0.0;  // of all robots: one may stand in a corner for the 10 s
  std::vector<BenchmarkRobot> all = robots();
  if (all.size() == 1) all.resize(4, all.front());  // from other states
  for (const BenchmarkRobot& robot : all) {
    SCOPED_TRACE(robot.name);
    const SimulationResult result = simulate(robot, options, secondsEach(10, in_long_run), random);
    EXPECT_EQ(result.nb_contacts, 0);
    EXPECT_GE(result.nearest, 0.01 - SIMULATION_ERROR);
    EXPECT_GE(result.nearest_links, 0.002 - SIMULATION_ERROR);
    EXPECT_LE(result.taken, 0.5 * 0.01);
    EXPECT_GT(result.passed, 0.0);
    passed += result.passed;
    asked += result.asked;
  }
  EXPECT_GT(passed, least_passed * asked);
}

TEST(LimiterLaw, AmongStaticObstaclesNothingComesNearerThanTheStopDistance) {
  expectSafety({}, 3000, 0.05);
}

TEST(LimiterLaw, ARobotDoesNotMoveIntoObstaclesThatComeNoFasterThanSaid) {
  SimulationOptions options;
  options.obstacle_speed = 0.2;
  expectSafety(options, 3000, 0.05);
}

TEST(LimiterLaw, DisturbedInputCausesNoContact) {
  SimulationOptions options;
  options.obstacle_speed = 0.2;
  options.disturbed = true;
  expectSafety(options, 3000, 0.0);
}

// A box comes head-on at the speed that the law is told; it is seen 80 ms late.
TEST(LimiterLaw, AnObstacleThatComesFindsTheRobotStandingAtTheStopDistance) {
  constexpr double STEP = 0.001, PERIOD = 0.01, SPEED = 0.5, SEEN_LATE = 0.08;
  LimiterSettings settings;
  settings.deceleration = {2.0};
  settings.obstacle_speed = SPEED;
  settings.command_timeout = 0.05;
  LimiterLaw law(settings);
  const auto robot = slidingBox();
  SimulatedJoints joints({0.0}, settings.deceleration);
  double nearest = 9.0, passed = 0.0, next = 0.0;
  const auto boxNear = [&](double now) { return 4.5 - SPEED * now; };  // its face; the robot's: 0.5
  for (double now = 0.0; boxNear(now) - 0.5 - joints.positions()[0] > -0.1; now += STEP) {
    if (now >= next) {
      next = now + PERIOD;
      CertifiedSurroundings surroundings(
          sceneOf(robot, {boxAt("box", {boxNear(now - SEEN_LATE) + 0.5, 0.0, 0.0}, {1, 1, 1})}),
          {"slide_a"}, Fidelity::MESH);
      RobotState state;
      state.positions = joints.positions();
      surroundings.setState(state);
      const auto decision = published(law, {now, now, SEEN_LATE, {1.0}}, surroundings);
      passed += decision.command[0] * PERIOD;
      joints.command(now + settings.reaction_time - STEP, decision.command);
    }
    const double before = joints.positions()[0];
    joints.step(now, STEP);
    if (joints.positions()[0] > before) {
      nearest = std::min(nearest, boxNear(now + STEP) - 0.5 - joints.positions()[0]);
    }
  }
  EXPECT_GE(nearest, settings.stop_distance - SIMULATION_ERROR);
  EXPECT_GT(passed, 1.0);
}

// Goals at the end of straight paths that keep 3 cm, so that no path leads through stop_distance.
TEST(LimiterLaw, FreeGoalsAreReachedInLittleMoreTimeThanWithoutALimiter) {
  RandomInputs random;
  constexpr double KEPT = 0.03;
  const int nb_goals = isLong() ? 40 : 4;
  std::vector<double> all;
  for (const BenchmarkRobot& robot : robots()) {
    const SimulationOptions options;
    std::vector<double> ratios;
    for (int i = 0; i < nb_goals; ++i) {
      LimiterScene scene(robot, limitedJoints(robot), static_cast<std::uint64_t>(i % 4), options);
      MotionCheck check(scene.seen());
      MotionSettings settings;
      settings.only_free = settings.only_moved = true;
      settings.clearance = robot.name == "panda" || robot.name == "ur5" ? 0.5 * KEPT : KEPT;
      std::vector<double> from, to;
      do {
        from = scene.drawState(random);
        to = scene.drawState(random);
        const double share = random.uniform(0.05, 1.0);
        for (std::size_t j = 0; j < to.size(); ++j) to[j] = from[j] + share * (to[j] - from[j]);
      } while (check.check({scene.allPositions(from), scene.allPositions(to)}, settings).verdict !=
               Verdict::FREE);
      const double unlimited =
          scene.secondsTo(from, to, [](const LimiterView& view) { return view.command; });
      ratios.push_back(scene.secondsTo(from, to, ours(scene)) / unlimited);
    }
    std::sort(ratios.begin(), ratios.end());
    all.insert(all.end(), ratios.begin(), ratios.end());
    const auto nb_reached = std::count_if(ratios.begin(), ratios.end(),
                                          [](double ratio) { return std::isfinite(ratio); });
    std::cout << robot.name << ": " << nb_reached << " of " << nb_goals
              << " goals reached; time, times that of no limiter: median "
              << ratios[ratios.size() / 2] << ", 90 % " << ratios[ratios.size() * 9 / 10]
              << std::endl;
    if (isLong()) {
      EXPECT_LE(ratios[ratios.size() / 2], 1.2) << robot.name;
    }
  }
  std::sort(all.begin(), all.end());
  EXPECT_LE(all[all.size() / 2], 1.2);
}

// Positions are measured with noise, and arrive late, as those of a robot are.
TEST(LimiterLaw, UnderASteadyCommandTheRobotIsStoppedOnce) {
  RandomInputs random;
  const auto scene = sceneOf(slidingBox(), {boxAt("box", {1.3, 0.0, 0.0}, {1, 1, 1})});
  for (int run = 0; run < 8; ++run) {
    CertifiedSurroundings surroundings(scene, {"slide_a"}, Fidelity::MESH);
    LimiterSettings settings;
    settings.deceleration = {2.0};
    LimiterLaw law(settings);
    SimulatedJoints joints({0.0}, settings.deceleration);
    const double speed = random.uniform(0.05, 1.0), period = random.uniform(0.004, 0.02);
    const double noise = run == 0 ? 0.0 : random.uniform(0.0, 5e-4);  // m
    int nb_stops = 0;
    double last = 1.0, stamp = 0.0, next = 0.0;
    RobotState measured;
    measured.positions = {0.0};
    for (double now = 0.0; now < 20.0; now += 0.001) {
      if (now - stamp >= random.uniform(0.005, 0.02)) {
        stamp = now - 0.001;
        measured.positions = {joints.positions()[0] + random.uniform(-noise, noise)};
      }
      if (now >= next) {
        next = now + period;
        surroundings.setState(measured);
        const std::vector<double> command = {speed * random.uniform(0.99, 1.0)};
        const LimiterDecision decision = published(law, {now, stamp, 0.0, command}, surroundings);
        nb_stops += decision.scale == 0.0 && last > 0.0 ? 1 : 0;
        last = decision.scale;
        joints.command(now + random.uniform(0.0, settings.reaction_time - 0.001), decision.command);
      }
      joints.step(now, 0.001);
    }
    EXPECT_EQ(nb_stops, 1) << speed << " m/s, every " << period << " s, noise " << noise;
    EXPECT_GT(joints.positions()[0], 0.3 - 0.016);
    EXPECT_LT(joints.positions()[0], 0.3 - settings.stop_distance);
  }
}

TEST(LimiterLaw, FarFromEverythingTheScaleIsExactlyOne) {
  RandomInputs random;
  const auto scene = sceneOf(turningBar(), {boxAt("far", {9.0, 0.0, 0.0}, {1.0, 1.0, 1.0})});
  CertifiedSurroundings surroundings(scene, {"turn"}, Fidelity::MESH);
  LimiterSettings settings;
  settings.deceleration = {2.0};
  settings.obstacle_speed = 0.5;
  LimiterLaw law(settings);
  for (int i = 0; i < 1000; ++i) {
    RobotState state;
    state.positions = {random.uniform(-3.0, 3.0)};
    surroundings.setState(state);
    const double now = 0.01 * i;
    const std::vector<double> command = {random.uniform(-2.0, 2.0)};
    const LimiterDecision decision = published(law, {now, now - 0.005, 0.0, command}, surroundings);
    ASSERT_EQ(decision.scale, 1.0) << decision.reason;
    ASSERT_EQ(decision.command, command);
    ASSERT_EQ(decision.verdict, Verdict::FREE);
    ASSERT_EQ(decision.reason, "");
  }
}

// Random directions from states in which the law has stopped the robot.
TEST(LimiterLaw, FromEveryStopSomeCommandMovesTheRobot) {
  RandomInputs random;
  const int nb_stops = isLong() ? 250 : 5;
  for (const BenchmarkRobot& robot : robots()) {
    SCOPED_TRACE(robot.name);
    const SimulationOptions options;
    int nb_found = 0, nb_moved = 0, nb_directions = 0;
    for (std::uint64_t index = 0; nb_found < nb_stops; ++index) {
      LimiterScene scene(robot, limitedJoints(robot), index, options);
      CertifiedSurroundings surroundings(scene.seen(), scene.joints(), Fidelity::MESH);
      for (int i = 0; i < 10 && nb_found < nb_stops; ++i) {
        std::vector<double> stop;
        if (!scene.driveToAStop(random, ours(scene), stop)) continue;
        ++nb_found;
        bool moved = false;
        for (int k = 0; k < 200 && !moved; ++k) {
          ++nb_directions;
          std::vector<double> command(stop.size());
          for (double& x : command) x = random.uniform(-0.5, 0.5);
          RobotState state;
          state.positions = scene.allPositions(stop);
          surroundings.setState(state);
          LimiterLaw law(scene.settings());
          moved = law.decide({100.0, 100.0, 0.0, command}, surroundings).scale > 0.0;
        }
        nb_moved += moved ? 1 : 0;
      }
    }
    std::cout << robot.name << ": " << nb_moved << " of " << nb_found << " stops are left, after "
              << 1.0 * nb_directions / nb_found << " directions on average" << std::endl;
    EXPECT_EQ(nb_moved, nb_found);
  }
}

}  // namespace collision_pairs::test_limiter_law
