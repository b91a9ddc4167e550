// Random joint states of a robot, each by its number.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "collision_pairs/robot_model.h"

namespace collision_pairs {

/// A stream of random bits: SplitMix64 (Steele, Lea, Flood: Fast splittable pseudorandom number
/// generators, 2014). Its numbers are the same on every machine, which the distributions of the
/// standard library do not promise.
class RandomStream {
 public:
  /// Streams of different (seed, index) have nothing to do with each other.
  RandomStream(std::uint64_t seed, std::uint64_t index);
  /// In [0, 1), a multiple of 2^-53.
  double uniform();

 private:
  std::uint64_t state_;
};

/// Draws each joint evenly between its limits, independent of all others. A joint that turns and
/// has no limits: in [-pi, pi). Joints that mimic follow. Planar and floating joints, and sliding
/// ones without limits, have no range to draw from and stand at zero.
class JointSampler {
 public:
  JointSampler(std::shared_ptr<const RobotModel> robot, std::uint64_t seed);

  /// What a moving joint may take, rad or m; both the same for one that stands.
  struct Range {
    double lower = 0.0;
    double upper = 0.0;
    /// Position at `u` in [0, 1) of the way; cannot overflow.
    double at(double u) const { return (1.0 - u) * lower + u * upper; }
  };

  /// State number `index`: one entry a joint, as forwardKinematics() takes it. It depends on the
  /// robot, the seed and the index alone, so states may be drawn in any order, by any thread.
  /// O(joints).
  void draw(std::uint64_t index, std::vector<double>& positions) const;

  /// The stream that state number `index` is drawn from.
  RandomStream stream(std::uint64_t index) const { return RandomStream(seed_, index); }

  const RobotModel& robot() const { return *robot_; }
  /// One entry a joint; empty ranges for those that do not move by themselves.
  const std::vector<Range>& ranges() const { return ranges_; }
  /// The joints with a range that move the two bodies of the robot against each other, ascending.
  std::vector<int> jointsBetween(int body_a, int body_b) const;
  /// Names of the joints that move but stand at zero here, for a warning.
  std::vector<std::string> standingJoints() const;

 private:
  std::shared_ptr<const RobotModel> robot_;
  std::uint64_t seed_;
  std::vector<Range> ranges_;
};

}  // namespace collision_pairs
