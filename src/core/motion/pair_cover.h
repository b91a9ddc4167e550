// Determines how far around one configuration of a motion a pair of elements is free.
#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "motion_state.h"
#include "pair_ladder.h"
#include "plane_bound.h"
#include "voxel_search.h"

namespace collision_pairs {

/// Part of the way of a pair that is not yet known to be free.
struct OpenPair {
  BoxPair pair{0, 0};             ///< elements; the first is of the smaller model
  int frame = -1;                 ///< from which the two are seen; see MotionPairs
  double begin = 0.0, end = 1.0;  ///< fractions of the motion
  double clearance = 0.0;         ///< metres to certify
  double speed = 0.0;             ///< metres by which its distance changes at most, a fraction of 1
  bool has_normal = false;        ///< of the plane that was last between them, in the frame
  Eigen::Vector3d normal_F = Eigen::Vector3d::Zero();
};

/// On either side of a configuration, for how much of the fraction a pair keeps more than its
/// clearance: at least `clearance` metres.
struct Cover {
  double before = -1.0, after = -1.0;  ///< < 0: not even at the configuration
  double clearance = std::numeric_limits<double>::infinity();
};

class PairCover {
 public:
  /// Both must outlive this.
  PairCover(const CollisionScene& scene, MotionState& state);

  void begin(const MotionSettings& settings, const CloudVoxels& voxels);
  enum class Voxels { NO_CLOUD, KNOWN, NONE, IN_PART, UNKNOWN };
  /// What is known of the cloud of a pair.
  Voxels voxelsOf(const BoxPair& pair) const;

  enum class Outcome {
    COVERED,   ///< all of its way is free
    OPEN,      ///< the part that `cover` says
    NEARER,    ///< the same, but here it is for certain nearer than its clearance
    GIVEN_UP,  ///< what it can still move is finer than the resolution
    CONTACT    ///< in contact
  };

  /// At fraction `at` of the motion, where the state is, within the way of the pair: coarser bounds
  /// first, and no finer ones than the length of its way is worth. Updates the pair's plane and
  /// speed.
  Outcome measure(double at, OpenPair& pair, Cover& cover);

  /// Calls of measure() since begin() that asked for more than boxes.
  std::uint32_t nbQueries() const { return nb_queries_; }

 private:
  struct Question;

  bool isRigid(const BoxPair& pair) const;
  /// Index in the scene's clouds, or -1.
  int cloudOf(const BoxPair& pair) const;
  PairDistance askShapes(const Question& question, double max_distance);
  void byBoxes(Question& question);
  void byHulls(Question& question);
  void byPlane(Question& question, const Eigen::Vector3d& n_W);
  Outcome byShapes(Question& question);

  const CollisionScene& scene_;
  MotionState& state_;
  PairLadder ladder_;
  VoxelSearch voxel_search_;
  CloudVoxels voxels_;
  std::vector<Aabb> boxes_;  // of elements that are not asked at rigid rungs
  Fidelity fidelity_ = Fidelity::MESH;
  double resolution_ = 0.0;
  bool all_rigid_ = true;
  std::uint32_t nb_queries_ = 0;
};

}  // namespace collision_pairs
