// Publishes each cycle's report, the Bool, and the markers for rviz.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <optional>

#include <collision_pairs/CollisionPairs.h>
#include <ros/node_handle.h>
#include <ros/publisher.h>

#include "collision_pairs/collision_detector.h"
#include "markers.h"
#include "scene_store.h"

namespace collision_pairs {

/// Used by the cycle's thread only.
class ReportPublisher {
 public:
  /// `release` frees an old scene on a thread where that may take long.
  ReportPublisher(const ros::NodeHandle& private_node,
                  std::function<void(std::shared_ptr<const void>)> release);

  /// Publishes the report and the Bool, with the same verdict.
  void publish(const CollisionPairs& message);

  /// The boxes of the report, the verdict of the message and the limit, for subscribers. `report`
  /// may be null: then there is no box. They expire a few periods [s] after the last, so that
  /// markers of a dead node disappear.
  void publishMarkers(const CollisionPairs& message, const CollisionReport* report,
                      bool only_investigated, const std::optional<ShownLimit>& limit,
                      double period);
  bool showsMarkers() const { return markers_.getNumSubscribers() > 0; }

  /// The shapes of the scene: published only if it changed, for a new subscriber, or when TF has
  /// more of its bodies (rviz moves them), and a few times again in the half minute after that.
  /// nb_known: bodies with a pose.
  void publishScene(const ActiveScenePtr& scene, Fidelity fidelity, std::size_t nb_known);

  /// The occupied voxels, some times a second. `boxes`: of the scene's elements in
  /// W; voxels within `reach` of a moving one, or 0.1 m if that is more, are coloured by it.
  void publishVoxels(const ActiveScene& scene, const BodyPoses& poses,
                     const std::vector<Aabb>& boxes, double reach);

 private:
  ros::Publisher pairs_, in_collision_, markers_, scene_markers_;
  std::function<void(std::shared_ptr<const void>)> release_;
  ActiveScenePtr shown_scene_;
  Fidelity shown_fidelity_ = Fidelity::MESH;
  std::size_t nb_shown_ = 0;   // bodies with a pose then
  double repeat_after_ = 0.0;  // s
  ros::SteadyTime show_scene_from_, next_repeat_, next_voxels_;
};

}  // namespace collision_pairs
