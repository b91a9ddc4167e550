// Lookup table for a pair of elements whose relative pose one or two joints decide.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "batch_model.h"

namespace collision_pairs {

/// A square of cells over the ranges of the joints. Undecided blocks of cells are certified when
/// they are read: free by a plane between the hulls in the middle of the block, or by the exact
/// distance there and a bound of the motion within it; in contact by a point that is deeper than it
/// moves. A block that cannot be certified is divided into four. Only planes and spheres are tried
/// in large blocks; smaller ones have to be read several times, or crossed once. So only regions
/// that occur are computed. What is free keeps APART, but in the smallest blocks. For one thread.
class PairTable {
 public:
  static constexpr int LEVELS = 8;  ///< 256 x 256 cells
  static constexpr int SIDE = 1 << LEVELS;

  /// The joints that decide the relative pose of the two bodies: at most two, revolute or with
  /// limits. False: the pair has no table.
  static bool joints(const RobotModel& robot, int body_a, int body_b, std::vector<int>& joints);

  /// All arguments must outlive it. The elements move; joints() must be true for their bodies.
  /// Memory: 150 KB, allocated by the first call of at().
  PairTable(const CollisionScene& scene, const BatchModel& model, const BoxPair& pair);

  enum class Cell : std::uint8_t { OPEN, FREE, CONTACT };
  /// m: what along() calls free keeps at least so much beyond the padding.
  static constexpr double APART = 1e-3;
  /// Positions of the joints() in their order; the second is 0 if there is only one. Cost: a few
  /// ns; when an undecided block is certified, a distance query.
  Cell at(double first, double second, NarrowPhase& narrow_phase);

  /// Of a straight line from one place in the table to another, by the cells that it crosses (J.
  /// Amanatides, A. Woo, "A fast voxel traversal algorithm for ray tracing", 1987; here column by
  /// column, with all cells that it may touch but for rounding). FREE: no configuration is nearer
  /// than APART. CONTACT: that at the fraction `begin` is in contact. OPEN: neither, and what is
  /// nearer than APART is between the fractions `begin` and `end`.
  struct Along {
    Cell cell;
    double begin, end;
  };
  /// `from`, `to`: as for at(), two each. A joint that turns without limits may do so several
  /// times. Cost: that of at() for each cell; undecided blocks are certified at once, since a line
  /// that is left open costs more.
  Along along(const double* from, const double* to, NarrowPhase& narrow_phase);
  int nbJoints() const { return static_cast<int>(joints_.size()); }
  int joint(int i) const { return joints_[static_cast<std::size_t>(i)]; }

 private:
  /// A block of cells with side 2^(LEVELS - level).
  struct Block {
    int level, x, y;
  };
  struct Axis {
    double lower = 0.0, width = 1.0;
    bool is_round = false;
  };
  /// Of a joint, from the middle of a block; in W.
  struct Motion {
    double half;  ///< rad or m: at most so far
    Eigen::Vector3d axis, origin;
    bool turns;
    /// Of a point and all within `radius` of it, or of the leaves of a cover: at most so many
    /// metres per radian or metre.
    double reachOf(const Eigen::Vector3d& p_W, double radius) const;
    double reachOf(const SphereCover& cover, const Eigen::Isometry3d& X_WE) const;
  };
  bool indexOf(const Axis& axis, double position, int& index) const;
  /// A Cell, or CLEAR. `at_once`: certifies a block when it is first read.
  std::uint8_t codeOf(int x, int y, bool at_once, NarrowPhase& narrow_phase);
  std::uint8_t certified(const Block& block, NarrowPhase& narrow_phase);
  void setMotions(const Block& block);
  double motionOf(const Eigen::Vector3d& p_W, double radius = 0.0) const;
  double motionOf(const SphereCover& cover, const Eigen::Isometry3d& X_WE) const;
  bool hullsStayApart(const ConvexCore& a, const Eigen::Isometry3d& X_WA, const ConvexCore& c,
                      const Eigen::Isometry3d& X_WC, const SphereCover& cover_c,
                      double apart) const;
  void fill(const Block& block, std::uint8_t code);

  const CollisionScene& scene_;
  const BatchModel& model_;
  BoxPair pair_;
  std::vector<int> joints_;  // of the robot; the first is nearer to the first element
  Axis axes_[2];
  std::vector<std::uint8_t> cells_;   // a Cell, CLEAR, or OPEN_BLOCK + level if undecided
  std::vector<std::uint8_t> visits_;  // of undecided blocks, level by level
  std::vector<Motion> motions_;       // in the block that is being certified
  std::vector<double> positions_;
  std::vector<Eigen::Isometry3d> X_WB_;
};

}  // namespace collision_pairs
