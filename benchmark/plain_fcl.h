// FCL as one calls it who knows nothing of its traps: default requests, lengths in metres, signed
// distance. In a process of its own, which is started again where FCL ended it.
#pragma once

#include <vector>

#include <Eigen/Geometry>

#include "collision_pairs/shape.h"

namespace collision_pairs {

struct PlainQuestion {
  const Shape *a, *b;
  Eigen::Isometry3d X_AB;
};

struct PlainAnswer {
  enum class End { ANSWERED, THREW, ABORTED, HUNG };
  End end = End::HUNG;
  bool collides = false;
  double distance = 0.0;
  double collide_ns = 0.0, distance_ns = 0.0;
};

/// One a question. HUNG is what took two seconds. No half-spaces.
std::vector<PlainAnswer> askPlainFcl(const std::vector<PlainQuestion>& questions);

}  // namespace collision_pairs
