// Robots and scenes from files, options and bags; errors name the source.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "bag_reader.h"
#include "cloud_config.h"
#include "collision_pairs/collision_scene.h"
#include "command_line.h"
#include "joint_states_csv.h"

namespace collision_pairs {

/// Warns of what in it means nothing. Throws InputError.
std::shared_ptr<const RobotModel> readRobot(const std::string& path, const MeshLoader& load_mesh);
/// Nothing for an empty path. Warns of links that the robot does not have. Throws InputError.
std::optional<Srdf> readSrdf(const std::string& path, const RobotModel& robot);

/// Paths, or what the node's parameters of these names say.
struct SceneOptions {
  std::string world, settings, group, narrow_phase;
  std::vector<std::string> links;
  std::string cloud;  ///< a PCD file; empty: none
  double voxel_size = 0.0;
  std::vector<std::string> cloud_topics;  ///< recorded clouds that are obstacles
};

void declareScene(CommandLine& command_line, SceneOptions& options);
void declareFidelity(CommandLine& command_line, std::string& fidelity);
/// What tools that answer for configurations of a robot take: it, --srdf, the scene, --cloud and
/// --voxel-size (of which readCloud() makes what a check wants), --fidelity.
void declareRobot(CommandLine& command_line, std::string& robot, std::string& srdf,
                  SceneOptions& options, std::string& fidelity);

/// The names of two models as they stand in a list of a table, "a|b".
std::string listedPair(const CollisionScene& scene, std::uint32_t first, std::uint32_t second);

/// What the cloud of the options shows, for a scene of the same: none if there is no --cloud, or
/// nothing is checked against it. Says how many points are not finite. Throws InputError.
CloudVoxels readCloud(const SceneOptions& options, const CollisionScene& scene);

/// A text and what it came from: a file, or a topic of a bag; for messages.
struct TextFrom {
  std::string origin, content;
};

/// A scene, and what it was made of.
struct BuiltScene {
  std::shared_ptr<const CollisionScene> scene;
  SceneDescription description;
  std::vector<CloudConfig> clouds;  ///< of SceneOptions::cloud_topics
};

/// The scene of one robot. An SRDF without origin is none. `fidelity` and `max_hull_vertices`
/// (where it is not 0) stand for those of the settings. Unknown links of the SRDF are warned of.
/// Throws InputError, also for a mesh that cannot be used: a tool checks everything or nothing.
BuiltScene buildScene(const TextFrom& urdf, const TextFrom& srdf, const SceneOptions& options,
                      Fidelity fidelity, int max_hull_vertices);

/// The same of files; an empty path of an SRDF is none.
std::shared_ptr<const CollisionScene> buildScene(const std::string& urdf_path,
                                                 const std::string& srdf_path,
                                                 const SceneOptions& options, Fidelity fidelity,
                                                 int max_hull_vertices);

/// Of joints without a column, and of positions outside the limits of joints. `what`: as in
/// outsideLimits().
void warnOf(const JointStates& states, const RobotModel& robot, const std::string& what);

void declareThreads(CommandLine& command_line, unsigned& threads);
/// --threads and --out of a tool that answers row by row.
void declareBatch(CommandLine& command_line, unsigned& threads, std::string& out);

/// Builds a scene from files or, where none is given, from what the bag itself says. Bags in a row
/// with the same robot share it.
class BagScenes {
 public:
  /// Empty paths: from the bag.
  BagScenes(std::string urdf_path, std::string srdf_path, SceneOptions options)
      : urdf_path_(std::move(urdf_path)),
        srdf_path_(std::move(srdf_path)),
        options_(std::move(options)) {}

  /// Throws InputError, also if there is no robot or more than one to choose from.
  const BuiltScene& sceneFor(const BagContents& bag);

 private:
  std::string urdf_path_, srdf_path_;
  SceneOptions options_;
  std::string urdf_, srdf_;  ///< what scene_ was made of
  BuiltScene built_;
};

}  // namespace collision_pairs
