// One check: poses in, report out.
#pragma once

#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "collision_pairs/body_poses.h"
#include "collision_pairs/check_settings.h"
#include "collision_pairs/collision_report.h"
#include "collision_pairs/collision_scene.h"

namespace collision_pairs {

class Deadline;
class ElementBoxes;
class FoundPairs;
class IgnoredPairs;
class PairLadder;
struct SmallestDistance;
class AnytimeQuery;
class VoxelSearch;

/// Runs the check. Holds scratch memory only: the answer depends on (scene, poses and voxels,
/// settings) alone. Use one per thread; the shared scene needs no lock. Boxes and broad phase do
/// not allocate once warm.
///
/// detect() checks every allowed pair. The three steps of SOFA's narrow-phase component do the same
/// pair by pair, for a caller that has a broad phase of its own over models. The report is then of
/// the pairs that were added alone, and FREE without any: that all others are further apart than
/// the alarm distance is what the caller's broad phase says.
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

  /// Throws InputError if the alarm distance, the tolerance or the time budget is negative or not a
  /// number, if `poses` does not match the scene's bodies, if voxels do not match their cloud, or
  /// if the selection is of another scene.
  const CollisionReport& detect(const BodyPoses& poses, const CheckSettings& settings);

  void beginNarrowPhase(const BodyPoses& poses, const CheckSettings& settings);
  /// By model id, in either order. Pairs that the scene's filter forbids are ignored. Throws
  /// InputError for ids that the scene does not have.
  void addCollisionPair(std::uint32_t model_a, std::uint32_t model_b);
  /// Throws InputError without a beginNarrowPhase() since the last check.
  const CollisionReport& endNarrowPhase();

  /// The report of the last check; empty before the first.
  const CollisionReport& report() const { return report_; }

  const CollisionScene& scene() const { return *scene_; }

  /// Sets the clock for time budgets: seconds, monotonic. For tests; the default is
  /// std::chrono::steady_clock.
  void setClock(std::function<double()> clock);

 private:
  void begin(const BodyPoses& poses, const CheckSettings& settings);
  const CollisionReport& run(const BodyPoses& poses);
  void rebuildBoxes(const BodyPoses& poses);
  void dropLooseAndIgnored();
  /// Elements, in either order.
  bool isIgnored(const BoxPair& pair);
  const PairFilter& filter() const;
  /// False if no pair is to be checked.
  bool noteUnchecked();
  void listBoxes();
  void takeVoxels(const BodyPoses& poses);
  /// The pairs of elements whose boxes are no further apart than `reach` metres, sorted.
  void sweep(double reach, std::vector<BoxPair>& candidates);
  void beginPairs();
  /// Whether the check may end before all pairs are measured.
  bool mayEndEarly() const {
    return settings_.verdict_only || settings_.max_contacts > 0 || settings_.is_enough;
  }
  /// The candidates, as reached_.
  void sortByOverlap();
  /// `are_loose`: the candidates are not sorted out yet.
  void measureCandidates(bool are_loose);
  void measureInTime(const Deadline& deadline);
  bool isAsked(const BoxPair& pair) const;
  /// Calls take(pair, voxels) for each moving element and each cloud that it is checked against.
  template <class Take>
  void forEachCloudPair(const Take& take) const;
  const OccupiedVoxels& voxelsOf(const BoxPair& cloud_pair) const;
  void findCloudPairs();
  void sortCloudPairs();
  void measureClouds(const Deadline& deadline);
  /// Tight boxes that are apart end a verdict; so they do a report.
  void endAtBoxes(const BoxPair& pair, PairDistance& found);
  void take(const BoxPair& pair, PairDistance found, Fidelity rung,
            const Eigen::Vector3i& voxel = Eigen::Vector3i::Zero());
  /// Ends the check if it is the last.
  void countContact(const Contact& contact);
  void searchMinimum(const Deadline& deadline);
  bool measureCloudsBeyond(const Deadline& deadline, SmallestDistance& best);
  /// Skips pairs whose boxes are no further apart than `measured` (negative: skips none). False if
  /// the time was spent; then no remaining pair is nearer than `known`.
  bool measureNearestFirst(const std::vector<BoxPair>& pairs, double measured,
                           const Deadline& deadline, SmallestDistance& best, double& known);

  std::shared_ptr<const CollisionScene> scene_;
  CheckSettings settings_;
  std::optional<AllowedBoxPairs> allowed_;  // the scene's, unless it has many moving elements
  std::unique_ptr<ElementBoxes> boxes_;
  bool some_are_loose_ = false;  // boxes of this cycle
  bool has_spheres_ = false;     // those of SPHERES were made
  std::uint32_t nb_contacts_ = 0;
  SweepAndPrune sweep_;
  std::unique_ptr<PairLadder> ladder_;
  std::unique_ptr<AnytimeQuery> anytime_query_;
  std::unique_ptr<VoxelSearch> voxel_search_;
  std::unique_ptr<FoundPairs> found_;
  std::unique_ptr<IgnoredPairs> ignored_;
  std::function<double()> clock_;
  CollisionReport report_;
  CloudVoxels voxels_;                // one per cloud; null: unknown
  std::vector<BoxPair> cloud_pairs_;  // candidates: moving element, element of a cloud

  BodyPoses begun_poses_;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> added_pairs_;
  bool only_added_pairs_ = false;

  std::vector<BoxPair> reached_;
  std::vector<std::pair<double, BoxPair>> by_gap_;
};

}  // namespace collision_pairs
