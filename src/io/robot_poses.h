// Poses of a robot's bodies from transforms: the same for the node and for recordings.
#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include "collision_pairs/input_error.h"
#include "collision_pairs/robot_model.h"
#include "transform_buffer.h"

namespace collision_pairs {

/// Which pose of each frame.
struct Instant {
  enum Kind {
    AT,             ///< at the stamp
    AS_IT_ARRIVED,  ///< the same, if it was known in time (TransformBuffer::poseAt())
    NEWEST          ///< the newest one when the clock is at the stamp
  };
  Kind kind;
  StampNs stamp;
};

/// Poses of frames in one frame R; steps that several of them share are computed once.
class FramePoses {
 public:
  struct Known {
    Eigen::Isometry3d X_RF;
    StampNs oldest = NEVER, newest = EVER_SINCE;  ///< of the transforms on the way but static ones
    void pass(StampNs stamp) {
      oldest = std::min(oldest, stamp);
      if (stamp != NEVER) newest = std::max(newest, stamp);
    }
  };

  FramePoses(const TransformBuffer& buffer, const Instant& instant);

  /// Fixes the pose of a frame, and of its ancestors as far as they are not known. One whose
  /// ancestors form a cycle stays unknown.
  void anchor(int frame, const Known& known);
  /// False if no path leads from a known frame to this one; `found` then has the oldest stamp of
  /// the transforms up to where it ends.
  bool find(int frame, Known& found);
  /// Why find() is false, in words.
  std::string whyUnknown(int frame) const;
  /// False if its ancestors end at one that TF does not place anywhere, or never.
  bool isPlaced(int frame) const;
  bool isInCycle(int frame) const { return lastAncestor(frame) < 0; }

 private:
  /// The last ancestor that can be reached; -1: they form a cycle.
  int lastAncestor(int frame) const;
  bool step(int frame, StampNs& stamp, int& parent, Eigen::Isometry3d& X_PF) const;
  void learn(int frame, const Known& known);
  void forgetFrom(int first);  ///< in known_

  const TransformBuffer& buffer_;
  const Instant instant_;
  std::vector<int> index_;  ///< by frame, in known_; -1: not known
  std::vector<Known> known_;
  struct Step {
    int frame;
    StampNs stamp;
    Eigen::Isometry3d X_PF;
  };
  std::vector<Step> way_;  ///< scratch of find()
};

/// No stamp can help: TF does not connect two frames.
class NotConnected : public InputError {
 public:
  using InputError::InputError;
};

/// Pose of one frame in another. Throws NotConnected, or InputError if that instant is missing.
FramePoses::Known poseBetween(const TransformBuffer& buffer, const std::string& target,
                              const std::string& source, Instant instant);

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
