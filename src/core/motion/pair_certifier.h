// Determines how far around one configuration of a motion a pair of elements is free.
//
// This folder certifies straight motions (MotionCheck). In the order of a check:
// - motion_pairs: which pairs of elements can joints move relative to each other? Once per scene.
// - open_intervals.h: which parts of the motion are not certified yet, and for which pairs?
// - motion_check.cpp: the search: takes the next of these, measures its pairs at its middle, and
//   puts back what is left on either side; static elements are found by a sweep.
// - check_segments.cpp: the same for many segments, on all cores.
// - motion_state: where are the elements at that configuration, and how fast can they move?
// - pair_certifier: how far around it is a pair free? By spheres, boxes, hulls, then triangles.
// - pair_clearances: how near may it come?
// - exact_configuration: is anything touched at that configuration?
// - uncertified_pairs: which pairs are not free?
// - edge_stage: where only FREE is of interest, the batch stage settles most motions, and the
// search
//   has to look only at what it leaves open.
// - plane_bound.h: how long does a plane separate two moving convex bodies?
#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "motion_state.h"
#include "pair_ladder.h"
#include "plane_bound.h"
#include "voxel_search.h"

namespace collision_pairs {

constexpr double ROUNDED_UP = 1.0 + 1e-12;  // more than the rounding of a few products

constexpr double SHORTEST_INTERVAL = 1e-13;  // of the fraction: a shorter one cannot be split

/// Part of a motion on which a pair is not yet known to be free.
struct OpenPair {
  BoxPair pair{0, 0};             ///< elements; the first has the smaller model
  int frame = -1;                 ///< common frame of the two; see MotionPairs
  double begin = 0.0, end = 1.0;  ///< fractions of the motion
  double clearance = 0.0;         ///< metres to certify
  double speed = 0.0;             ///< metres: largest change of its distance over the whole motion
  bool has_normal = false;        ///< of the last separating plane, in the frame
  Eigen::Vector3d normal_F = Eigen::Vector3d::Zero();
};

/// How far on either side of a configuration, as fractions, a pair keeps its clearance; it keeps at
/// least `clearance` metres.
struct CertifiedInterval {
  double before = -1.0, after = -1.0;  ///< < 0: not even at the configuration
  double clearance = std::numeric_limits<double>::infinity();
};

class PairCertifier {
 public:
  /// Both must outlive this.
  PairCertifier(const CollisionScene& scene, MotionState& state);

  void begin(const MotionSettings& settings, const CloudVoxels& voxels);
  enum class Voxels { NO_CLOUD, KNOWN, NONE, IN_PART, UNKNOWN };
  /// Information about the cloud of a pair.
  Voxels voxelsOf(const BoxPair& pair) const;

  enum class Outcome {
    CERTIFIED,  ///< its whole interval is free
    OPEN,       ///< the part given by `certified` is free
    NEARER,    ///< the same, but at the configuration it is, or deviates to where it may be, nearer
               ///< than its clearance
    GIVEN_UP,  ///< its remaining motion is finer than the resolution
    CONTACT    ///< in contact
  };

  /// At fraction `at` of the motion, which the state has and which is within the interval of the
  /// pair. Coarser bounds first, and finer ones only if the rest of the interval is worth their
  /// cost. Updates the pair's plane and speed.
  Outcome measure(double at, OpenPair& pair, CertifiedInterval& certified);

  /// Calls of measure() since begin() that needed more than boxes.
  std::uint32_t nbQueries() const { return nb_queries_; }

 private:
  struct Query;

  bool isRigid(const BoxPair& pair) const;
  /// Index in the scene's clouds, or -1.
  int cloudOf(const BoxPair& pair) const;
  PairDistance queryShapes(const Query& query, double max_distance);
  /// Metres that both together deviate along n_W; and the error of a distance along it.
  double deviationAlong(const Query& query, const Eigen::Vector3d& n_W, double half_width);
  double slackAlong(const Query& query, const Eigen::Vector3d& n_W);
  void byBoxes(Query& query);
  void byHulls(Query& query);
  void byPlane(Query& query, const Eigen::Vector3d& n_W);
  Outcome byShapes(Query& query);

  const CollisionScene& scene_;
  MotionState& state_;
  PairLadder ladder_;
  VoxelSearch voxel_search_;
  CloudVoxels voxels_;
  std::vector<Aabb> boxes_;  // of elements that are not queried at rigid rungs
  Fidelity fidelity_ = Fidelity::MESH;
  double resolution_ = 0.0;
  bool all_rigid_ = true;
  std::uint32_t nb_queries_ = 0;
};

}  // namespace collision_pairs
