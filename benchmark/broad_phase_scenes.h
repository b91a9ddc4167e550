// The scenes on which broad phases are compared.
#pragma once

#include <string>
#include <vector>

#include "collision_pairs/aabb.h"

namespace collision_pairs {

/// A few frames of the same boxes. From frame to frame each moving box goes a tenth of its size
/// in some direction; the first `nb_static` stand still. The smallest side is 1 m in the mean.
struct MovingScene {
  std::vector<std::vector<Aabb>> frames;
  std::size_t nb_static = 0;
};

/// uniform2, uniform10: cubes of one size spread evenly in a cube, 2 or 10 overlaps a box.
/// line: along one axis, 2 overlaps. clusters: 20 dense cubes in a large and empty one, 2.
/// plane: on a floor, 2. rods: parallel, as long as the scene and crossing none of the other two
/// axes, their centres varying most along the rods. mixed: sizes over three decades, 2.
/// static95: uniform2, 95 % of it static.
const std::vector<std::string>& sceneNames();

/// Always the same for the same arguments. Throws std::invalid_argument for an unknown name.
MovingScene makeScene(const std::string& name, std::size_t nb_boxes);

}  // namespace collision_pairs
