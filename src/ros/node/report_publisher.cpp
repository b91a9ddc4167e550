#include "report_publisher.h"

#include <algorithm>
#include <utility>

#include <std_msgs/Bool.h>
#include <visualization_msgs/MarkerArray.h>

#include "scene_markers.h"

namespace collision_pairs {
namespace {

// Seconds for rviz to receive the frames: it drops markers that come before them.
constexpr double SUBSCRIBER_WARM_UP = 1.0;
// Seconds, doubled from one to the next, after which a scene is shown again: frames may come later,
// and a busy rviz drops what waits in its queue.
constexpr double FIRST_REPEAT = 2.0, LAST_REPEAT = 16.0;
constexpr double SHORTEST_LIFE = 2.0;  // s, lifetime of a marker
const ros::WallDuration VOXEL_PERIOD(0.2);
constexpr double LEAST_COLOURED = 0.1;  // m

}  // namespace

ReportPublisher::ReportPublisher(const ros::NodeHandle& private_node,
                                 std::function<void(std::shared_ptr<const void>)> release)
    : release_(std::move(release)) {
  ros::NodeHandle node(private_node);
  pairs_ = node.advertise<CollisionPairs>("collision_pairs", 1);
  in_collision_ = node.advertise<std_msgs::Bool>("in_collision", 1);
  markers_ = node.advertise<visualization_msgs::MarkerArray>("markers", 1);
  scene_markers_ = node.advertise<visualization_msgs::MarkerArray>(
      "scene_markers", 1, [this](const ros::SingleSubscriberPublisher&) {
        release_(std::exchange(shown_scene_, nullptr));
        show_scene_from_ = ros::SteadyTime::now() + ros::WallDuration(SUBSCRIBER_WARM_UP);
      });
}

void ReportPublisher::publish(const CollisionPairs& message) {
  pairs_.publish(message);
  std_msgs::Bool in_collision;
  in_collision.data = message.in_collision;
  in_collision_.publish(in_collision);
}

void ReportPublisher::publishMarkers(const CollisionPairs& message, const CollisionReport* report,
                                     bool only_investigated, const std::optional<ShownLimit>& limit,
                                     double period) {
  if (!showsMarkers()) return;
  visualization_msgs::MarkerArray array = toMarkers(message, report, only_investigated, limit);
  for (auto& marker : array.markers) {
    marker.lifetime = ros::Duration(std::max(SHORTEST_LIFE, 3.0 * period));
  }
  markers_.publish(array);
}

void ReportPublisher::publishScene(const ActiveScenePtr& scene, Fidelity fidelity,
                                   std::size_t nb_known) {
  const bool is_shown =
      shown_scene_ == scene && shown_fidelity_ == fidelity && nb_known <= nb_shown_;
  const ros::SteadyTime now = ros::SteadyTime::now();
  if (is_shown && (repeat_after_ > LAST_REPEAT || now < next_repeat_)) return;
  if (scene_markers_.getNumSubscribers() == 0 || now < show_scene_from_) return;
  repeat_after_ = is_shown ? 2.0 * repeat_after_ : FIRST_REPEAT;
  next_repeat_ = now + ros::WallDuration(repeat_after_);
  next_voxels_ = now + VOXEL_PERIOD;  // in a queue of one they would take its place
  release_(std::exchange(shown_scene_, scene));
  shown_fidelity_ = fidelity;
  nb_shown_ = nb_known;
  scene_markers_.publish(toSceneMarkers(*scene->scene, fidelity, scene->frame));
}

void ReportPublisher::publishVoxels(const ActiveScene& active, const BodyPoses& poses,
                                    const std::vector<Aabb>& boxes, double reach) {
  const CollisionScene& scene = *active.scene;
  const ros::SteadyTime now = ros::SteadyTime::now();
  if (scene.clouds().empty() || scene_markers_.getNumSubscribers() == 0) return;
  if (now < next_voxels_ || now < show_scene_from_) return;
  next_voxels_ = now + VOXEL_PERIOD;
  const std::vector<Aabb> moving(boxes.begin() + scene.nbStaticElements(),
                                 boxes.begin() + scene.endOfMovingElements());
  visualization_msgs::MarkerArray array;
  for (std::size_t i = 0; i < scene.clouds().size(); ++i) {
    const std::string& name = scene.models()[scene.clouds()[i].model].name;
    const auto& voxels = poses.voxels[i];
    array.markers.push_back(
        voxels ? toMarker(*voxels, name, moving, std::max(reach, LEAST_COLOURED), active.frame)
               : noMarker(name, active.frame));
  }
  scene_markers_.publish(array);
}

}  // namespace collision_pairs
