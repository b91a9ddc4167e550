// Poses of a robot's bodies from transforms.
#pragma once

#include <string>
#include <vector>

#include "collision_pairs/robot_model.h"
#include "transform_buffer.h"

namespace collision_pairs {

/// Where bodies are; by body of the robot.
struct FoundBodies {
  std::vector<char> known;
  std::vector<Eigen::Isometry3d> X_WB;
  std::vector<std::string> problems;  ///< why a body that is wanted is not known
  StampNs stamp = NEVER;              ///< of all of them, by newest() only; NEVER: all static
};

/// Looks bodies up in a buffer; keeps no poses. A body is where TF places any of its links. Where
/// TF lacks a transform between links that the URDF fixes to each other, the URDF provides it. A
/// body that TF connects to another one by static transforms only, although a joint between them is
/// not fixed, is unknown, unless the joint is in static_joints. Look-ups from several threads need
/// a lock.
class RobotPoses {
 public:
  /// The problem of a body of which TF has no frame.
  static const char* const NO_FRAME;

  /// W is `frame`; it need not be a link. The buffer must outlive this object. Throws InputError if
  /// a static joint is not a joint of the robot.
  RobotPoses(const TransformBuffer& buffer, const RobotModel& robot, const std::string& frame,
             const std::vector<std::string>& static_joints = {});

  /// Bodies with an entry in `wanted`; the others may be placed, too. Not at NEWEST.
  FoundBodies place(const Instant& instant, const std::vector<char>& wanted) const;
  /// At the newest instant for which all are known, leaving out those of which a transform is older
  /// than max_pose_age, or than the newest transform of any of the robot's frames by more than
  /// max_transform_age.
  FoundBodies newest(StampNs now, const std::vector<char>& wanted) const;

  /// As poseBetween(). Where TF does not connect the two, also by links that the URDF fixes to each
  /// other; links that TF does not name count as frames then.
  FoundPose between(const std::string& target, const std::string& source,
                    const Instant& instant) const;

  /// By body: only static transforms place it, although a joint between it and W is not fixed.
  std::vector<char> heldAt(StampNs stamp) const;

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
    int parent, root;
    std::string joint;
    bool may_be_static;  ///< of the joint above
  };
  /// Numbers of frames, found again when the buffer has more of them.
  struct Frames {
    std::size_t nb_known = 0;                ///< of the buffer's frames, when these were found
    int frame = -1;                          ///< W
    std::vector<std::vector<int>> of_links;  ///< by body
  };
  /// Where a body is found: by transforms from an anchor to one of its links.
  struct Place {
    int anchor = -1;  ///< -1: not found, or W's own body
    std::size_t link = 0;
    FrameWays::Way way;  ///< from W; if it is not found, as far as one leads
  };
  /// A frame whose place is known: W, and those of links that the URDF fixes to placed ones.
  struct Anchor {
    FrameWays ways;
    int body;  ///< -1: W
    std::size_t link;
    FrameWays::Way way;
  };
  /// What leads where at one instant.
  struct Layout {
    std::vector<Anchor> anchors;
    std::vector<Place> places;  ///< by body
  };

  /// Any frame: in TF, or a link that TF does not name.
  struct Located {
    int anchor = -1;  ///< -1: a link of a body
    int frame = -1;   ///< of the buffer, or the number of that body; -1: neither
    Eigen::Isometry3d X_BL = Eigen::Isometry3d::Identity();
    FrameWays::Way way = {};  ///< from W
  };

  const Frames& frames() const;
  /// With what layOut() found for that stamp.
  FoundBodies place(const Layout& layout, StampNs stamp, const std::vector<char>& wanted) const;
  /// Whether a layout of the newest transforms is that of the stamp, too.
  bool holdsAt(StampNs stamp, const Layout& layout, const std::vector<char>& wanted) const;
  bool locate(const std::string& frame, const Layout& layout, Located& found) const;
  Layout layOut(const Instant& instant, const std::vector<char>& wanted) const;
  FrameWays waysFrom(int frame, const Instant& instant) const;
  /// Whether a path upward leads back to itself: by TF, and from a link that TF does not place by
  /// those that the URDF fixes to it. It is not one if it leads back to `below`, from which the
  /// URDF led to its last frame. `tried`: the ends that were found before.
  bool hangsOnItself(const FrameWays& ways, std::vector<int> path, int below,
                     std::vector<int>& tried) const;
  /// Whether the rest of the path, from the frame that it has met, is of several bodies.
  bool isCycle(const std::vector<int>& path, int met) const;
  int bodyOf(int frame) const;
  bool findPlace(std::size_t body, Layout& layout) const;
  void joinByUrdf(const Instant& instant, Layout& layout) const;
  bool isFound(const Layout& layout, std::size_t body) const;
  Eigen::Isometry3d poseOf(std::size_t body, const Layout& layout, StampNs stamp) const;
  Eigen::Isometry3d poseOf(const Anchor& anchor, const Layout& layout, StampNs stamp) const;
  Eigen::Isometry3d poseOf(const Located& located, const Layout& layout, StampNs stamp) const;
  template <class Visit>
  void visitBetween(int a, int b, const Visit& visit) const;
  /// The body that W is a link of, or hangs on; -1: none.
  int bodyUnderFrame(StampNs stamp) const;
  /// By the body below.
  std::vector<char> standingJoints(int under_frame, StampNs stamp) const;
  /// By body: that below the joint which stands between it and W; -1: none.
  std::vector<int> heldBy(StampNs stamp) const;
  std::string whyNot(std::size_t body, const Layout& layout) const;
  /// The newest stamp, up to now, of the frame and those above it, in doubt or not.
  StampNs newestAbove(int frame, StampNs now) const;

  const TransformBuffer& buffer_;
  mutable Frames frames_;
  std::vector<BodyOfRobot> bodies_;
  std::string frame_;
  int body_of_frame_ = -1;
  Eigen::Isometry3d X_WB_of_frame_ = Eigen::Isometry3d::Identity();
};

}  // namespace collision_pairs
