// The options that say what is in a scene, which tools share.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "collision_pairs/collision_scene.h"

namespace collision_pairs {

/// Paths, or what the node's parameters of these names say.
struct SceneOptions {
  std::string world, settings, group;
  std::vector<std::string> links;
};

void declareScene(CLI::App& app, SceneOptions& options);

/// A text and what it came from: a file, or a topic of a bag; for messages.
struct TextFrom {
  std::string origin, content;
};

/// The scene of one robot. An SRDF without origin is none. `fidelity` and `max_hull_vertices`
/// (where it is not 0) stand for those of the settings. Unknown links of the SRDF are warned of.
/// Throws InputError, also for a mesh that cannot be used: a tool checks everything or nothing.
std::shared_ptr<const CollisionScene> buildScene(const TextFrom& urdf, const TextFrom& srdf,
                                                 const SceneOptions& options, Fidelity fidelity,
                                                 int max_hull_vertices);

}  // namespace collision_pairs
