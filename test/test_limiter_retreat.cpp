// What the limiter's law lets a robot do that is nearer than stop_distance: lead away, and nothing
// else.
#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

#include <gtest/gtest.h>

#include "benchmark/simulated_joints.h"
#include "certified_surroundings.h"
#include "collision_pairs/occupied_voxels.h"
#include "motion_fixtures.h"
#include "published_decisions.h"
#include "random_inputs.h"

namespace collision_pairs::test_limiter_retreat {

/// Tells a robot of one joint to move for so long: a decision each 10 ms, which takes effect as
/// late as the law expects. Calls visit(position) after each step.
template <class Visit>
void drive(const LimiterSettings& settings, CertifiedSurroundings& surroundings, RobotState state,
           double command, double seconds, const Visit& visit) {
  constexpr double STEP = 0.001, PERIOD = 0.01;
  LimiterLaw law(settings);
  SimulatedJoints joints(state.positions, settings.deceleration);
  for (double now = 0.0, next = 0.0; now < seconds; now += STEP) {
    if (now >= next) {
      next = now + PERIOD;
      state.positions = joints.positions();
      surroundings.setState(state);
      joints.command(now + settings.reaction_time - STEP,
                     published(law, {now, now, 0.0, {command}}, surroundings).command);
    }
    joints.step(now, STEP);
    visit(joints.positions()[0]);
  }
}

/// Metres that the box moves, from a voxel that touches it to another of the same cloud, which
/// begins at `gap` before it.
double movedFromContact(double gap, double reaction_time) {
  constexpr double SIZE = 0.01;
  SceneDescription description = described(slidingBox(), {});
  description.clouds.push_back(cloudOf("camera", SIZE, {}));
  CertifiedSurroundings surroundings(CollisionScene::build(description), {"slide_a"},
                                     Fidelity::MESH);
  const int ahead = static_cast<int>(std::lround((0.5 + gap) / SIZE));
  RobotState state;
  state.positions = {-1e-4};
  state.voxels = {std::make_shared<const OccupiedVoxels>(
      SIZE, std::vector<VoxelCell>{{-51, 0, 0}, {ahead, 0, 0}})};
  LimiterSettings settings;
  settings.deceleration = {2.0};
  settings.reaction_time = reaction_time;
  double reached = 0.0;
  drive(settings, surroundings, state, 1.0, 10.0,
        [&](double x) { reached = std::max(reached, x); });
  return reached;
}

// The pair's derivative only knows of the nearest voxel, and until that is 1 mm away nothing of
// the pair can be certified.
TEST(Retreat, FromContactDoesNotEndAtAnotherPartOfTheSameModel) {
  for (const double reaction_time : {0.05, 0.1, 0.2}) {
    for (const double gap : {0.02, 0.03, 0.04, 0.06}) {
      const double moved = movedFromContact(gap, reaction_time);
      EXPECT_GT(moved, 0.01) << gap;
      EXPECT_LT(moved, gap - 0.5 * LimiterSettings().stop_distance) << reaction_time;
    }
  }
}

/// The least gap, metres, between a floor and a plate of 1 m that is told to turn about an axis
/// near one of its edges, from a state in which this edge is nearest to the floor: it rises, and
/// the other falls, 50 times as fast.
double leastGapOfATurningPlate(double gap, double tilt, double reaction_time) {
  constexpr double HALF = 0.01, SHORT = 0.02, LONG = 0.98;
  const auto lowest = [](double angle) {
    return std::min(-SHORT * std::sin(angle), LONG * std::sin(angle)) - HALF * std::cos(angle);
  };
  const double floor = lowest(tilt) - gap;
  const auto robot =
      robotFrom(emptyLink("root") +
                linkWith("plate", "<box size='1 0.02 0.02'/>", "<origin xyz='0.48 0 0'/>") +
                hinge("turn", "root", "plate", "0 0 0"));
  CertifiedSurroundings surroundings(
      sceneOf(robot, {boxAt("floor", {0.0, floor - 0.5, 0.0}, {9.0, 1.0, 9.0})}), {"turn"},
      Fidelity::MESH);
  LimiterSettings settings;
  settings.deceleration = {2.0};
  settings.reaction_time = reaction_time;
  RobotState state;
  state.positions = {tilt};
  double least = gap;
  drive(settings, surroundings, state, -0.5, 5.0,
        [&](double angle) { least = std::min(least, lowest(angle) - floor); });
  return least;
}

// The derivative of the distance is that of the nearest edge alone.
TEST(Retreat, OfAPlateFromNearAFloorDoesNotPressItsOtherEdgeOntoIt) {
  RandomInputs random;
  for (int i = 0; i < 60; ++i) {
    const double gap = random.uniform(i % 3 == 0 ? -1e-4 : 2.5e-5, 9.9e-4);
    const double tilt = random.uniform(0.0003, 0.006), reaction_time = random.uniform(0.02, 0.2);
    const double least = leastGapOfATurningPlate(gap, tilt, reaction_time);
    // From contact: no deeper, but for what depths may be off.
    EXPECT_GT(least, gap >= 2e-5 ? 0.0 : std::min(gap, 0.0) - 2e-4)
        << gap << " m, " << tilt << " rad, " << reaction_time << " s";
  }
}

TEST(Retreat, FromAnyDistanceMoves) {
  const auto robot = slidingBox();
  for (const double gap : {-1e-3, 0.0, 1e-5, 2.1e-5, 1e-4, 5e-4, 9e-4, 2e-3, 9e-3}) {
    CertifiedSurroundings surroundings(
        sceneOf(robot, {boxAt("box", {1.0 + gap, 0.0, 0.0}, {1, 1, 1})}), {"slide_a"},
        Fidelity::MESH);
    LimiterSettings settings;
    settings.deceleration = {2.0};
    RobotState state;
    state.positions = {0.0};
    double x = 0.0, most = 0.0;
    drive(settings, surroundings, state, -0.3, 3.0, [&](double position) {
      x = position;
      most = std::max(most, position);
    });
    EXPECT_EQ(most, 0.0) << gap;
    EXPECT_LT(x, -0.1) << gap;
  }
}

}  // namespace collision_pairs::test_limiter_retreat
