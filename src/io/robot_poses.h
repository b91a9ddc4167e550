// Poses of a robot's bodies from transforms: the same for the node and for recordings.
#pragma once

#include <string>
#include <vector>

#include "collision_pairs/robot_model.h"
#include "frame_poses.h"

namespace collision_pairs {

/// Where bodies are; by body of the robot.
struct FoundBodies {
  std::vector<char> known;
  std::vector<Eigen::Isometry3d> X_WB;
  /// Of the oldest transform on the way, also on one that leads nowhere; NEVER: all static.
  std::vector<StampNs> stamps;
  std::vector<std::string> problems;  ///< why a body that is wanted is not known
  bool are_mixed = false;             ///< transforms of several stamps were joined
  StampNs stamp = NEVER;              ///< of all of them, by newest() only; NEVER: all static
};

/// Looks bodies up in a buffer; keeps no poses. A body is where TF places any of its links. Where
/// TF lacks a transform between links that the URDF fixes to each other, the URDF provides it. A
/// body that TF connects to another one by static transforms only, although a joint between them is
/// not fixed, is unknown, unless the joint is in static_joints. Look-ups from several threads need
/// a lock while the buffer grows.
class RobotPoses {
 public:
  /// W is `frame`; it need not be a link. `prefix`: of the robot's frames, P/link or Plink. The
  /// buffer must outlive this object. Throws InputError if a static joint is not a joint of the
  /// robot.
  RobotPoses(const TransformBuffer& buffer, const RobotModel& robot, const std::string& frame,
             const std::string& prefix = "", const std::vector<std::string>& static_joints = {});

  /// Bodies with an entry in `wanted`; the others may be placed, too.
  FoundBodies place(const Instant& instant, const std::vector<char>& wanted) const;
  /// At the newest instant for which all are known, leaving out those that are older than the
  /// buffer's limits allow.
  FoundBodies newest(StampNs now, const std::vector<char>& wanted) const;
  /// Pose of any frame, a link or not, in W. `why`: why it is unknown.
  bool frameAt(const Instant& instant, const std::string& frame, FramePoses::Known& found,
               std::string& why) const;

  /// As poseBetween(). Where TF does not connect the two, also by links that the URDF fixes to each
  /// other; links that TF does not name count as frames then.
  FramePoses::Known between(const std::string& target, const std::string& source,
                            const Instant& instant) const;

  /// By body: only static transforms place it, although a joint above it is not fixed.
  std::vector<char> heldAt(StampNs stamp) const;

  /// Number of the link's frame; -1 if TF does not name it.
  int frameOf(const std::string& link) const;
  /// The body to which W belongs; -1: none.
  int bodyOfFrame() const { return body_of_frame_; }
  std::size_t nbBodies() const { return bodies_.size(); }

 private:
  struct LinkOfBody {
    std::string name;
    Eigen::Isometry3d X_BL;
  };
  struct BodyOfRobot {
    std::vector<LinkOfBody> links;  ///< its first link, then the others
    int parent;
    std::string joint;
    bool may_be_static;  ///< of the joint above
  };
  /// Numbers of frames, found again when the buffer has more of them.
  struct Frames {
    std::size_t nb_known = 0;                ///< of the buffer's frames, when these were found
    int frame = -1;                          ///< W
    std::vector<std::vector<int>> of_links;  ///< by body
  };

  const Frames& frames() const;
  FramePoses start(const Instant& instant, FoundBodies& placed) const;
  bool placeByTf(std::size_t body, FramePoses& poses, FoundBodies& placed) const;
  void placeByUrdf(FramePoses& poses, FoundBodies& placed) const;
  bool isLinkAt(const std::string& frame, const FoundBodies& placed,
                FramePoses::Known& found) const;
  /// By body: that of the joint which it is held at; -1: it is not held.
  std::vector<int> heldBy(StampNs stamp) const;
  void leaveOutHeld(StampNs stamp, FoundBodies& placed) const;
  void holdBetween(int a, int b, std::vector<int>& held_by) const;
  void explain(std::size_t body, const FramePoses& poses, FoundBodies& placed) const;

  const TransformBuffer& buffer_;
  mutable Frames frames_;
  std::vector<BodyOfRobot> bodies_;
  std::string frame_, prefix_;
  int body_of_frame_ = -1;
  Eigen::Isometry3d X_WB_of_frame_ = Eigen::Isometry3d::Identity();
};

}  // namespace collision_pairs
