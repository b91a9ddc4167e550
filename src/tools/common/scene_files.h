// Robots and scenes from files, options and bags; errors name the source.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "bag_index.h"
#include "cloud_config.h"
#include "collision_pairs/collision_scene.h"
#include "command_line.h"
#include "joint_states_csv.h"
#include "scene_sources.h"

namespace collision_pairs {

/// Warns of ineffective content. Throws InputError.
std::shared_ptr<const RobotModel> readRobot(const std::string& path);

/// Paths, or values as of the node's parameters with these names.
struct SceneOptions {
  std::string urdf, srdf;  ///< empty: none, or that of the bag
  std::string world, settings, group, narrow_phase;
  std::string fidelity = "mesh";
  std::string broad_phase = "auto";
  int max_hull_vertices = 0;  ///< 0: as in the settings
  std::vector<std::string> links;
  std::string cloud;  ///< a PCD file; empty: none
  double voxel_size = 0.0;
  std::vector<std::string> cloud_topics;  ///< recorded clouds that are obstacles
};

void declareScene(CommandLine& command_line, SceneOptions& options);
void declareFidelity(CommandLine& command_line, SceneOptions& options);
void declareBroadPhase(CommandLine& command_line, SceneOptions& options);
/// Options of tools that check configurations of a robot: the robot, --srdf, the scene, --cloud and
/// --voxel-size (see readCloud()), --fidelity.
void declareRobot(CommandLine& command_line, SceneOptions& options);

/// The names of two models as written in a list of a table, "a|b".
std::string listedPair(const CollisionScene& scene, std::uint32_t first, std::uint32_t second);

/// The voxels of the cloud of the options, for a scene with the same options; none if there is no
/// --cloud, or nothing is checked against it. Reports the number of points that are not finite.
/// Throws InputError.
CloudVoxels readCloud(const SceneOptions& options, const CollisionScene& scene);

/// The scene of one robot from files, prepared for `fidelity`. Warns of unknown links in the SRDF.
/// Throws InputError, also for a mesh that cannot be used: a tool checks everything or nothing.
std::shared_ptr<const CollisionScene> buildScene(const SceneOptions& options, Fidelity fidelity);

/// Warns of joints without a column, and of positions outside joint limits. `what`: as in
/// outsideLimits().
void warnOf(const JointStates& states, const RobotModel& robot, const std::string& what);

void declareThreads(CommandLine& command_line, unsigned& threads);
/// Options --threads and --out of a tool that writes row by row.
void declareBatch(CommandLine& command_line, unsigned& threads, std::string& out);

/// The texts from files, or from the bag's own contents where no file is given; an SRDF with an
/// empty origin means none.
struct BagRobot {
  TextFrom urdf, srdf;
};
/// Throws InputError if there is no robot, or more than one to choose from, or if what is chosen
/// changes within the bag.
BagRobot robotOf(const BagIndex& bag, const SceneOptions& options);
/// Throws InputError; tells what is ineffective.
SceneSources sourcesOf(const BagRobot& robot, const SceneOptions& options, const Warn& tell);

/// What the options say of any scene: narrow phase, hulls, restriction. Reads the meshes.
void apply(const SceneOptions& options, SceneSources& sources);

/// Throws InputError for a mesh that could not be used. `urdf`, `world`: where they are from.
void requireWhole(const SceneDescription& scene, const std::string& urdf, const std::string& world);
/// Tells what the scene does not check; throws InputError if the options leave no pair.
void reviewScene(const CollisionScene& scene, const SceneOptions& options, const Warn& tell);

}  // namespace collision_pairs
