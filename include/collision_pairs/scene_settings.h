// What a scene prepares for its checks.
#pragma once

#include <cstddef>
#include <functional>
#include <map>
#include <string>

#include "collision_pairs/fidelity.h"

namespace collision_pairs {

struct SceneSettings {
  /// The dearest geometry that a check of this scene may ask for; what asks for more gets this.
  /// Rungs above it are not prepared.
  Fidelity fidelity = Fidelity::MESH;
  /// The same for single links, by name (of the robot or the world); others: `fidelity`. A pair is
  /// checked at the cheapest of what its two links and the request say, so a link's rung above
  /// what all its partners have is not prepared either. PairReport says which rung it was.
  std::map<std::string, Fidelity> link_fidelity;
  /// Hulls of the `convex` rung have at most this many vertices and are grown so that they still
  /// enclose; >= 4, or 0: exact hulls. Fewer are faster and stick out further.
  int max_hull_vertices = 0;
  /// Called, from several threads, whenever one more of `total` meshes is prepared. May be empty.
  std::function<void(std::size_t done, std::size_t total)> progress;
};

}  // namespace collision_pairs
