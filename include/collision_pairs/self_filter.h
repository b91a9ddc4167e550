// Which points of a cloud are the robot itself.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "collision_pairs/body_poses.h"
#include "collision_pairs/collision_scene.h"
#include "collision_pairs/scene_description.h"

namespace collision_pairs {

/// A point is the robot's own if it lies inside a link of a robot or an object attached to one, or
/// no further than `padding` from it. All links with geometry count, also those on no allowed pair
/// and those that the settings ignore; a world and static objects do not. Shapes are taken as they
/// are (MESH), whatever fidelity the scene has.
///
/// Exact but for rounding, and never the other way around: a point further than padding + 1e-6 m
/// is kept, one no further than the padding is not.
///
///   filter.begin(poses);
///   if (!filter.isOwn(p_WP)) grid.add(p_WP);
///
/// Cost: some nanoseconds for a point far from every link; near one, a look at cells about the
/// link (in its own frame, so they hold at every posture) of which it is known that all of their
/// points, or none, are its own; an exact distance, about a microsecond, at the border between, and
/// the first time that a cell is met. Remembers cells only: the answer depends on the poses alone.
/// One per thread.
class SelfFilter {
 public:
  /// padding in metres, >= 0, else InputError. Meshes that `cache` has are not prepared again.
  SelfFilter(const SceneDescription& description, double padding, SceneCache* cache = nullptr);
  ~SelfFilter();
  SelfFilter(SelfFilter&&) noexcept;
  SelfFilter& operator=(SelfFilter&&) noexcept;

  /// The bodies whose poses it wants; `body` is one of the robot's (RobotModel::bodies() of a scene
  /// of the same description). More than those of the scene, if links are on no allowed pair.
  const std::vector<SceneBody>& bodies() const;

  /// Starts a cloud: poses of bodies() at the instant at which it was seen. Throws InputError if
  /// there are more or fewer. Links of bodies without a known, finite pose filter nothing.
  void begin(const BodyPoses& poses);
  /// The links and objects that filter nothing since begin(): points of theirs look like obstacles.
  const std::vector<std::string>& leftOut() const;

  bool isOwn(const Eigen::Vector3d& p_WP);

 private:
  struct Store;
  std::unique_ptr<Store> store_;
};

}  // namespace collision_pairs
