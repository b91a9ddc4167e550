#include "bag_scenes.h"

#include <map>

#include "collision_pairs/input_error.h"
#include "text_files.h"

namespace collision_pairs {
namespace {

/// Of a file, or else the bag's only one; empty if there is neither.
TextFrom chooseText(const std::string& path, const std::map<std::string, std::string>& in_bag,
                    const std::string& option) {
  if (!path.empty()) return {path, readTextFile(path)};
  if (in_bag.empty()) return {};
  if (in_bag.size() > 1) {
    throw InputError("several robots in it (" + in_bag.begin()->first + ", " +
                     std::next(in_bag.begin())->first + "); choose one with " + option);
  }
  return {"topic " + in_bag.begin()->first, in_bag.begin()->second};
}

}  // namespace

std::shared_ptr<const CollisionScene> BagScenes::sceneFor(const BagContents& bag) {
  const TextFrom urdf = chooseText(urdf_path_, bag.urdfs, "--urdf");
  if (urdf.origin.empty()) throw InputError("there is no robot_description in it; give --urdf");
  const TextFrom srdf = chooseText(srdf_path_, bag.srdfs, "--srdf");
  if (scene_ && urdf.content == urdf_ && srdf.content == srdf_) return scene_;
  scene_ = buildScene(urdf, srdf, options_, Fidelity::MESH, 0);
  urdf_ = urdf.content;
  srdf_ = srdf.content;
  return scene_;
}

}  // namespace collision_pairs
