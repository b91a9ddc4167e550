// Sources of scenes as users provide them: robot descriptions, whose meshes are loaded when a scene
// needs them, a world, and settings.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "collision_pairs/mesh_loader.h"
#include "scene_config.h"
#include "text_files.h"

namespace collision_pairs {

/// With all meshes. Warns of ineffective content. Errors and warnings name the origin.
std::shared_ptr<const RobotModel> robotFrom(const TextFrom& urdf, const Warn& warn);

/// Warns of links that the robot does not have, and of another robot's name. Errors and warnings
/// name the origin.
Srdf srdfFrom(const TextFrom& xml, const RobotModel& robot, const Warn& warn);

/// A robot. Reads the URDF immediately, and each mesh when a link that has it is first requested.
/// Loaded meshes are kept.
class RobotSource {
 public:
  /// Throws InputError as RobotModel::fromUrdf(), except for meshes, of which only the names are
  /// read.
  RobotSource(const std::string& urdf, MeshLoader load_mesh);

  /// The text that it was read from.
  const std::string& urdf() const { return urdf_; }

  /// The robot with a small placeholder for each mesh: usable for everything except its geometry.
  const std::shared_ptr<const RobotModel>& skeleton() const { return skeleton_; }

  /// The robot with the geometry of the links for which `wanted` is true, and of those that were
  /// wanted before. Returns the same model if nothing is new. A mesh that cannot be used is
  /// Link::missing.
  const std::shared_ptr<const RobotModel>& withGeometryOf(
      const std::function<bool(const std::string& link)>& wanted);

 private:
  struct Reference {
    std::string uri;
    Eigen::Vector3d scale;
  };

  std::vector<Element> load(const Link& link, std::vector<std::string>& missing);

  std::string urdf_;
  MeshLoader load_mesh_;
  std::map<const TriangleMesh*, Reference> references_;  // by placeholder
  std::shared_ptr<const RobotModel> skeleton_;
  std::shared_ptr<const RobotModel> loaded_;
  std::vector<char> has_geometry_;  // by link: in loaded_
};

/// Warns of ineffective content. Errors and warnings name the origin.
std::unique_ptr<RobotSource> robotSource(const TextFrom& urdf, const MeshLoader& load_mesh,
                                         const Warn& warn);

/// Loaded meshes are kept.
struct SceneSources {
  struct Robot {
    std::unique_ptr<RobotSource> source;
    std::optional<Srdf> srdf;
    std::string prefix;
    std::string srdf_text = {};  ///< of readSrdf()

    /// Of `source`. Warns of ineffective content, and of another robot's name. Errors and warnings
    /// name the origin.
    void readSrdf(const TextFrom& xml, const Warn& warn);
  };
  std::vector<Robot> robots;
  std::unique_ptr<RobotSource> world;  ///< null: none
  std::vector<RigidObject> clouds;     ///< made by cloudOf()
  SceneConfig config;
  std::string settings_text;  ///< of readSettings()

  /// With the obstacles of its clouds. Throws as readSceneSettings().
  void readSettings(const TextFrom& yaml);
  /// In place of those of the settings; with their obstacles.
  void setClouds(std::vector<CloudConfig> configs);
};

/// With the geometry of only those links that are in some pair; the meshes of others are not read.
/// `objects` are added to the configured floor; `restriction` replaces the configured one unless it
/// is empty. Throws InputError.
SceneDescription describeScene(SceneSources& sources, std::vector<RigidObject> objects,
                               const Restriction& restriction);

}  // namespace collision_pairs
