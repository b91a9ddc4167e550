// Poses of a scene's bodies from TF, all at the same stamp.
#pragma once

#include <string>
#include <vector>

#include <ros/time.h>

#include "collision_pairs/body_poses.h"
#include "collision_pairs/collision_scene.h"
#include "robot_poses.h"
#include "transform_input.h"

namespace collision_pairs {

struct StampedPoses {
  BodyPoses poses;
  /// The instant of all of them; 0 if all known poses are static.
  ros::Time stamp;
  /// Number of bodies looked up in TF (all but one that is the frame itself), and of those found.
  std::size_t nb_asked = 0;
  std::size_t nb_found = 0;
  /// For each body without a pose: its link and the reason. Empty if all are known.
  std::vector<std::string> problems;
};

/// Looks up transforms; keeps no poses. Poses that TF lacks stay unknown and are never identity.
class TfPoses {
 public:
  /// Of these bodies of the robot; `frame` is the report's frame W. The transforms must outlive
  /// this object.
  TfPoses(const TransformInput& transforms, const RobotModel& robot, std::vector<SceneBody> bodies,
          const std::string& frame, const std::vector<std::string>& static_joints = {});

  /// The newest instant for which all bodies are known, leaving out those that are older than the
  /// limits allow.
  StampedPoses latest(const ros::Time& now) const;

  /// The instant of latest(), without the poses.
  NewestStamps newestStamps(const ros::Time& now) const {
    return robot_.newestStamps(toNs(now), all_);
  }

  /// At the given instant.
  StampedPoses at(const ros::Time& stamp) const;

  /// RobotPoses::carrierOf(), at 0 now; and the body of the frame W.
  int carrierOf(int body, const ros::Time& stamp) const {
    return robot_.carrierOf(body, toNs(stamp.isZero() ? transforms_.now().stamp : stamp));
  }
  int bodyOfFrame() const { return robot_.bodyOfFrame(); }

  /// At the given instant, of the bodies with an entry in `wanted` only; the others stay unknown.
  BodyPoses at(const ros::Time& stamp, const std::vector<char>& wanted) const;

  /// Pose of `source` in `target`, at 0 the newest; either may be a link that only the URDF places.
  /// Throws InputError.
  TransformInput::Found lookUp(const std::string& target, const std::string& source,
                               const ros::Time& stamp) const {
    return transforms_.lookUp(target, source, stamp, &robot_);
  }

 private:
  StampedPoses gather(FoundBodies placed, const ros::Time& stamp) const;

  const TransformInput& transforms_;
  const std::vector<SceneBody> bodies_;
  const RobotPoses robot_;
  std::vector<char> all_;  ///< by body of the robot: is one of bodies_
};

}  // namespace collision_pairs
