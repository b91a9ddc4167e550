// The scene that the node works with at present.
#pragma once

#include <memory>
#include <string>

#include "scene_loader.h"
#include "tf_poses.h"

namespace collision_pairs {

/// A scene with what the node knows of it. Replaced as a whole; whoever holds one may go on.
struct ActiveScene {
  LoadedScene loaded;
  std::string frame;  ///< of reports and markers
  std::unique_ptr<TfPoses> tf_poses;
};
using ActiveScenePtr = std::shared_ptr<const ActiveScene>;

}  // namespace collision_pairs
