// Poses and velocities of the parts of a scene at one configuration of a motion.
#pragma once

#include <cstdint>
#include <vector>

#include "collision_pairs/motion_check.h"
#include "motion_pairs.h"

namespace collision_pairs {

/// Bounds from one configuration, relative to a frame: while the fraction changes by s, no point of
/// an element moves by more than |s| * speed, nor deviates by more than s^2 / 2 * acceleration from
/// motion at constant velocity; apart from `rounding` and `deviation`.
struct MotionBound {
  double speed = 0.0;         ///< metres per unit of the fraction
  double acceleration = 0.0;  ///< metres per unit squared
  /// Uncertainty of its position due to the rounding of joint positions, metres.
  double rounding = 0.0;
  /// The most that it moves while each joint goes from the line to its deviation, metres.
  double deviation = 0.0;
};

/// Velocity of an element relative to a frame, expressed in W: of its centre, and angular.
struct Twist {
  Eigen::Vector3d v = Eigen::Vector3d::Zero();      ///< metres per unit of the fraction
  Eigen::Vector3d omega = Eigen::Vector3d::Zero();  ///< radians per unit of the fraction
};

/// Sphere around the box that encloses an element along its own axes, in W.
struct BoundingSphere {
  Eigen::Vector3d center;
  double radius;  ///< infinite for a half-space
};

/// Kinematics along one motion; each part is computed when first needed. "Frames" are bodies of the
/// robot (RobotModel::bodies()), or -1 for W; "centres" are those of the spheres.
///
/// The bounds are those of Schwarzer et al. (see MotionCheck): a joint that turns by dq moves a
/// point by no more than |dq| r, where r is its distance from the axis. They bound the motion from
/// the middle of a segment to either side, not from one end to the other: so r can be that of the
/// middle's pose, and need not hold for the whole segment.
class MotionState {
 public:
  /// Both must outlive this.
  MotionState(const CollisionScene& scene, const MotionPairs& pairs);

  /// Throws InputError as MotionCheck::check() says.
  void begin(const JointMotion& motion, const PlacedBodies& placed);

  /// The configuration at fraction `at`; bounds are for all fractions within `half_width` of it.
  void moveTo(double at, double half_width);

  /// The ends of the line, mimic joints applied, and the most that a joint moves on it (rad or m).
  const std::vector<double>& from() const { return from_; }
  const std::vector<double>& to() const { return to_; }
  double length() const;

  /// True if joints between W and the element move.
  bool moves(std::uint32_t element) const { return elements_[element].moves; }
  const BoundingSphere& sphere(std::uint32_t element) {
    if (!isOfNow(element, elements_[element].stamp)) moveSphere(element);
    return elements_[element].sphere;
  }
  const Eigen::Isometry3d& pose(std::uint32_t element);  ///< X_WE
  Eigen::Matrix3d rotation(int frame);                   ///< R_WF
  MotionBound bound(std::uint32_t element, int frame) {
    if (!moves(element)) return {};
    if (elements_[element].bound_stamp != now_) setBounds(element);
    return bounds_[element * stride_ + (frame < 0 ? 0 : pairs_.depth_of[frame] + 1)];
  }
  Twist twist(std::uint32_t element, int frame);
  /// As MotionBound::deviation, but only along n_W, a unit vector that is fixed in the frame. At
  /// every fraction within the half width, which is `half_width` here.
  double deviationAlong(std::uint32_t element, int frame, const Eigen::Vector3d& n_W,
                        double half_width);
  double halfWidth() const { return half_width_; }

  /// Whether the motion moves the two relative to each other.
  bool moves(const MotionPairs::Pair& pair);
  bool movesModels(std::uint32_t first, std::uint32_t second);  ///< O(pairs of elements)

  /// X_WE of all elements: current for those that were requested at this configuration, else of an
  /// earlier one.
  const std::vector<Eigen::Isometry3d>& poses() const { return X_WE_; }
  /// The same, for callers that place the elements of clouds.
  std::vector<Eigen::Isometry3d>& poses() { return X_WE_; }
  /// For the whole scene, with the arithmetic of RobotModel::forwardKinematics().
  void gatherPoses(BodyPoses& poses);

 private:
  struct BodyState {
    double rate = 0.0;       ///< change of its joint over the motion, rad or m
    double deviation = 0.0;  ///< of its joint, rad or m
    int nb_moving = 0;       ///< joints that move between W and it
    bool moves() const { return rate != 0.0 || deviation != 0.0; }  ///< its joint does
    bool is_placed = false;  ///< at X_PB regardless of its joint's position
    Eigen::Isometry3d X_PB = Eigen::Isometry3d::Identity();  ///< of a root, or of a placed body
    std::uint64_t stamp = 0;
    Eigen::Isometry3d X_WB = Eigen::Isometry3d::Identity();
    Twist twist;             ///< of its origin, in W
    Eigen::Vector3d axis_W;  ///< of its joint, if that moves
  };
  struct ElementState {
    Eigen::Vector3d center_B;  ///< of its sphere; in W if static
    bool moves = false;
    std::uint64_t stamp = 0, pose_stamp = 0, bound_stamp = 0;
    BoundingSphere sphere;
  };

  bool isOfNow(std::uint32_t element, std::uint64_t stamp) const {
    return stamp == now_ || (!moves(element) && stamp >= begun_);
  }
  void moveSphere(std::uint32_t element);
  void beginBody(int id, const PlacedBodies& placed);
  void setDeviation(const std::vector<double>& deviation);
  double positionOf(int joint) const { return from_[joint] + at_ * (to_[joint] - from_[joint]); }
  const BodyState& body(int id);
  void setBounds(std::uint32_t element);

  const CollisionScene& scene_;
  const RobotModel& robot_;
  const MotionPairs& pairs_;
  const std::size_t stride_;
  bool has_mimics_ = false;
  std::vector<double> from_, to_, deviation_, positions_;
  double at_ = 0.0, half_width_ = 0.0;
  std::uint64_t now_ = 0, begun_ = 0;  // stamps: of the configuration, of the motion
  std::vector<BodyState> bodies_;
  std::vector<ElementState> elements_;
  std::vector<Eigen::Isometry3d> X_WE_, X_WB_;
  std::vector<MotionBound> bounds_;  // by element and depth of the frame, that of W first
};

}  // namespace collision_pairs
