// Which robot a bag is about.
#pragma once

#include <memory>
#include <string>

#include "bag_reader.h"
#include "scene_options.h"

namespace collision_pairs {

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
  std::shared_ptr<const CollisionScene> sceneFor(const BagContents& bag);

 private:
  std::string urdf_path_, srdf_path_;
  SceneOptions options_;
  std::string urdf_, srdf_;  ///< what scene_ was made of
  std::shared_ptr<const CollisionScene> scene_;
};

}  // namespace collision_pairs
