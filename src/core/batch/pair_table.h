// What is known of a pair of elements whose relative pose two joints decide.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "batch_model.h"

namespace collision_pairs {

/// A square of cells over the ranges of the two joints. What is left open so often that looking
/// closer is worth it is certified, for a block of cells at a time: by the exact distance in the
/// middle of the block and how far the joints can move the elements from there; a block of which
/// that tells nothing is divided by four. So the work follows the states that are asked for.
/// For one thread.
class PairTable {
 public:
  static constexpr int LEVELS = 8;  ///< 256 x 256 cells
  static constexpr int SIDE = 1 << LEVELS;

  /// The joints that move the two bodies of the robot against each other; at most two, turning ones
  /// or with limits. False: the pair has no table.
  static bool joints(const RobotModel& robot, int body_a, int body_b, std::vector<int>& joints);

  /// All must outlive it. The elements move, with bodies as joints() wants them.
  /// Memory: 150 KB, from the first time that a state is asked for.
  PairTable(const CollisionScene& scene, const BatchModel& model, const BoxPair& pair);

  enum class Cell : std::uint8_t { OPEN, FREE, CONTACT };
  /// `positions` of the joints() in their order, the second 0 where there is one. A few ns, but one
  /// time in VISITS of those that are left open: a distance.
  Cell at(double first, double second, NarrowPhase& narrow_phase);
  int nbJoints() const { return static_cast<int>(joints_.size()); }
  int joint(int i) const { return joints_[static_cast<std::size_t>(i)]; }

 private:
  /// A block of cells: of side 2^(LEVELS - level).
  struct Block {
    int level, x, y;
  };
  struct Axis {
    double lower = 0.0, width = 1.0;
    bool is_round = false;
  };
  bool indexOf(const Axis& axis, double position, int& index) const;
  Cell certified(const Block& block, NarrowPhase& narrow_phase);
  double reachOf(const SphereCover& cover, const Eigen::Isometry3d& X_WE, int joint) const;
  void fill(const Block& block, std::uint8_t code);

  const CollisionScene& scene_;
  const BatchModel& model_;
  BoxPair pair_;
  std::vector<int> joints_;  // of the robot: the first is nearer to the first element
  Axis axes_[2];
  std::vector<std::uint8_t> cells_;   // a Cell, or for open ones OPEN_BLOCK + level
  std::vector<std::uint8_t> visits_;  // of open blocks, level by level
  std::vector<double> positions_;
  std::vector<Eigen::Isometry3d> X_WB_;
};

}  // namespace collision_pairs
