// The demo robot on its way through its motion.
#pragma once

#include "benchmark_robots.h"

namespace collision_pairs {

/// config/demo with the postures of motion.csv and 31 between each two. It has no world: post,
/// crate, ball and arch are links of its own.
BenchmarkRobot demoRobot();

}  // namespace collision_pairs
