#include "check_input.h"

#include <string>

#include "collision_pairs/input_error.h"
#include "collision_pairs/occupied_voxels.h"

namespace collision_pairs {

void checkSettings(const CheckSettings& settings) {
  if (!(settings.alarm_distance >= 0.0 && settings.alarm_distance <= MAX_REACH)) {
    throw InputError("the alarm distance is " + std::to_string(settings.alarm_distance) +
                     ", but must be 0 or more metres, and finite");
  }
  if (!(settings.tolerance >= 0.0 && settings.tolerance <= MAX_REACH)) {
    throw InputError("the tolerance is " + std::to_string(settings.tolerance) +
                     ", but must be 0 or more metres, and finite");
  }
  if (!(settings.time_budget >= 0.0)) {
    throw InputError("the time budget is " + std::to_string(settings.time_budget) +
                     ", but must be 0 or more seconds");
  }
}

void checkVoxels(const CollisionScene& scene, const CloudVoxels& voxels) {
  const auto& clouds = scene.clouds();
  if (voxels.size() > clouds.size()) {
    throw InputError("voxels of " + std::to_string(voxels.size()) +
                     " clouds were given, but the scene has " + std::to_string(clouds.size()));
  }
  for (std::size_t i = 0; i < voxels.size(); ++i) {
    const double wanted = clouds[i].voxel_size;
    if (!voxels[i] || voxels[i]->voxelSize() == wanted) continue;
    throw InputError("cloud '" + scene.models()[clouds[i].model].name + "' has voxels of " +
                     std::to_string(wanted) + " m, but those given are of " +
                     std::to_string(voxels[i]->voxelSize()) + " m");
  }
}

void checkInput(const CollisionScene& scene, const BodyPoses& poses,
                const CheckSettings& settings) {
  checkSettings(settings);
  if (settings.selection && &settings.selection->scene() != &scene) {
    throw InputError("the selection is of another scene: make one for each scene");
  }
  const std::size_t expected = scene.bodies().size();
  if (poses.X_WB.size() != expected || poses.known.size() != expected) {
    throw InputError("poses of " + std::to_string(poses.X_WB.size()) + " bodies were given, and " +
                     std::to_string(poses.known.size()) +
                     " of them are said to be known or not, but the scene has " +
                     std::to_string(expected));
  }
  checkVoxels(scene, poses.voxels);
}

}  // namespace collision_pairs
