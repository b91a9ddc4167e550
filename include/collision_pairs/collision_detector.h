// One check: poses in, report out.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "collision_pairs/body_poses.h"
#include "collision_pairs/collision_report.h"
#include "collision_pairs/collision_scene.h"
#include "collision_pairs/pair_selection.h"
#include "collision_pairs/sweep_and_prune.h"

namespace collision_pairs {

class Deadline;
class ElementBoxes;
class FoundPairs;
class IgnoredPairs;
class PairLadder;
struct SmallestDistance;
class TimedClimb;
class VoxelSearch;

/// "May the pair of models `first` < `second` be left out?"
using MayIgnore = std::function<bool(std::uint32_t first, std::uint32_t second)>;
/// "May the check end with this contact?"
using IsEnough = std::function<bool(const Contact& contact)>;

struct CheckSettings {
  /// Metres, >= 0. Pairs up to this far apart are reported as near. 0: contacts only. Larger
  /// values cost more: boxes are compared at this distance, and distances computed up to it.
  double alarm_distance = 0.05;
  /// The geometry that decides. The first check at SPHERES prepares each mesh: 0.1 to 0.3 s of one
  /// core.
  Fidelity fidelity = Fidelity::MESH;
  /// How pairs of moving boxes are found. The report is the same. A BatchCheck, which looks at
  /// eight states at a time, asks it only for those that are checked one by one.
  BroadPhase broad_phase = BroadPhase::AUTO;
  /// Metres, >= 0. The search for a distance may end as soon as its certified interval is no wider.
  /// The lower end is reported, with Certainty::TOLERATED. Larger values cost less. Contacts and
  /// depths are not affected. Pairs up to this much further apart than the alarm distance may be
  /// reported as near; none within the alarm distance is missed. Distances to clouds are exact.
  double tolerance = 0.0;
  /// Compute the smallest distance of all pairs even if it is beyond the alarm distance.
  bool min_distance = false;
  /// Compute only the verdict: the check ends at the first certain contact, which is then the only
  /// one in the report, without points and depth (its distance is 0). The alarm distance counts as
  /// 0.
  bool verdict_only = false;
  /// Ends the check at this number of contacts: of pairs of elements in CONTACT, each of which has
  /// one, whatever is near or UNRESOLVED besides. 0: no limit. CollisionReport::ended_early then
  /// says what the report is worth. Contacts come in the order of CollisionReport::candidates,
  /// those of clouds last, or under a time budget the likely ones first.
  std::uint32_t max_contacts = 0;
  /// Is shown each such contact when it is found, and ends the check if it returns true. So a
  /// caller that wants at most n contacts for a pair of models, and m in all, counts those that it
  /// keeps. What it throws ends the check, whose report is then UNKNOWN. A BatchCheck asks from
  /// several threads at a time. Both are without effect with verdict_only.
  IsEnough is_enough;
  /// Seconds, >= 0, for the whole check; 0: no limit. Boxes are always rebuilt, swept and compared.
  /// Then the pairs most likely to be in contact climb the ladder of fidelities until the time is
  /// spent; a query in progress is finished. The remaining pairs are reported as UNRESOLVED, with
  /// their lower bound and the rung that gave it, so no pair is dropped.
  double time_budget = 0.0;
  /// Fill in CollisionReport::boxes, for drawing them, and with verdict_only also all candidates.
  /// Costs the tight box of every mesh, about 50 ns each, most of which are not needed otherwise.
  bool list_boxes = false;
  /// Fill in CollisionReport::times. Reading the clock six times takes about 0.15 µs, a tenth of a
  /// small robot's check.
  bool stage_times = false;
  /// The pairs that the check is limited to, of the same scene. Null: all that the scene allows.
  std::shared_ptr<const PairSelection> selection;
  /// Leaves out pairs for which it returns true, and lists them in CollisionReport::ignored: an
  /// allowed collision matrix that changes from check to check. Asked only about pairs whose boxes,
  /// with verdict_only looser ones, are within the alarm distance, or the smallest distance found
  /// so far if that is searched for; once per check. The time budget does not limit its time. What
  /// it throws ends the check, whose report is then UNKNOWN. A BatchCheck asks from several threads
  /// at a time. Cost: 10 ns a pair, and what it takes itself; none if it is empty.
  MayIgnore may_ignore;
  /// Which list of pairs may_ignore answers from: the caller's number for what is in it, since the
  /// detector looks at no address. With the number of the check before, not 0, answers are kept and
  /// it is asked about no pair again; give another whenever any answer changes. 0: asked anew.
  std::uint64_t ignore_revision = 0;
};

/// Runs the check. Holds scratch memory only: the answer depends on (scene, poses and voxels,
/// settings) alone. Use one per thread; the shared scene needs no lock. Boxes and broad phase do
/// not allocate once warm.
///
/// detect() checks every allowed pair. The three steps of SOFA's narrow-phase component do the same
/// pair by pair, for a caller that has a broad phase of its own over models:
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
  /// By model id, in either order. Pairs that the scene's filter forbids are ignored.
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
  std::unique_ptr<TimedClimb> timed_climb_;
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
