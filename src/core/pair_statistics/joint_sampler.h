// Random joint states of a robot by index.
#pragma once

#include <cstdint>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "collision_pairs/robot_model.h"

namespace collision_pairs {

/// A stream of random bits: SplitMix64 (Steele, Lea, Flood: Fast splittable pseudorandom number
/// generators, 2014). Its numbers are the same on every machine, which the standard library's
/// distributions do not guarantee.
class RandomStream {
 public:
  /// Streams of different (seed, index) are independent.
  RandomStream(std::uint64_t seed, std::uint64_t index);
  /// In [0, 1), a multiple of 2^-53.
  double uniform();

 private:
  std::uint64_t state_;
};

/// Draws each joint uniformly between its limits, independent of all others. Revolute joints
/// without limits: in [-pi, pi). Mimic joints follow. Planar and floating joints, and prismatic
/// ones without limits, have no range and stay at zero.
class JointSampler {
 public:
  JointSampler(std::shared_ptr<const RobotModel> robot, std::uint64_t seed);

  /// Range of a joint, rad or m; both ends are equal for one that stays.
  struct Range {
    double lower = 0.0;
    double upper = 0.0;
    /// Position at fraction `u` in [0, 1) of the range; cannot overflow.
    double at(double u) const { return (1.0 - u) * lower + u * upper; }
  };

  /// State number `index`: one entry per joint, as for forwardKinematics(). It depends only on the
  /// robot, the seed and the index, so states may be drawn in any order, by any thread. O(joints).
  void draw(std::uint64_t index, std::vector<double>& positions) const;

  /// The stream from which state number `index` is drawn.
  RandomStream stream(std::uint64_t index) const { return RandomStream(seed_, index); }

  const RobotModel& robot() const { return *robot_; }
  /// One entry per joint; empty ranges for those that do not move independently.
  const std::vector<Range>& ranges() const { return ranges_; }
  /// The joints with a range that change the relative pose of the two bodies of the robot,
  /// ascending.
  std::vector<int> jointsBetween(int body_a, int body_b) const;
  /// Names of joints that would and of which not all positions are drawn: those of
  /// standingJoints(), and those without limits, of which one turn is drawn, if what mimics them is
  /// elsewhere in others (a slide, or one that turns by other than whole multiples).
  std::set<std::string> drawnInPartBetween(int body_a, int body_b) const;
  /// Names of the movable joints that stay at zero here, for a warning.
  std::vector<std::string> standingJoints() const;

 private:
  /// The joints that, or whose mimics, change the relative pose of the two bodies; and whether a
  /// whole turn of them changes nothing there.
  template <class Take>
  void visitJoints(int body_a, int body_b, const Take& take) const;
  bool stands(int joint) const;

  std::shared_ptr<const RobotModel> robot_;
  std::uint64_t seed_;
  std::vector<Range> ranges_;
};

}  // namespace collision_pairs
