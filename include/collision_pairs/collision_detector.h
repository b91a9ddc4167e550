// One check: poses in, report out.
#pragma once

#include <functional>
#include <memory>
#include <utility>
#include <vector>

#include "collision_pairs/body_poses.h"
#include "collision_pairs/collision_report.h"
#include "collision_pairs/collision_scene.h"
#include "collision_pairs/sweep_and_prune.h"

namespace collision_pairs {

class Deadline;
class ElementBoxes;
class FoundPairs;
class PairLadder;
struct SmallestDistance;
class TimedClimb;
class VoxelSearch;

struct CheckSettings {
  /// Metres, >= 0. Pairs up to this far apart are reported as near. 0: contacts only. Larger
  /// costs more: the boxes are compared at this distance and distances are computed up to it.
  double alarm_distance = 0.05;
  /// The geometry that decides. The first check of a mesh at SPHERES takes some 0.1 s more for it.
  Fidelity fidelity = Fidelity::MESH;
  /// Metres, >= 0. The search for a distance may end as soon as what is certain of it is an
  /// interval no wider; its lower end is what is reported, Certainty::TOLERATED. Larger costs less.
  /// Contact or not stays exactly the same, and so do depths. A pair up to this much further apart
  /// than the alarm distance may be reported as near; none that is nearer is missed. Clouds are
  /// measured exactly.
  double tolerance = 0.0;
  /// Find the smallest distance of all pairs even where it is beyond the alarm distance.
  bool min_distance = false;
  /// Only the verdict is asked for: ends at the first certain contact, which is then the only one
  /// in the report, without points and depth (its distance is 0). The alarm distance counts as 0.
  bool verdict_only = false;
  /// Seconds, >= 0, for the whole check; 0: no limit. Boxes are always rebuilt, swept and compared;
  /// the most suspicious pairs then climb the ladder until the time is spent, and the narrow query
  /// that is running then is finished. What is left is reported as UNRESOLVED, with its lower
  /// bound and the rung that this is of: no pair is left out.
  double time_budget = 0.0;
  /// Fill in CollisionReport::boxes, as for drawing them, and with verdict_only its candidates,
  /// too, which then are all looked for. Costs the box of every mesh, about 50 ns each, where that
  /// of most is not needed.
  bool list_boxes = false;
  /// Fill in CollisionReport::times. Reading the clock six times takes about 0.15 µs: a tenth of a
  /// small robot's check.
  bool stage_times = false;
};

/// Runs the check. Holds scratch memory only: the answer depends on (scene, poses and voxels,
/// settings) alone. One per thread; no lock is needed around the shared scene. No heap allocation
/// in boxes and broad phase once warm.
///
/// detect() checks every allowed pair. The three steps of SOFA's narrow-phase component do the
/// same pair by pair, for a caller that has its own broad phase over models:
///
///   detector.beginNarrowPhase(poses, settings);
///   for (…) detector.addCollisionPair(first_model, second_model);
///   const CollisionReport& report = detector.endNarrowPhase();
class CollisionDetector {
 public:
  explicit CollisionDetector(std::shared_ptr<const CollisionScene> scene);
  ~CollisionDetector();
  CollisionDetector(CollisionDetector&&) noexcept;
  CollisionDetector& operator=(CollisionDetector&&) noexcept;

  /// Throws InputError for an alarm distance, a tolerance or a time budget that is negative or not
  /// a number, or if `poses` does not fit the scene, nor voxels their cloud.
  const CollisionReport& detect(const BodyPoses& poses, const CheckSettings& settings);

  void beginNarrowPhase(const BodyPoses& poses, const CheckSettings& settings);
  /// By model id, in either order. Pairs that the scene's filter forbids stay out.
  void addCollisionPair(std::uint32_t model_a, std::uint32_t model_b);
  /// Throws InputError where nothing was begun since the last check.
  const CollisionReport& endNarrowPhase();

  /// The last check's, empty before the first.
  const CollisionReport& report() const { return report_; }

  const CollisionScene& scene() const { return *scene_; }

  /// What the time budget is measured by: seconds that never go back. For tests; the default is
  /// std::chrono::steady_clock.
  void setClock(std::function<double()> clock);

 private:
  const CollisionReport& run(const BodyPoses& poses);
  void rebuildBoxes(const BodyPoses& poses);
  void dropLooseCandidates();
  void listBoxes();
  void takeVoxels(const BodyPoses& poses);
  /// The pairs of elements whose boxes are no further apart than `reach`, sorted.
  void sweep(double reach, std::vector<BoxPair>& candidates);
  void beginPairs();
  void makeBalls();
  void findFirstContact();
  void measureCandidates();
  void measureInTime(const Deadline& deadline);
  bool isAsked(const BoxPair& pair) const;
  /// take(pair, voxels) for each element that moves and each cloud that it is checked against.
  template <class Take>
  void forEachCloudPair(const Take& take) const;
  const OccupiedVoxels& voxelsOf(const BoxPair& cloud_pair) const;
  void findCloudPairs();
  void sortCloudPairs();
  void measureClouds(const Deadline& deadline);
  void take(const BoxPair& pair, const PairDistance& found, Fidelity rung,
            const Eigen::Vector3i& voxel = Eigen::Vector3i::Zero());
  void searchMinimum(const Deadline& deadline);
  bool measureCloudsBeyond(const Deadline& deadline, SmallestDistance& best);
  /// But for those whose boxes are no further apart than `measured` (below 0: none). False where
  /// the time was spent first; nothing that is left is then nearer than `known`.
  bool measureNearestFirst(const std::vector<BoxPair>& pairs, double measured,
                           const Deadline& deadline, SmallestDistance& best, double& known);

  std::shared_ptr<const CollisionScene> scene_;
  CheckSettings settings_;
  std::unique_ptr<ElementBoxes> boxes_;
  bool some_are_loose_ = false;  // of this cycle
  bool has_balls_ = false;       // those of SPHERES were made
  SweepAndPrune sweep_;
  std::unique_ptr<PairLadder> ladder_;
  std::unique_ptr<TimedClimb> timed_climb_;
  std::unique_ptr<VoxelSearch> voxel_search_;
  std::unique_ptr<FoundPairs> found_;
  std::function<double()> clock_;
  CollisionReport report_;
  CloudVoxels voxels_;                // one a cloud; null: unknown
  std::vector<BoxPair> cloud_pairs_;  // candidates: an element that moves, that of a cloud

  BodyPoses begun_poses_;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> added_pairs_;
  bool only_added_pairs_ = false;

  std::vector<BoxPair> reached_;
  std::vector<std::pair<double, BoxPair>> by_gap_;
};

}  // namespace collision_pairs
