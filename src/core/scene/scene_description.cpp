#include "collision_pairs/scene_description.h"

namespace collision_pairs {

RigidObject floorAt(double height, std::vector<std::string> touch_links) {
  RigidObject floor;
  floor.name = "floor";
  floor.elements.push_back({HalfSpace{}, Eigen::Isometry3d::Identity()});
  floor.X_PO.translation().z() = height;
  floor.touch_links = std::move(touch_links);
  return floor;
}

}  // namespace collision_pairs
