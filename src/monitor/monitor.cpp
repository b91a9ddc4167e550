#include "monitor.h"

#include <algorithm>
#include <map>

#include "cloud_view.h"
#include "unknown_because.h"
#include "user_text.h"

namespace collision_pairs {
namespace {

// Seconds. A shorter window is more recent, a longer one averages more encoder noise; TF
// interpolates if its rate is lower.
constexpr double VELOCITY_WINDOW = 0.1;
constexpr std::size_t MOST_NAMED = 10;  // left_out names all links

}  // namespace

Snapshot Monitor::begin(const ActiveScenePtr& scene, const ros::Time& stamp) const {
  Snapshot snapshot;
  snapshot.scene = scene;
  snapshot.stamp = transforms_.now().stamp;
  if (!scenes_.isCurrent(*scene)) {
    snapshot.poses.unknown_because.push_back("the scene was replaced meanwhile");
  }
  if (scenes_.areObjectsLost()) {
    snapshot.poses.unknown_because.push_back(
        "the node was started anew, and the objects that ~update_scene had added are lost: send "
        "CLEAR, and add them again");
  }
  if (!stamp.isZero() && stamp < scenes_.since()) {
    snapshot.poses.unknown_because.push_back(
        "the scene was changed after the stamp of the request, and only the newest is kept");
  }
  const std::string missing = missingGeometry(*scene->scene);
  if (!missing.empty()) snapshot.poses.unknown_because.push_back(missing);
  return snapshot;
}

Snapshot Monitor::at(const ActiveScenePtr& scene, const ros::Time& stamp) const {
  Snapshot snapshot = begin(scene, stamp);
  StampedPoses stamped =
      stamp.isZero() ? scene->tf_poses->latest(snapshot.stamp) : scene->tf_poses->at(stamp);
  snapshot.is_static = stamped.stamp.isZero();
  if (!snapshot.is_static) snapshot.stamp = stamped.stamp;
  snapshot.nb_asked = stamped.nb_asked;
  snapshot.nb_found = stamped.nb_found;
  snapshot.poses.X_WB = std::move(stamped.poses.X_WB);
  snapshot.poses.known = std::move(stamped.poses.known);
  addClock(snapshot);
  addProblems(stamped.problems, snapshot);
  addClouds(stamp, snapshot);
  return snapshot;
}

void Monitor::addClock(Snapshot& snapshot) const {
  auto& reasons = snapshot.poses.unknown_because;
  if (transforms_.now().stamp.isZero()) reasons.push_back(NO_CLOCK);
  const std::string clock = transforms_.clockProblem();
  if (!clock.empty() && !contains(reasons, clock)) reasons.push_back(clock);
}

void Monitor::addProblems(const std::vector<std::string>& problems, Snapshot& snapshot) const {
  if (problems.empty()) return;
  auto& reasons = snapshot.poses.unknown_because;
  snapshot.first_left_out = problems.front();
  const std::size_t nb_named = std::min(problems.size(), MOST_NAMED);
  reasons.insert(reasons.end(), problems.begin(), problems.begin() + nb_named);
  if (problems.size() > nb_named) {
    reasons.push_back("and " + std::to_string(problems.size() - nb_named) + " more links");
  }
  const std::vector<std::string> refused = transforms_.refused();
  for (std::size_t i = 0; i < std::min(refused.size(), MOST_NAMED); ++i) {
    reasons.push_back("refused " + refused[i]);
  }
}

void Monitor::addClouds(const ros::Time& stamp, Snapshot& snapshot) const {
  const CollisionScene& scene = *snapshot.scene->scene;
  snapshot.oldest_cloud = snapshot.stamp.toSec();
  if (scene.clouds().empty()) return;
  if (!stamp.isZero()) {
    snapshot.poses.unknown_because.push_back(
        "the request has a stamp, and only the newest clouds are kept: leave stamp at 0");
    return;
  }
  std::map<std::string, CloudView> views;
  for (const auto& source : snapshot.scene->clouds) {
    const CloudView view = source->view();
    views[source->config().name()] = view;
    if (view.voxels) snapshot.oldest_cloud = std::min(snapshot.oldest_cloud, view.stamp);
  }
  for (SuspectCloud& suspect : addVoxels(views, scene, snapshot.poses)) {
    snapshot.suspect_clouds.push_back(std::move(suspect.cloud));
  }
  if (snapshot.scene->not_followed.empty()) return;
  snapshot.poses.unknown_because.push_back(
      "what clouds show beside " + firstOf(snapshot.scene->not_followed) +
      " is not followed, since ~links or ~group leaves it out");
}

void Monitor::addJoints(const std::vector<std::string>& names, const ros::Time& stamp,
                        const std::vector<std::string>* moved, Snapshot& snapshot) const {
  const ActiveScene& active = *snapshot.scene;
  JointQueryTf tf{transforms_, active.frame, stamp, snapshot.stamp, active.tf_poses.get()};
  tf.is_of_one_instant = moved == nullptr;
  tf.moved = moved;
  if (stamp.isZero()) {
    const NewestStamps newest = active.tf_poses->newestStamps(snapshot.stamp);
    tf.heard = toTime(newest.heard);
    if (tf.is_of_one_instant) tf.stamp = toTime(newest.common);
  }
  snapshot.joints.emplace(names, *active.scene, tf);
  const auto& of_joints = snapshot.joints->unknownBecause();
  snapshot.poses.unknown_because.insert(snapshot.poses.unknown_because.end(), of_joints.begin(),
                                        of_joints.end());
}

Snapshot Monitor::withJoints(const ActiveScenePtr& scene, const std::vector<std::string>& names,
                             const ros::Time& stamp) const {
  Snapshot snapshot = begin(scene, stamp);
  addJoints(names, stamp, nullptr, snapshot);
  snapshot.is_static = snapshot.joints->stamp().isZero();
  if (!snapshot.is_static) snapshot.stamp = snapshot.joints->stamp();
  addClouds(stamp, snapshot);
  return snapshot;
}

Snapshot Monitor::withMeasured(const ActiveScenePtr& scene, const std::vector<std::string>& names,
                               const std::vector<std::string>& moved) const {
  Snapshot snapshot = begin(scene);
  addJoints(names, ros::Time(), &moved, snapshot);
  addClock(snapshot);  // positions are not seen to age either
  addClouds(ros::Time(), snapshot);
  return snapshot;
}

EarlierPoses Monitor::before(const Snapshot& snapshot, const CollisionReport& report) const {
  EarlierPoses before;
  before.window = VELOCITY_WINDOW;
  if (snapshot.is_static) {
    before.poses = snapshot.poses;
    return before;
  }
  std::vector<char> wanted(snapshot.poses.known.size(), 0);
  for (const PairReport& pair : report.pairs) {
    for (const std::uint32_t model : {pair.first, pair.second}) {
      const int body = snapshot.scene->scene->models()[model].body;
      if (body >= 0) wanted[static_cast<std::size_t>(body)] = 1;
    }
  }
  if (!report.pairs.empty() && snapshot.stamp.toSec() > VELOCITY_WINDOW) {
    const ros::Time then = snapshot.stamp - ros::Duration(VELOCITY_WINDOW);
    before.poses = snapshot.scene->tf_poses->at(then, wanted);
  } else {
    before.poses.resize(wanted.size());
    before.poses.known.assign(wanted.size(), 0);
  }
  return before;
}

}  // namespace collision_pairs
