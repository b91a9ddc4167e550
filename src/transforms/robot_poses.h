// Poses of a robot's bodies from transforms.
#pragma once

#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "collision_pairs/robot_model.h"
#include "frame_ways.h"

namespace collision_pairs {

/// Where bodies are; by body of the robot.
struct FoundBodies {
  std::vector<char> known;
  std::vector<Eigen::Isometry3d> X_WB;
  std::vector<std::string> problems;  ///< why a body that is wanted is not known
  StampNs stamp = NEVER;              ///< of all of them; NEVER: those that are known are static
};

/// The newest instant for which bodies are known, and their newest transform, also of a suspect
/// one. NEVER: there is none.
struct NewestStamps {
  StampNs common = NEVER, heard = NEVER;
};

/// Looks bodies up in a buffer; keeps no poses. A body is where TF has the first of its links that
/// is known, also the body of W. Where TF lacks a transform between links that the URDF fixes to
/// each other, the URDF provides it. Beyond a joint that is not fixed, but that static transforms
/// hold, nothing is known, unless the joint is in static_joints. Look-ups from several threads need
/// a lock.
class RobotPoses {
 public:
  /// The problem of a body of which TF has no frame.
  static const char* const NO_FRAME;

  /// W is `frame`; it need not be a link. The buffer must outlive this object; it is not read yet.
  /// Throws InputError if a static joint is not a joint of the robot.
  RobotPoses(const TransformBuffer& buffer, const RobotModel& robot, std::string frame,
             const std::vector<std::string>& static_joints = {});

  /// Bodies with an entry in `wanted`; the others may be placed, too. Not at NEWEST.
  FoundBodies place(const Instant& instant, const std::vector<char>& wanted) const;
  /// At the newest instant for which all are known, leaving out those of which a transform is older
  /// than max_pose_age, or than the newest transform of any of the robot's frames by more than
  /// max_transform_age.
  FoundBodies newest(StampNs now, const std::vector<char>& wanted) const;
  /// The instant of newest(), without the poses.
  NewestStamps newestStamps(StampNs now, const std::vector<char>& wanted) const {
    return layOutNewest(now, wanted).stamps;
  }

  /// As poseBetween(), of frames and of links that TF does not name.
  FoundPose between(const std::string& target, const std::string& source,
                    const Instant& instant) const;

  /// The first body above this one in TF, when the clock is at the stamp, whatever the URDF says;
  /// -1: none.
  int carrierOf(int body, StampNs stamp) const;
  /// The body to which W belongs; -1: none.
  int bodyOfFrame() const { return body_of_frame_; }
  std::size_t nbBodies() const { return joints_.size(); }

 private:
  struct JointAbove {
    std::string name;
    bool may_be_static;
  };
  /// Ways from W at one instant.
  struct Layout {
    FrameWays ways;
    struct Place {
      int frame = -1;      ///< of a link; -1: not found
      FrameWays::Way way;  ///< if it is not found, as far as one leads
    };
    std::vector<Place> places;  ///< by body
  };
  struct NewestLayout {
    Layout layout;
    NewestStamps stamps;
    std::vector<std::string> problems;  ///< by body: why it is not known now
  };

  const LinkFrames& links() const;
  Layout layOut(const Instant& instant, const std::vector<char>& wanted) const;
  NewestLayout layOutNewest(StampNs now, const std::vector<char>& wanted) const;
  /// With what layOut() found for that stamp.
  FoundBodies place(const Layout& layout, StampNs stamp, const std::vector<char>& wanted) const;
  /// Whether a layout of the newest transforms is that of the stamp, too.
  bool holdsAt(StampNs stamp, const Layout& layout, const std::vector<char>& wanted) const;
  std::string whyNot(int body, const Layout& layout) const;
  /// The newest stamp, up to now, of the frame and those above it, suspect or not.
  StampNs newestAbove(int frame, StampNs now) const;
  /// Of that frame and all links, and those above them.
  StampNs newestOfRobot(int frame, StampNs now) const;

  /// The body that a frame is a link of, or hangs on; -1: none.
  int bodyUnder(int frame, StampNs stamp) const;
  /// Joints that are not fixed, but that static transforms hold.
  struct Standing {
    std::pair<std::size_t, std::size_t> version;  ///< of the static transforms and of frames
    std::vector<char> joints;                     ///< by the body below
    std::vector<int> tops;  ///< by frame: the last that static transforms lead up to; -1: not asked
    std::map<int, std::vector<int>> first_below;  ///< by root and top: the first body; -1: none
  };
  /// Between links.
  const Standing& standing() const;
  void noteStanding(int body, int other, std::vector<char>& stands) const;
  /// By the body below: those of standing(), and those between links and a frame that counts as on
  /// the body `under`, or else on each root.
  std::vector<char> standingJoints(int frame, int under) const;
  /// The body below the first of them between two bodies; -1: there is none.
  int firstStanding(const std::vector<char>& stands, int body, int other) const;
  std::string whyHeld(int below) const;

  const TransformBuffer& buffer_;
  mutable LinkFrames links_;
  mutable Standing standing_;
  std::shared_ptr<const RobotModel> robot_;  ///< without geometry
  std::vector<int> roots_;                   ///< by body
  std::vector<JointAbove> joints_;           ///< by body
  std::string frame_;
  int body_of_frame_ = -1;
};

}  // namespace collision_pairs
