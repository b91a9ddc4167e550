#include "cloud_view.h"

#include "user_text.h"

namespace collision_pairs {

CloudView viewOf(const CloudConfig& config, const LatestCloud& latest, double now,
                 const std::string& topic) {
  CloudView view;
  const std::string name = "cloud '" + config.name() + "': ";
  const std::string refusal = refusalOf(latest);
  if (!latest.voxels) {
    view.problem =
        name + (refusal.empty() ? "none has arrived yet on " + topic : "none is usable" + refusal);
    return view;
  }
  const double age = now - latest.stamp;
  if (config.source_timeout > 0.0 && age > config.source_timeout) {
    view.problem = name + "the newest is " + inWords(age) + " old, and source_timeout is " +
                   inWords(config.source_timeout) + refusal;
    return view;
  }
  view.voxels = latest.voxels;
  view.stamp = latest.stamp;
  if (!latest.warning.empty()) view.warning = name + latest.warning;
  if (!latest.problem.empty()) {
    view.problem = name + "the last was refused: " + latest.problem;
  } else if (latest.voxels->isTruncated()) {
    view.problem = name + "more than max_voxels (" + std::to_string(config.max_voxels) +
                   ") voxels are occupied, or some are out of range: the farthest are left out";
  } else if (!latest.may_touch.empty()) {
    view.problem =
        name + "something " + latest.may_touch + "; if it is gone, ~clear_clouds starts anew";
  }
  return view;
}

std::vector<SuspectCloud> addVoxels(const std::map<std::string, CloudView>& views,
                                    const CollisionScene& scene, BodyPoses& poses) {
  std::vector<SuspectCloud> suspect;
  poses.voxels.clear();
  for (const SceneCloud& cloud : scene.clouds()) {
    const std::string& name = scene.models()[cloud.model].name;
    const auto view = views.find(name);
    const bool has_view = view != views.end();
    poses.voxels.push_back(has_view ? view->second.voxels : nullptr);
    const std::string why = has_view ? view->second.problem : "cloud '" + name + "' has no source";
    if (why.empty()) continue;
    suspect.push_back({name, why});
    poses.unknown_because.push_back(why);
  }
  return suspect;
}

std::string refusalOf(const LatestCloud& latest) {
  return latest.problem.empty() ? "" : "; the last was refused: " + latest.problem;
}

}  // namespace collision_pairs
