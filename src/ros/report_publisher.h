// What the node tells of each cycle: the report, the Bool, and the markers for rviz.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>

#include <collision_pairs/CollisionPairs.h>
#include <ros/node_handle.h>
#include <ros/publisher.h>

#include "active_scene.h"
#include "collision_pairs/collision_detector.h"

namespace collision_pairs {

/// For the cycle's thread alone.
class ReportPublisher {
 public:
  /// `release` lets go of an old scene, somewhere where that may take its time.
  ReportPublisher(const ros::NodeHandle& private_node,
                  std::function<void(std::shared_ptr<const void>)> release);

  /// The report and the Bool. Both say the same of the same instant.
  void publish(const CollisionPairs& message);

  /// The boxes of the report and the verdict of the message, for subscribers. `report` may be
  /// null: then there is the verdict only. They fade some periods [s] after the last: what a node
  /// said before it died must not stay in sight.
  void publishMarkers(const CollisionPairs& message, const CollisionReport* report,
                      bool only_investigated, double period);

  /// The shapes of the scene: only when it is another, somebody new looks at it, or TF has come to
  /// know more of it (rviz moves what moves). nb_known: bodies with a pose.
  void publishScene(const ActiveScenePtr& scene, Fidelity fidelity, std::size_t nb_known);

  /// What is occupied, beside the scene, some times a second. `boxes`: of the scene's elements in
  /// W; voxels within `reach` of a moving one, or 0.1 m if that is more, are coloured by it.
  void publishVoxels(const ActiveScene& scene, const BodyPoses& poses,
                     const std::vector<Aabb>& boxes, double reach);

 private:
  ros::Publisher pairs_, in_collision_, markers_, scene_markers_;
  std::function<void(std::shared_ptr<const void>)> release_;
  ActiveScenePtr shown_scene_;
  Fidelity shown_fidelity_ = Fidelity::MESH;
  std::size_t nb_shown_ = 0;  // bodies with a pose then
  ros::SteadyTime show_scene_from_, next_voxels_;
};

}  // namespace collision_pairs
