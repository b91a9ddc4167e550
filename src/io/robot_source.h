// A robot whose meshes are loaded when a scene needs them.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "collision_pairs/robot_model.h"

namespace collision_pairs {

/// Reads the URDF at once, and each mesh the first time that a link is asked for that has it. What
/// is loaded stays.
class RobotSource {
 public:
  /// Throws InputError as RobotModel::fromUrdf() does, except that of meshes it knows only names.
  RobotSource(const std::string& urdf, MeshLoader load_mesh);

  /// The robot with a small stand-in for each mesh: good for everything but its geometry.
  const std::shared_ptr<const RobotModel>& skeleton() const { return skeleton_; }

  /// The robot with the geometry of the links for which `wanted` is true, and of those that were
  /// wanted before. The same model again if that is nothing new. A mesh that cannot be used is
  /// left out and listed in broken().
  const std::shared_ptr<const RobotModel>& withGeometryOf(
      const std::function<bool(const std::string& link)>& wanted);

  /// Of the links that have been wanted.
  const std::vector<BrokenElement>& broken() const { return broken_; }

 private:
  struct Reference {
    std::string uri;
    Eigen::Vector3d scale;
  };

  std::vector<Element> load(const Link& link);

  MeshLoader load_mesh_;
  std::map<const TriangleMesh*, Reference> references_;  // by stand-in
  std::shared_ptr<const RobotModel> skeleton_;
  std::shared_ptr<const RobotModel> loaded_;
  std::vector<char> has_geometry_;  // by link: in loaded_
  std::vector<BrokenElement> broken_;
};

}  // namespace collision_pairs
